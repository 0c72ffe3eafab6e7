//! Densities by which missing samples are drawn.
//!
//! What is drawn by a law agrees with the law, be it right or not: where a third of the samples is missing, a third of what a search
//! looks at says nothing but what was believed before. So the gaps are filled twice: by the law, and then, where what is measured
//! lies surely beside it, by what is measured.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::axis::whitening::tabulate;
use crate::model::effect::Part;

/// Deviations from which a bin's ratio is not chance: 1 % of records have one so far off among some 200 bins. What is drawn by
/// a law that lacks something leaves a mark of it at each gap; drawn by the measured bins, chance in them would be made
/// lasting.
const NO_CHANCE: f64 = 4.0;

/// Power that a declared converter lets through from which what is measured says more than its filter: half, its corner. In the
/// filter's fall most of what is measured is what fills make of all else.
const PASSES: f64 = 0.5;

impl AxisState {
    /// Densities of the fitted law at the ordinates of a ring of `len` samples, of the tones that have a name too.
    pub(super) fn law_densities(&self, len: usize) -> Vec<f64> {
        self.with_tones(tabulate(len, self.rate_hz, |f_hz| self.density(f_hz)), len)
    }

    /// The same where what was measured agrees with the law, and what was measured where it surely does not.
    pub(super) fn seen_densities(&self, len: usize) -> Vec<f64> {
        let mut densities = tabulate(len, self.rate_hz, |f_hz| self.density(f_hz));
        let drawn = drawn_density(&densities[1..], self.filled_share());
        let ratios = tabulate(len, self.rate_hz, |f_hz| self.sure_ratio(f_hz, drawn));
        for (density, ratio) in densities.iter_mut().zip(ratios) {
            *density *= ratio;
        }
        self.with_tones(densities, len)
    }

    /// `densities` and those of the tones that have a name.
    fn with_tones(&self, mut densities: Vec<f64>, len: usize) -> Vec<f64> {
        for tone in self.explanations().iter().filter(|one| one.is_tone()) {
            let Part::Term(term) = tone.kind().part(&tone.effect.plain()) else {
                continue;
            };
            // Narrow: each ordinate by itself.
            for (k, density) in densities.iter_mut().enumerate().skip(1) {
                let f_hz = k as f64 * self.rate_hz / len as f64;
                if tone.bands_hz().iter().any(|band| band.contains(&f_hz)) {
                    *density += self.bins.term_density(&*term, f_hz) * self.bins.chain_power(f_hz);
                }
            }
        }
        densities
    }

    /// Measured over expected power where chance does not make it, and 1 elsewhere. Of each density so much was `drawn` in the
    /// place of missing samples and scatters as that does.
    fn sure_ratio(&self, f_hz: f64, drawn: f64) -> f64 {
        if self.bins.chain_power(f_hz) < PASSES {
            return 1.0;
        }
        let scatters = (1.0 + drawn / self.density(f_hz)).powi(2);
        self.between_bins(f_hz, |log, dof| {
            if deviations(log, dof / scatters).abs() > NO_CHANCE {
                log
            } else {
                0.0
            }
        })
    }
}

/// Standard deviations that a ratio of this logarithm lies off where it is a mean of `dof` squares: its cube root is all but
/// normal (E. B. Wilson and M. M. Hilferty, Proc. Nat. Acad. Sci. 17 (1931) 684), where the logarithm of few squares is not.
fn deviations(log: f64, dof: f64) -> f64 {
    let variance = 2.0 / (9.0 * dof);
    ((log / 3.0).exp() - (1.0 - variance)) / variance.sqrt()
}

/// Density of what is drawn where the `share` of samples with these `densities` misses, the same at all frequencies. A sample
/// between others is known up to the harmonic mean of their densities (A. N. Kolmogorov, Izv. Akad. Nauk SSSR Ser. Mat. 5 (1941) 3),
/// and these know as little more of each other: `L = share / mean(1 / (S + L))`.
fn drawn_density(densities: &[f64], share: f64) -> f64 {
    /// Turns: white noise leaves the share of what the last was off by, differences twice that: a hundredth after seven.
    const TURNS: usize = 7;
    let count = densities.len() as f64;
    let largest = share * densities.iter().sum::<f64>() / count;
    (0..TURNS).fold(largest, |drawn, _| {
        let inverse = densities.iter().map(|density| (density + drawn).recip());
        share * count / inverse.sum::<f64>()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_are_those_of_a_mean_of_squares() {
        // Quantiles of chi-squared over its degrees of freedom where the normal law has four deviations (SciPy's chi2.ppf).
        let quantiles = [
            (2.0, 10.360, 4.0),
            (10.0, 3.845, 4.0),
            (10.0, 0.0695, -4.0),
            (100.0, 1.6681, 4.0),
            (100.0, 0.5310, -4.0),
        ];
        for (dof, ratio, off) in quantiles {
            // The cube root's own error, so far out: 0.2 at ten squares, less at more.
            let found = deviations(f64::ln(ratio), dof);
            assert!((found - off).abs() < 0.25, "{dof}: {found} at {ratio}");
        }
        // However little two squares are, it may be chance.
        assert!(deviations(f64::NEG_INFINITY, 2.0) > -4.0);
    }

    #[test]
    fn what_a_declared_filter_shuts_out_is_not_what_was_measured() {
        let seed = 1;
        let chain = "ads1281:linear".parse().expect("a chain");
        let mut numbers = crate::diagnosis::trial::numbers(seed, 0);
        let values: Vec<f64> = (0..20_011).map(|_| numbers.draw()).collect();
        let axis = AxisState::new(std::sync::Arc::new(values), 1000.0, Some(&chain));
        let mut axis = axis.expect("a spectrum");
        for psd in &mut axis.data.psd {
            *psd *= 100.0;
        }
        // The filter's corner is at 0.41 of the rate.
        assert!(axis.sure_ratio(200.0, 0.0) > 50.0, "seed {seed}");
        assert_eq!(axis.sure_ratio(450.0, 0.0), 1.0, "seed {seed}");
    }

    #[test]
    fn what_is_drawn_is_what_the_missing_take_away() {
        let white = drawn_density(&[2.0; 50], 0.3);
        assert!((white / (2.0 * 0.3 / 0.7) - 1.0).abs() < 1e-3, "{white}");
        // Differences of white numbers: mean(1 / (S + L)) is 1 / sqrt(L^2 + 4 L), so that L = 4 share^2 / (1 - share^2).
        let count = 4096;
        let turns =
            (0..count).map(|k| std::f64::consts::PI * (f64::from(k) + 0.5) / f64::from(count));
        let blue: Vec<f64> = turns.map(|turn| 2.0 - 2.0 * turn.cos()).collect();
        let drawn = drawn_density(&blue, 0.3);
        let expected = 4.0 * 0.09 / 0.91;
        assert!((drawn / expected - 1.0).abs() < 0.01, "{drawn}, {expected}");
        assert_eq!(drawn_density(&blue, 0.0), 0.0);
    }
}
