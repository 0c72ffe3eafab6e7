//! A loss of samples, and the lines that are steady but for it.

use std::f64::consts::PI;

use super::line::LINE_REACH;
use super::peaks;
use crate::diagnosis::record::wave::Wave;
use crate::spectrum::Line as Peak;

/// Samples lost without a trace.
#[derive(Debug, Clone, PartialEq)]
pub struct Loss {
    /// Index of the first sample after the loss.
    pub index: usize,
    /// Standard deviation of it, samples.
    pub index_sd: f64,
    /// Lower end of the index' 95 % interval, samples.
    pub index_lo: f64,
    /// Upper end of that interval, samples.
    pub index_hi: f64,
    /// Samples lost. Numbers that differ by a common period of all lines cannot be distinguished:
    /// the smallest.
    pub samples: u32,
    /// 95 % interval of that number, half a sample beyond the whole numbers that it holds.
    pub samples_lo: f64,
    /// Upper end of that interval.
    pub samples_hi: f64,
    /// Gain in log-likelihood over steady lines.
    pub nats: f64,
    /// The same on blocks that nothing was fitted to.
    pub held_nats: f64,
    /// Bound for the probability of as much in steady lines, trials counted.
    pub p_value: f64,
    /// The lines, steady once the loss is taken into account.
    pub lines: Vec<SteadyLine>,
}

/// A line: `cosine cos(2 pi cycles n) + sine sin(2 pi cycles n)` for sample `n` ahead of the loss,
/// with `n + samples` in place of `n` from [`Loss::index`] on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyLine {
    /// Frequency, cycles a sample.
    pub cycles: f64,
    /// Size of the cosine.
    pub cosine: f64,
    /// Size of the sine.
    pub sine: f64,
    /// Standard deviation of the frequency for not knowing how many samples are lost.
    pub cycles_sd: f64,
    /// The same of the amplitude.
    pub amplitude_sd: f64,
    /// Gain in log-likelihood over no line: its power over the noise.
    pub nats: f64,
}

impl SteadyLine {
    /// As a search of the whole record, loss repaired, would report it.
    pub fn peak(&self, rate_hz: f64, duration_s: f64) -> Peak {
        Peak {
            frequency_hz: self.cycles * rate_hz,
            // Cramer-Rao bound of a single tone (Rife and Boorstyn 1974, eq. 16).
            frequency_sd_hz: ((1.5 / (PI * PI * self.nats)).sqrt() / duration_s)
                .hypot(self.cycles_sd * rate_hz),
            amplitude: self.cosine.hypot(self.sine),
            ratio: self.nats,
            false_alarm: self.false_alarm(),
        }
    }

    /// Probability of as much at one of the places tried: a cycle a record is one trial, and
    /// Rice's formula adds a factor of a few.
    pub(super) fn false_alarm(&self) -> f64 {
        let trials = f64::from(peaks::HARMONICS) * 4.0 * LINE_REACH * (PI * self.nats / 3.0).sqrt();
        (trials * (-self.nats).exp()).min(1.0)
    }
}

impl Loss {
    /// The lines as [`Wave::take_out`] takes them out.
    pub fn waves(&self) -> impl Iterator<Item = Wave> + '_ {
        self.lines.iter().map(|line| Wave::Line {
            cycles: line.cycles,
            cosine: line.cosine,
            sine: line.sine,
            lost: Some((self.index, self.samples)),
        })
    }
}
