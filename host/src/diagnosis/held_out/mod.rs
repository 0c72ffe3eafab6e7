//! What a finding is worth on data that the fit has not seen.
//!
//! Three ways of holding data out, each of them so that both halves see the same hours:
//!
//! - Lines: the record is cut into blocks, every other one held out. The model with and without a
//!   finding is fitted to the one half alone and judged by the likelihood of the other half's
//!   spectrum. A line's frequency, size and phase are those of the whole record; for each number so
//!   fitted half a nat is taken off, what it gains on average by having seen the held-out half.
//! - Laws of the noise ([`laws`]): sizes fitted to the even ordinates of the whole record's transform
//!   and judged by the odd ones, which are independent of them; short blocks would not see the
//!   slowest. Shapes are those of the whole record, at half a nat each.
//! - Waveforms in time (steps, settling, outliers, what follows a covariate): fitted to the even
//!   ordinates of the record's transform and judged by the odd ones, which are independent.
//! - A stretch of another variance: fitted to the even ones of short blocks, judged by the odd.

pub mod allan;
pub mod laws;
pub mod size;

use std::ops::Range;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::explanation::{Explanation, Snapshot};
use crate::diagnosis::laws::{expected, search};
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::record::residual::Residual;
use crate::fit::likelihood::components::SEEN;
use crate::fit::likelihood::log_likelihood;
use crate::model::PerCoefficient;
use crate::model::marks::Mark;

/// Gain that a name for the noise itself needs there, nats: all ordinates or blocks speak of it. What is fitted to one half
/// is one law among all for the other. Where nothing is there the mean of `e^gain` is 1 at most, so that a gain of 3 is chance in
/// one of twenty (Markov's inequality).
pub const ENOUGH_NATS: f64 = 3.0;

/// Blocks of the record, half of them held out: a choice. Of fewer both halves would not see the
/// same hours, shorter ones would not see what is slow.
pub const BLOCKS: usize = 16;

/// Upper over lower end of an excluded band beyond which it is no line's own: what wanders or beats stays within an octave.
const WIDE: f64 = 2.0;

/// Nats for each number that was fitted to all of the record: what it gains on average by having
/// seen the held-out half.
pub const SEEN_COST: f64 = 0.5;

/// The two halves of an axis.
pub struct Halves {
    train: SpectralBins,
    held: SpectralBins,
    measured: Residual,
}

/// Every other block of a record, with its first index: those fitted to for `parity` 0, those held
/// out for 1.
fn half(values: &[f64], parity: usize) -> impl Iterator<Item = (usize, &[f64])> + Clone {
    let block = values.len().div_ceil(BLOCKS).max(1);
    let parts = values.chunks(block).enumerate();
    let parts = parts.map(move |(number, part)| (number * block, part));
    parts.skip(parity).step_by(2)
}

impl Halves {
    /// The halves of an axis, with the masks that were found at last.
    pub fn new(axis: &AxisState) -> Option<Self> {
        Self::leaving_out(axis, &axis.excluded_hz())
    }

    /// The same for lines that stand in [wide](WIDE) excluded bands, of which nothing would be seen: these bands count. `None`
    /// where there are none.
    pub fn of_hidden(axis: &AxisState, lines: &Explanation) -> Option<Self> {
        let marks = lines.kind().marks(&lines.effect.plain());
        let is_own = |band_hz: &Range<f64>| {
            let mut lines = marks.iter();
            let is_wide = band_hz.end > WIDE * band_hz.start;
            is_wide
                && lines
                    .any(|mark| matches!(mark, Mark::Line { f_hz, .. } if band_hz.contains(f_hz)))
        };
        let (own, others): (Vec<_>, Vec<_>) = axis.excluded_hz().into_iter().partition(is_own);
        (!own.is_empty()).then(|| Self::leaving_out(axis, &others))?
    }

    fn leaving_out(axis: &AxisState, excluded_hz: &[Range<f64>]) -> Option<Self> {
        let measured = axis.residual.with([]);
        let values = measured.values();
        let chain = axis.chain.as_ref();
        let bins = |parity| SpectralBins::of_parts(half(&values, parity), axis.rate_hz, chain);
        let (train, held) = rayon::join(|| bins(0), || bins(1));
        let (mut train, mut held) = (train?, held?);
        for bins in [&mut train, &mut held] {
            bins.leave_out(excluded_hz);
            bins.know_floor(axis.bins.floor());
        }
        Some(Self {
            train,
            held,
            measured,
        })
    }

    /// Log-likelihood of the held-out half under the model of a snapshot fitted to the other.
    fn score(&self, snapshot: &Snapshot) -> Option<f64> {
        let values = self.measured.with(snapshot.waves().cloned()).values();
        let (train, held) = rayon::join(
            || self.train.measure_parts(half(&values, 0)),
            || self.held.measure_parts(half(&values, 1)),
        );
        drop(values);
        let mut laws = snapshot.laws.clone();
        let fit = search::polish(&self.train, &train, &mut laws, 0, 0.05)?;
        let expected = expected(&self.held, &laws, &fit.squared);
        Some(log_likelihood(&held, &expected))
    }

    /// Predictive gain of a finding, nats.
    pub fn nats(&self, one: &Explanation) -> Option<f64> {
        let gain = self.score(&one.with)? - self.score(&one.without)?;
        Some(gain - SEEN_COST * one.freedom)
    }
}

/// Coefficients of a fit's squares.
pub fn coefficients(squared: &[f64]) -> PerCoefficient<f64> {
    PerCoefficient::from_fn(|one| {
        SEEN.iter()
            .position(|seen| *seen == one)
            .map_or(0.0, |place| squared[place].sqrt())
    })
}

#[cfg(test)]
mod tests;
