//! Samples lost without a trace, by the lines that jump with them.

use crate::diagnosis::detect::dropped;
use crate::diagnosis::detect::lines::{self, Group, Measured};
use crate::diagnosis::record::residual::Wave;
use crate::diagnosis::result::finding::Value;
use crate::diagnosis::rounds::{Rounds, named};
use crate::spectrum::Line;

/// Samples on either side of a loss that no law of a whole record speaks for: the noise itself is
/// cut there, and a steep filter remembers that many.
const CUT: f64 = 64.0;

/// Lines that are followed.
const MOST: usize = 16;

/// Standard deviations of the moment that are left out as well.
const UNSURE: f64 = 3.0;

impl Rounds<'_> {
    /// Takes out lines that all jump in phase at one moment, and leaves the moment out: where
    /// noise is cut there are bad samples and bursts that are nothing of their own.
    pub(crate) fn lost(&mut self, groups: &[Group]) -> Option<bool> {
        let mut found: Vec<Line> = groups
            .iter()
            .flat_map(|group| match group {
                Group::Single(one) => vec![one.line],
                Group::Hum { lines, .. } => lines.iter().map(|(_, one)| one.line).collect(),
                Group::Cluster { lines, .. } => lines.clone(),
            })
            .collect();
        // Once lines are out, what a loss leaves of them is no measure of it.
        let is_line = |wave: &Wave| matches!(wave, Wave::Line { .. });
        if self.refused.contains(&"dropped") || self.axis.mended.waves.iter().any(is_line) {
            return Some(false);
        }
        // The strongest tell it; a record of many lines has no time for all of them.
        found.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
        found.truncate(MOST);
        let lines: Vec<f64> = found.iter().map(|line| line.frequency_hz).collect();
        if self.kept == lines {
            return Some(false);
        }
        let Some(loss) = dropped::lost_samples(self.axis, &found, self.level()) else {
            self.kept = lines;
            return Some(false);
        };
        let rate_hz = self.axis.rate_hz;
        let duration_s = self.axis.filled.len() as f64 / rate_hz;
        let measured = loss
            .waves()
            .zip(&loss.lines)
            .map(|(wave, steady)| Measured {
                line: steady.peak(rate_hz, duration_s),
                wave,
                amplitude_sd: (4.0 * self.axis.density(steady.cycles * rate_hz) / duration_s)
                    .sqrt()
                    .hypot(steady.amplitude_sd),
            })
            .collect();
        for group in lines::with_hum(measured) {
            match group {
                Group::Single(one) => self.single(one)?,
                Group::Hum {
                    base_hz,
                    base_sd_hz,
                    lines,
                } => self.hum(base_hz, base_sd_hz, lines)?,
                Group::Cluster { .. } => false,
            };
        }
        let parameters = named([
            (
                "time_s_1",
                Value {
                    value: loss.index as f64 / rate_hz,
                    lo: Some(loss.index_lo / rate_hz),
                    hi: Some(loss.index_hi / rate_hz),
                },
            ),
            (
                "samples_1",
                Value {
                    value: f64::from(loss.samples),
                    lo: Some(loss.samples_lo),
                    hi: Some(loss.samples_hi),
                },
            ),
        ]);
        let wide = CUT + UNSURE * loss.index_sd;
        let from = (loss.index as f64 - wide).max(0.0) as usize;
        let to = ((loss.index as f64 + wide) as usize).min(self.axis.mended.len());
        self.accept(
            "dropped",
            parameters,
            loss.p_value,
            2.0,
            Some(loss.held_nats),
            |axis| {
                axis.mended.lost.push(from..to);
                axis.refresh()
            },
        )
    }
}
