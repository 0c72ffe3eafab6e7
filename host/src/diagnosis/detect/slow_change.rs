//! A slow change of the level, as its detectors measure it on the record's slow copy.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::look::Proposal;
use crate::diagnosis::record::wave::Wave;

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
    /// Whether most of a settling lies where the record was measured and is not excluded: behind its first sample. What
    /// has no time constant from its start on is seen.
    pub fn is_seen(&self, axis: &AxisState) -> bool {
        let Wave::WarmUp { samples, .. } = self.wave else {
            return true;
        };
        let values = axis.residual.values();
        let first = values.iter().position(|value| value.is_finite());
        // Its square falls to a half within that part of its time constant.
        first.is_some_and(|first| (first as f64) < 0.5 * std::f64::consts::LN_2 * samples)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{Trial, noise};

    #[test]
    fn a_settling_before_the_first_sample_is_not_seen() {
        let mut values = noise(50);
        values[..1000].fill(f64::NAN);
        let axis = Trial::new(values).axis;
        // A half of its square is over after 0.35 of its time constant.
        for (samples, is_seen) in [(100.0, false), (2500.0, false), (3500.0, true)] {
            let change = SlowChange {
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
            };
            assert_eq!(change.is_seen(&axis), is_seen, "seed 50: {samples}");
        }
    }
}
