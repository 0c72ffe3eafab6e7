//! Candidates between the points of the grid.

use std::f64::consts::PI;

use rustfft::num_complex::Complex64;

use super::replay::Replay;
use super::survey::Survey;
use crate::fft::phasor::Phasor;
use crate::numeric::top::climb;

/// Blocks that a candidate's demodulated record is kept in.
const BLOCKS: usize = 1024;

/// A line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Frequency, hertz.
    pub frequency_hz: f64,
    /// One standard deviation of it, hertz.
    pub frequency_sd_hz: f64,
    /// Amplitude `A` of `A cos(2 pi f t + p)`, in the unit of the samples.
    pub amplitude: f64,
    /// Power over the floor.
    pub ratio: f64,
    /// Family-wise probability of a line as strong anywhere without one.
    pub false_alarm: f64,
}

impl Survey {
    /// Evaluates candidates between the grid's points: the record is demodulated into blocks,
    /// whose sum at nearby frequencies follows without another replay.
    pub(super) fn refine<R: Replay + ?Sized>(
        &self,
        record: &R,
        candidates: &[(f64, f64)],
    ) -> Result<Vec<Line>, R::Error> {
        if candidates.is_empty() {
            return Ok(Vec::new());
        }
        let block = (self.len as usize).div_ceil(BLOCKS);
        let mut sums = vec![vec![Complex64::default(); BLOCKS]; candidates.len()];
        let phasors = candidates.iter().map(|&(cycles, _)| Phasor::new(-cycles));
        let phasors: Vec<Phasor> = phasors.collect();
        self.tapered(record, |at, values| {
            for (sums, phasor) in sums.iter_mut().zip(&phasors) {
                let mut start = 0;
                while start < values.len() {
                    let index = at + start;
                    let end = values.len().min(start + block - index % block);
                    let mut sum = Complex64::ZERO;
                    phasor.zip(index, &values[start..end], Complex64::ONE, |x, turned| {
                        sum += turned * x;
                    });
                    sums[index / block] += sum;
                    start = end;
                }
            }
        })?;
        Ok(candidates
            .iter()
            .zip(&sums)
            .map(|(&(cycles, _), sums)| self.line(cycles, block, sums))
            .collect())
    }

    /// Highest point within a bin of a candidate.
    fn line(&self, cycles: f64, block: usize, sums: &[Complex64]) -> Line {
        let power = |offset_bins: f64| {
            let step = -2.0 * PI * offset_bins * block as f64 / self.len as f64;
            let total: Complex64 = sums
                .iter()
                .enumerate()
                .map(|(index, sum)| sum * Complex64::from_polar(1.0, step * index as f64))
                .sum();
            total.norm_sqr()
        };
        let (offset, height) = climb(0.0, 0.25, 1e-4, power);
        let frequency_hz = (cycles + offset / self.len as f64) * self.rate_hz;
        let ratio = self.ratio(height, frequency_hz);
        let false_alarm = if self.slow_at(frequency_hz).is_some() {
            self.slow_false_alarm(ratio, frequency_hz)
        } else {
            self.false_alarm(ratio, self.floor.relative_sd_at(frequency_hz))
        };
        Line {
            frequency_hz,
            // Cramer-Rao bound of a single tone (Rife and Boorstyn 1974, eq. 16).
            frequency_sd_hz: (1.5 / (PI * PI * ratio)).sqrt() / self.duration_s(),
            amplitude: 2.0 * height.sqrt() / self.taper_sum(),
            ratio,
            false_alarm: false_alarm.min(1.0),
        }
    }
}
