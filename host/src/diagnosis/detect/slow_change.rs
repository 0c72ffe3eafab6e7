//! A slow change of the level, as its detectors measure it on the record's slow copy.

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

/// What is to be done about a slow change that was measured again, and what it gains there and what it gains as it was
/// known, nats.
pub type MeasuredAgain = (Proposal, f64, f64);
