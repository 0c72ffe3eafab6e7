//! A line of a record at a loss: steady, or with its phase turned by so many samples.

use std::f64::consts::TAU;

use rustfft::num_complex::Complex64;

use super::demodulate::{Blocks, Demodulated, Turn};
use crate::diagnosis::record::wave::Wave;

/// How far from a steady line's best frequency the line may be, cycles a record: four times the
/// 0.74 by which a jump by half a cycle in the middle moves its peaks. Four is a choice.
pub(super) const LINE_REACH: f64 = 3.0;

/// A line and its best steady fit.
pub(crate) struct Line {
    pub(crate) seen: Demodulated,
    /// Cycles a record from where it is looked at.
    pub(crate) offset: f64,
    /// Gain in log-likelihood over no line.
    pub(crate) gain: f64,
}

impl Line {
    /// The best steady line within `reach` cycles a record of where it is looked at.
    pub(crate) fn new(seen: Demodulated, reach: f64) -> Self {
        let (offset, gain) = seen.best_offset(0.0, reach, None);
        Self { seen, offset, gain }
    }

    pub(crate) fn cycles(&self, offset: f64, block: usize) -> f64 {
        self.seen.cycles + offset / (self.seen.sums.len() * block) as f64
    }
}

/// A line with a jump of phase.
pub(crate) struct Turned {
    pub(crate) samples: usize,
    pub(crate) turn: Turn,
    pub(crate) offset: f64,
    pub(crate) amplitude: Complex64,
    pub(crate) gain: f64,
}

/// The lines with `samples` lost at `place`, in blocks.
pub(crate) fn fitted(lines: &[Line], place: f64, samples: usize) -> Vec<Turned> {
    lines
        .iter()
        .map(|line| {
            let turn = Turn {
                place,
                angle: TAU * line.seen.cycles * samples as f64,
            };
            let (offset, _) = line.seen.best_offset(line.offset, LINE_REACH, Some(turn));
            let (amplitude, gain) = line.seen.line(offset, Some(turn));
            Turned {
                samples,
                turn,
                offset,
                amplitude,
                gain,
            }
        })
        .collect()
}

/// The lines, each without the others and at its own frequency, against the noise that is left
/// when all are out: as `turned` has them, with the loss ahead of sample `index`.
pub(crate) fn cleaned(
    blocks: &Blocks,
    lines: &[Line],
    turned: &[Turned],
    index: usize,
) -> Vec<Line> {
    let samples = turned.first().map_or(0, |turned| turned.samples);
    let mut left = blocks.values.clone();
    for (line, turned) in lines.iter().zip(turned) {
        let wave = Wave::Line {
            cycles: line.cycles(turned.offset, blocks.len),
            cosine: turned.amplitude.re,
            sine: -turned.amplitude.im,
            lost: Some((index, samples as u32)),
        };
        wave.take_out(&mut left);
    }
    let left = blocks.with(&left);
    lines
        .iter()
        .zip(turned)
        .map(|(line, turned)| {
            let cycles = line.cycles(turned.offset, blocks.len);
            let mut seen = left.at(cycles);
            let turn = Turn {
                place: index as f64 / blocks.len as f64,
                angle: TAU * cycles * samples as f64,
            };
            for block in 0..seen.sums.len() {
                let own = turned.amplitude * seen.template(block, 0.0, Some(turn));
                seen.sums[block] += own * seen.weights[block];
            }
            Line::new(seen, 2.0 * LINE_REACH)
        })
        .collect()
}
