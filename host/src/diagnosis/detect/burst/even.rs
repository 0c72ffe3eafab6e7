//! Whether a noisier stretch is noisier at all frequencies alike.

use std::ops::Range;

use crate::diagnosis::axis::Whitened;
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::steady::tiles::strengths;

/// Ordinates of the narrowest band, and moments within the stretch that a band must have, at least:
/// choices. A mean of eight strengths scatters by 35 %, and of fewer the ratio is not chi-squared
/// any more.
const LEAST_ORDINATES: usize = 64;
const LEAST_MOMENTS: usize = 8;

/// What a band may add to what one factor for all explains, of that, and the stretch is still one of it: far above threshold any
/// band is seen to differ. A choice: it adds three quarters where half of the noise is louder by half, and three thousandths
/// where one half is four times as strong and the other five times.
const TOLERATED: f64 = 0.1;

/// How a stretch is louder in octave bands.
#[derive(Debug, Clone, Copy)]
pub struct Evenness {
    /// Probability of bands that differ as much, for a stretch that is all of one factor.
    pub p_value: f64,
    /// Log-likelihood that a factor for each band adds, over that of one for all, against none.
    pub share: f64,
}

impl Evenness {
    /// Whether it is louder in all bands alike, at this `level` or nearly.
    pub fn is_even(self, level: f64) -> bool {
        self.p_value >= level || self.share < TOLERATED
    }
}

/// That of a `stretch` of the record, in samples.
///
/// The mean of `n` strengths follows a gamma law of shape `n`; twice the log-likelihood ratio of one
/// factor for each band against one for all is chi-squared with one degree less than bands. One for all, `r`, against none
/// is `n (r - 1 - ln r)`.
pub fn evenness(seen: &Whitened, stretch: &Range<usize>) -> Evenness {
    let length = seen.transform.len();
    let mut bands = Vec::new();
    let mut top = seen.top - 1;
    while top >= 2 * LEAST_ORDINATES {
        let ordinates = top / 2..top;
        top /= 2;
        let strengths = strengths(seen, ordinates);
        let moments = strengths.len();
        let at = |moment: usize| moment * length / moments;
        let inside: Vec<f64> = (0..moments)
            .filter(|&moment| stretch.contains(&at(moment)))
            .map(|moment| strengths[moment])
            .collect();
        let outside = strengths.iter().sum::<f64>() - inside.iter().sum::<f64>();
        let outside = outside / (moments - inside.len()).max(1) as f64;
        let count = inside.len() as f64;
        if inside.len() >= LEAST_MOMENTS && outside > 0.0 {
            bands.push((count, inside.iter().sum::<f64>() / count / outside));
        }
    }
    let total: f64 = bands.iter().map(|(count, _)| count).sum();
    let all = bands
        .iter()
        .map(|(count, ratio)| count * ratio)
        .sum::<f64>()
        / total;
    let ratio: f64 = bands
        .iter()
        .map(|(count, ratio)| 2.0 * count * (all / ratio).ln())
        .sum();
    // One band by itself is of one factor: without a degree of freedom the probability is one.
    Evenness {
        p_value: p_value::chi_squared(ratio, bands.len() as f64 - 1.0),
        share: 0.5 * ratio / (total * (all - 1.0 - all.ln())),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::sync::Arc;

    use super::*;
    use crate::diagnosis::axis::AxisState;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    const STRETCH: Range<usize> = 20_000..30_000;

    fn of(seed: u64, stretch: &Range<usize>, inside: impl Fn(usize, f64) -> f64) -> Evenness {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let values = (0..1 << 16).map(|n| {
            let value = noise.draw();
            if stretch.contains(&n) {
                inside(n, value)
            } else {
                value
            }
        });
        let axis = AxisState::new(Arc::new(values.collect()), 1000.0, None).expect("long enough");
        evenness(&axis.whitened(), stretch)
    }

    #[test]
    fn a_factor_on_all_of_the_noise_is_even() {
        // Of 60 records 0.6 below 1 % are expected: 5 or more have a probability of 4e-4.
        let low: Vec<u64> = (0..60)
            .filter(|&seed| of(seed, &STRETCH, |_, noise| 1.5 * noise).p_value < 0.01)
            .collect();
        assert!(low.len() < 5, "seeds {low:?}");
    }

    #[test]
    fn a_tone_for_a_while_is_not() {
        for seed in 100..105 {
            let all = of(seed, &STRETCH, |n, noise| {
                noise + (TAU * 0.2 * n as f64).cos()
            });
            assert!(all.p_value < 1e-12, "seed {seed}: {all:?}");
            assert!(!all.is_even(1e-5), "seed {seed}: {all:?}");
        }
    }

    #[test]
    fn a_tone_for_a_moment_is_not_though_low_bands_say_nothing_of_it() {
        // The lowest band has a moment in 1024 samples, none of them within it.
        let stretch = 20_500..20_900;
        for seed in 105..110 {
            let all = of(seed, &stretch, |n, noise| {
                noise + 3.0 * (TAU * 0.2 * n as f64).cos()
            });
            assert!(all.p_value < 1e-12, "seed {seed}: {all:?}");
            assert!(!all.is_even(1e-5), "seed {seed}: {all:?}");
        }
    }

    #[test]
    fn far_above_threshold_one_band_may_be_a_little_louder() {
        // Three times as loud, and a tone of half of that power in one octave.
        for seed in 110..115 {
            let all = of(seed, &STRETCH, |n, noise| {
                3.0 * noise + 3.0 * (TAU * 0.2 * n as f64).cos()
            });
            assert!(all.p_value < 1e-5, "seed {seed}: {all:?}");
            assert!(all.is_even(1e-5), "seed {seed}: {all:?}");
        }
    }
}
