//! A slow change of the level, as its detectors measure it on the record's slow copy.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::look::Proposal;
use crate::diagnosis::record::wave::Wave;

/// Gain in log-likelihood from which a change is measured anew, nats: a choice. Its size and its time gain one by what
/// they follow of the noise.
pub const LEAST_GAIN: f64 = 3.0;

/// A waveform that is in the record.
pub struct SlowChange {
    /// The waveform, with its size, in the unit of the signal.
    pub wave: Wave,
    /// Its size over its standard deviation.
    pub z: f64,
    /// Gain in log-likelihood with it in the noise in which it was found, nats.
    pub gain_nats: f64,
    /// Standard deviation of its size.
    pub size_sd: f64,
    /// Standard deviation of the logarithm of its time constant, where it has one.
    pub time_log_sd: f64,
    /// Probability of as large a statistic without it.
    pub p_value: f64,
    /// Gain in log-likelihood on ordinates that it was not fitted to.
    pub nats: f64,
}

impl SlowChange {
    /// Whether a settling is seen: most of its energy lies where the record was measured and nothing happened meanwhile. What
    /// stands for the rest follows from its ends, and would settle by itself. What has no time constant is seen.
    pub fn is_seen(&self, axis: &AxisState) -> bool {
        /// Part of the energy: a choice.
        const MOST: f64 = 2.0 / 3.0;
        /// Time constants that it is followed for: a hundred-thousandth of the energy is left then.
        const FOLLOWED: f64 = 6.0;
        let Wave::WarmUp { samples, .. } = self.wave else {
            return true;
        };
        let until = (FOLLOWED * samples) as usize;
        let keep = (-2.0 / samples).exp();
        let (mut all, mut seen, mut energy) = (0.0, 0.0, 1.0);
        for value in axis.residual.values().iter().take(until) {
            all += energy;
            seen += if value.is_finite() { energy } else { 0.0 };
            energy *= keep;
        }
        seen > MOST * all
    }
}

/// A slow change that was measured again.
pub struct MeasuredAgain {
    /// What is to be done about it.
    pub proposal: Proposal,
    /// What it gains beyond what it gains as it was known, nats.
    pub gained_nats: f64,
    /// Whether it takes more of the noise out with it than was known.
    pub absorbs_more: bool,
}

/// The residual with these waveforms, which were taken out of it.
pub fn put_back<'a>(axis: &AxisState, waves: impl IntoIterator<Item = &'a Wave>) -> Vec<f64> {
    let mut less = vec![0.0; axis.filled.len()];
    for wave in waves {
        wave.take_out(&mut less);
    }
    let pairs = axis.filled.iter().zip(less);
    pairs.map(|(left, less)| left - less).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{Trial, noise};

    fn settling(samples: f64) -> SlowChange {
        SlowChange {
            wave: Wave::WarmUp {
                amplitude: 1.0,
                samples,
            },
            z: 9.0,
            gain_nats: 40.0,
            size_sd: 0.1,
            time_log_sd: 0.1,
            p_value: 1e-9,
            nats: 40.0,
        }
    }

    #[test]
    fn a_settling_before_the_first_sample_is_not_seen() {
        let mut values = noise(50);
        values[..1000].fill(f64::NAN);
        let axis = Trial::new(values).axis;
        // A third of its square is over after 0.2 of its time constant.
        for (samples, is_seen) in [(100.0, false), (4500.0, false), (5500.0, true)] {
            let change = settling(samples);
            assert_eq!(change.is_seen(&axis), is_seen, "seed 50: {samples}");
        }
    }

    #[test]
    fn a_settling_between_stretches_that_are_left_out_is_not_seen() {
        let mut values = noise(51);
        // From a tenth of it on for as long as it has most of the rest.
        values[200..3000].fill(f64::NAN);
        let axis = Trial::new(values).axis;
        assert!(!settling(2000.0).is_seen(&axis), "seed 51");
        assert!(settling(20_000.0).is_seen(&axis), "seed 51");
    }
}
