//! How loud a stretch is in which the record's own noise is louder, and from which sample to which.
//!
//! Errors of prediction have the same law everywhere but for their strength. Forward, the first of the stretch is the
//! first that is large; backward, the last: each end is where two strengths gain most.

use std::ops::Range;

use super::even::strength;
use crate::diagnosis::detect::burst::Burst;
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::steady::prediction::{ORDER, Prediction};

/// Errors of a part whose strength can be told, at least: a choice. A mean of so many squares scatters by a third.
const LEAST: usize = 16;

/// The burst about `samples` of a record, of which `values` are those from the sample `from` on; `None` where it has no
/// noise beside it, or is not louder than that.
pub fn measured(
    prediction: &Prediction,
    values: &[f64],
    samples: &Range<usize>,
    from: usize,
) -> Option<Burst> {
    let place = samples.start.checked_sub(from)?..samples.end.checked_sub(from)?;
    let level = values.iter().sum::<f64>() / values.len() as f64;
    let values: Vec<f64> = values.iter().map(|value| value - level).collect();
    let forward = prediction.errors(&values);
    let reversed: Vec<f64> = values.iter().rev().copied().collect();
    let backward = prediction.errors(&reversed);
    let len = values.len();
    let first = first_loud(&forward, &place);
    let last = first_loud(&backward, &(len - place.end..len - place.start));
    let [start, end] = [first.unwrap_or(0), len - last.unwrap_or(0)];
    // The first errors rest on fewer samples.
    let inside = forward.get(start.max(ORDER)..end)?;
    let before = forward[..start].iter().skip(ORDER);
    let after = backward[..len - end].iter().skip(ORDER);
    let outside: Vec<f64> = before.chain(after).copied().collect();
    if inside.len() < LEAST || outside.len() < LEAST {
        return None;
    }
    let (loud, own) = strength(inside);
    let (quiet, _) = strength(&outside);
    let ratio = loud / quiet;
    let count = own * inside.len() as f64;
    let nats = 0.5 * count * (ratio - 1.0 - ratio.ln());
    let one = p_value::mean_square(ratio, count);
    // An end near that of the record may be anywhere from there on; between two samples otherwise, and as in the search
    // for weaker ones.
    let open_sd = if first.and(last).is_some() {
        1.0
    } else {
        (ORDER + LEAST) as f64
    };
    (ratio > 1.0).then(|| Burst {
        range: from + start..from + end,
        factor: ratio.sqrt(),
        log_factor_sd: (0.5 / count + 0.5 / outside.len() as f64).sqrt(),
        level: None,
        end_sd: open_sd.hypot(2.0 / (0.5 * (ratio - 1.0 - ratio.ln())).max(1e-6)),
        nats,
        held_nats: Some(held_out(inside, quiet, own)),
        // Anywhere, of any length.
        p_value: p_value::searched(one, 16.0 * (from + len) as f64),
    })
}

/// The first of some errors from which on, to the end of a `place`, they are of another strength than before; `None`
/// where too few are before it.
fn first_loud(errors: &[f64], place: &Range<usize>) -> Option<usize> {
    let reach = place.len().max(LEAST);
    let from = place.start.saturating_sub(reach).max(ORDER + LEAST);
    if place.start < from {
        return None;
    }
    let squares =
        |range: Range<usize>| errors[range].iter().map(|error| error * error).sum::<f64>();
    let (mut before, mut after) = (squares(ORDER..from), squares(from..place.end));
    let mut best = (f64::NEG_INFINITY, None);
    for n in from..place.end.saturating_sub(LEAST) {
        let (quiet, loud) = ((n - ORDER) as f64, (place.end - n) as f64);
        let gain = -quiet * (before / quiet).ln() - loud * (after / loud).ln();
        if gain > best.0 {
            best = (gain, Some(n));
        }
        let square = errors[n] * errors[n];
        before += square;
        after -= square;
    }
    best.1
}

/// Gain in log-likelihood of every other error for a strength that is fitted to the others, over the `quiet` one; the
/// share `own` of them are numbers of their own.
fn held_out(errors: &[f64], quiet: f64, own: f64) -> f64 {
    let mean = |first: usize| {
        let half: Vec<f64> = errors
            .iter()
            .skip(first)
            .step_by(2)
            .map(|one| one * one)
            .collect();
        (
            half.iter().sum::<f64>() / half.len() as f64,
            half.len() as f64,
        )
    };
    let ((fitted, _), (held, count)) = (mean(0), mean(1));
    0.5 * own * count * (held / quiet - held / fitted - (fitted / quiet).ln())
}
