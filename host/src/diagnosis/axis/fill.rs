//! Fills the short gaps of an axis by the law that is fitted to it, and fits the law to what is filled.

use std::sync::Arc;

use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::explanation::Change;
use crate::diagnosis::laws::search;
use crate::diagnosis::record::beyond;
use crate::diagnosis::record::short_gaps::ShortGaps;

/// Nats by which a law may still move from one fill to the next when it is taken for the record's own: a choice.
const AGREED: f64 = 0.1;

/// Fills of a record at most, and those where nothing was filled before: a choice. A third of a record of quantisation noise
/// missing takes half as many.
pub(super) const AT_FIRST: usize = 20;

/// Fills where the record was filled before and little has changed: a choice. A law that has a floor near zero
/// tends there ever more slowly, and each fill of a million samples takes a second.
pub(super) const AGAIN: usize = 4;

/// Nats by which a law may still move after these: a choice, below what any test takes for significant. A strong tone that is
/// taken out leaves gaps that were drawn with its power, of which each fill keeps the share that is missing.
const UNSEEN: f64 = 3.0;

/// The part of what a law is off by that one fill leaves at most, as far as it is trusted to go on so: a choice.
const SLOWEST: f64 = 0.75;

impl AxisState {
    /// Gaps of which the record misses few samples each.
    pub(super) fn short_gaps(&self) -> Option<&ShortGaps> {
        self.short_gaps.as_deref()
    }

    /// Samples that stand in the place of missing ones.
    pub fn filled_samples(&self) -> usize {
        self.short_gaps().map_or(0, |gaps| gaps.places().len())
    }

    /// Their share of the samples that are there or stand there.
    pub fn filled_share(&self) -> f64 {
        self.short_gaps().map_or(0.0, ShortGaps::share)
    }

    /// Share of the record that was measured, or drawn where it was not.
    pub fn present_share(&self) -> f64 {
        (self.measured_share() / (1.0 - self.filled_share())).min(1.0)
    }

    /// Whether a sample that was filled lies no more than so many samples from this one.
    pub fn is_beside_filled(&self, index: usize, samples: usize) -> bool {
        let places = self.short_gaps().map_or(&[][..], ShortGaps::places);
        let from = places.partition_point(|place| place + samples < index);
        places
            .get(from)
            .is_some_and(|place| *place <= index + samples)
    }

    /// Fills the short gaps by the law as it is fitted and fits it anew, until the two agree: as often as is
    /// `usual`, and up to twice as often where a test would see what still moves. Leaves an axis that has none as it is.
    ///
    /// # Errors
    /// [`NoFit`] where what is filled cannot be fitted.
    pub(super) fn fill(&mut self, usual: usize) -> Result<(), NoFit> {
        let Some(gaps) = self.short_gaps.clone() else {
            return Ok(());
        };
        let mut course: Vec<Vec<f64>> = Vec::new();
        for n in 0..AT_FIRST {
            let expected = self.fit.expected.clone();
            let density = match n {
                // What was drawn before by another law is gone with this; what then lies beside the law was measured.
                0 => self.law_densities(gaps.ring_len()),
                _ => self.seen_densities(gaps.ring_len()),
            };
            self.fill_once(&gaps, density, &mut course)?;
            let nats = self.nats_from(&expected);
            let is_enough = n + 1 >= usual && (nats < UNSEEN || n + 1 == 2 * usual);
            if nats < AGREED || is_enough {
                break;
            }
        }
        Ok(())
    }

    /// Takes over the gaps that there are since other samples count as no measurement than those at `before`; whether there are
    /// others.
    pub(super) fn has_other_gaps(&mut self, before: &[usize]) -> bool {
        if self.residual.replaced() == before {
            return false;
        }
        self.short_gaps = self.residual.short_gaps().map(Arc::new);
        self.residual.fill_only(self.short_gaps.as_deref());
        true
    }

    /// Keeps what was drawn in the place of samples that are no measurement with what says so.
    pub(super) fn keep_replaced(&mut self) {
        let mut drawn = self
            .residual
            .waves()
            .iter()
            .filter(|wave| wave.replaced().is_some());
        let changes = self.explanations.iter_mut().map(|one| &mut one.change);
        let waves = changes.filter_map(|change| match change {
            Change::Waves(waves) | Change::Happened { waves, .. } => Some(waves),
            _ => None,
        });
        for wave in waves.flatten().filter(|wave| wave.replaced().is_some()) {
            if let Some(drawn) = drawn.next() {
                wave.clone_from(drawn);
            }
        }
    }

    /// Fills the gaps once and fits anew. `course` has the densities of up to two fills before.
    fn fill_once(
        &mut self,
        gaps: &ShortGaps,
        mut density: Vec<f64>,
        course: &mut Vec<Vec<f64>>,
    ) -> Result<(), NoFit> {
        self.forget_whitened();
        go_on(course, &mut density);
        let mut left = std::mem::take(&mut self.filled);
        let values = Arc::make_mut(&mut left).as_mut_slice();
        let limits = beyond::limits(self.residual.waves(), values);
        gaps.fill(values, &limits, self.rate_hz, &density);
        self.residual.refill(gaps.places(), &left);
        drop(left);
        let values = self.residual.values();
        self.data = self.bins.measure(&values);
        let fit = search::polish(&self.bins, &self.data, &mut self.laws, 0, 0.05);
        self.fit = fit.ok_or(NoFit)?;
        self.settle(values);
        Ok(())
    }

    /// What bins of another expectation would lose on average by this one.
    fn nats_from(&self, before: &[f64]) -> f64 {
        let pairs = before.iter().zip(&self.fit.expected);
        let of_bin =
            |((before, now), dof): ((&f64, &f64), &f64)| 0.25 * dof * (now / before).ln().powi(2);
        pairs.zip(&self.data.dof).map(of_bin).sum()
    }
}

/// Moves every third density on to where its `course` tends: each ordinate by itself, as a series whose steps shrink by
/// one factor does (A. C. Aitken, Proc. R. Soc. Edinburgh 46 (1926) 289), in logarithms.
fn go_on(course: &mut Vec<Vec<f64>>, density: &mut [f64]) {
    let [before, then] = &course[..] else {
        course.push(density.to_vec());
        return;
    };
    for ((before, then), now) in before.iter().zip(then).zip(density) {
        let [first, second] = [then / before, *now / then].map(f64::ln);
        let left = (second / first).min(SLOWEST);
        if left > 0.0 {
            *now *= (second * left / (1.0 - left)).exp();
        }
    }
    course.clear();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::{Gaussian, Seed};

    const RATE_HZ: f64 = 100.0;

    /// White noise between a walk and ten times as much quantisation noise, an odd number of samples.
    fn noise(seed: u64) -> Vec<f64> {
        let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let (mut level, mut before) = (0.0, 0.0);
        let values = (0..60_001).map(|_| {
            level += 0.01 * normal.draw();
            let now = 3.0 * normal.draw();
            let step = now - before;
            before = now;
            normal.draw() + level + step
        });
        values.collect()
    }

    /// Two-sided density of that noise.
    fn density(f_hz: f64) -> f64 {
        let turn = 2.0 * (std::f64::consts::PI * f_hz / RATE_HZ).sin();
        (1.0 + (0.01 / turn).powi(2) + (3.0 * turn).powi(2)) / RATE_HZ
    }

    /// The same without the samples beside which a normal number lies beyond so many deviations.
    fn lost(values: &[f64], beyond: f64, seed: u64) -> Vec<f64> {
        let mut normal = Gaussian::new(Seed { seed, stream: 9 }, 1.0);
        let lose = |&value: &f64| match normal.draw() > beyond {
            true => f64::NAN,
            false => value,
        };
        values.iter().map(lose).collect()
    }

    #[test]
    fn a_law_is_found_whatever_single_samples_miss() {
        // None, a thousandth, a twentieth, three tenths of a normal law lie beyond these.
        let shares = [
            (f64::INFINITY, 0.0),
            (3.09, 1e-3),
            (1.645, 0.05),
            (0.524, 0.3),
        ];
        for (seed, (beyond, share)) in (1..).zip(shares) {
            let values = lost(&noise(seed), beyond, seed);
            let axis = AxisState::new(Arc::new(values), RATE_HZ, None).expect("a spectrum");
            for f_hz in [0.02, 0.5, 2.0, 10.0, 40.0] {
                let ratio = axis.density(f_hz) / density(f_hz);
                // The walk, of which an octave about 0.02 Hz has 24 ordinates, is known to a fifth, all else to 4 %. With a third
                // missing, what is drawn beside ten times as much quantisation noise scatters by 25 % from record to record
                // at 0.5 Hz and by 13 % at 2 Hz. Straight lines make 2 Hz twice as loud where a twentieth misses.
                let sd = match f_hz {
                    _ if f_hz < 0.1 => 0.2,
                    _ if share > 0.2 && f_hz < 1.0 => 0.25,
                    _ if share > 0.2 && f_hz < 5.0 => 0.13,
                    _ => 0.04,
                };
                assert!(
                    ratio.ln().abs() < 3.0 * sd,
                    "{share} missing: {ratio} of the power at {f_hz} Hz, seed {seed}"
                );
            }
            let drawn = axis.filled_samples() as f64 / 60_001.0;
            assert!((drawn - share).abs() < 0.01, "{drawn} of {share}");
        }
    }

    /// Every ratio of an axis's power to that of the noise in a band.
    fn ratios(axis: &AxisState, inside_hz: std::ops::Range<f64>) -> Vec<f64> {
        let bins = axis.data.f_hz.iter().zip(&axis.data.psd);
        let inside = bins.filter(|(f_hz, _)| inside_hz.contains(*f_hz));
        inside.map(|(f_hz, psd)| psd / density(*f_hz)).collect()
    }

    #[test]
    fn what_a_strong_tone_had_filled_is_gone_with_it() {
        use crate::diagnosis::record::wave::Wave;
        use crate::diagnosis::trial::take_in;
        use crate::model::sinusoid;
        for seed in 11..14 {
            let (cycles, amplitude) = (0.073, 3000.0);
            let added = (0..).zip(noise(seed)).map(|(n, value)| {
                let turn = std::f64::consts::TAU * cycles * f64::from(n);
                value + amplitude * turn.cos()
            });
            let values = lost(&added.collect::<Vec<_>>(), 0.524, seed);
            let axis = AxisState::new(Arc::new(values), RATE_HZ, None);
            let mut axis = axis.expect("a spectrum");
            let line = Wave::Line {
                cycles,
                cosine: amplitude,
                sine: 0.0,
                lost: None,
            };
            take_in(&mut axis, sinusoid::KIND, Change::Waves(vec![line]));
            // What is drawn of this noise scatters by a quarter, and its bins as much again.
            let off = ratios(&axis, 5.0..45.0);
            assert!(
                off.iter().all(|ratio| (0.3..3.0).contains(ratio)),
                "seed {seed}: {off:?}"
            );
        }
    }

    #[test]
    fn gaps_are_filled_by_what_no_law_explains() {
        for seed in 21..24 {
            // The mean of twelve white samples: lobes that the five terms do not have.
            let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
            let white: Vec<f64> = (0..60_012).map(|_| normal.draw()).collect();
            let means: Vec<f64> = white.windows(12).map(|some| some.iter().sum()).collect();
            let axis = AxisState::new(Arc::new(lost(&means, 0.524, seed)), RATE_HZ, None);
            let axis = axis.expect("a spectrum");
            // Where the first lobe ends, one bin about 100/12 Hz has a hundredth of the power of the start at most.
            let bins = axis.data.f_hz.iter().zip(&axis.data.psd);
            let least = bins
                .filter(|(f_hz, _)| (7.0..10.0).contains(*f_hz))
                .fold(f64::INFINITY, |least, (_, psd)| least.min(*psd));
            let start = axis.data.psd[axis.data.f_hz.partition_point(|f_hz| *f_hz < 1.0)];
            assert!(least < 0.01 * start, "seed {seed}: {} of it", least / start);
        }
    }

    #[test]
    fn no_test_looks_at_what_was_drawn_and_all_look_beside_it() {
        let values = lost(&noise(5), 3.09, 5);
        let axis = AxisState::new(Arc::new(values.clone()), RATE_HZ, None).expect("a spectrum");
        let inside = 2000..58_000;
        assert!(
            inside
                .clone()
                .all(|n| axis.usable(n) == values[n].is_finite())
        );
        let drawn = inside.filter(|n| values[*n].is_nan()).count();
        assert!(drawn > 20, "{drawn} missing, seed 5");
    }
}
