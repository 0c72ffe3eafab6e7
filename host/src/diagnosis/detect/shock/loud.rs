//! How loud a stretch is in which the record's own noise is louder, and from which sample to which.
//!
//! Errors of prediction have the same law everywhere but for their strength. Forward, the first of the stretch is the
//! first that is large; backward, the last: each end is where two strengths gain most.

use std::f64::consts::TAU;
use std::ops::Range;

use super::about::Beside;
use super::even::{LONG, strength as strength_of};
use super::quiet::Quiet;
use super::scan::Scan;
use super::strength::{self, Inside};
use crate::diagnosis::detect::burst::Burst;
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::steady::prediction::{ORDER, Prediction};
use crate::numeric::normal::TWO_SIDED_95;

/// Errors of a part whose strength can be told, at least: a choice. A mean of so many squares scatters by a third.
const LEAST: usize = 16;

/// The burst in a stretch of a record in which nothing else happens; `None` where its noise is not louder.
pub fn of(scan: &Scan<'_>, quiet: &Quiet, samples: &Range<usize>) -> Option<Burst> {
    let own = Quiet::about(&quiet.whole, samples);
    let margin = samples.len().max(LONG);
    let from = samples.start.saturating_sub(margin).max(own.start);
    let near = from..(samples.end + margin).min(own.end);
    let beside = Beside {
        values: scan.whole(),
        quiet: &quiet.whole,
        faint: scan.faint(),
    };
    let prediction = beside.prediction(samples, 1)?;
    let mut burst = measured(&prediction, &scan.whole()[near], samples, from)?;
    // What a filter shuts out says less of it than the band that it is in.
    let beside = strength::Beside {
        values: scan.whole(),
        quiet: &quiet.whole,
        own: &own,
    };
    let louder = Inside::new(&beside, &burst.range, None).and_then(|one| one.louder());
    if let Some(louder) = louder.filter(|one| one.factor > 1.0) {
        (burst.factor, burst.log_factor_sd) = (louder.factor, louder.log_factor_sd);
        burst.level = louder.above.map(|cycles| (TAU * cycles).recip());
    }
    // What stands for missing samples is as loud as the record on average.
    burst.log_factor_sd = burst.log_factor_sd.hypot(scan.missing(&burst.range));
    // What may be as loud as the rest is no finding.
    (burst.factor.ln().abs() > TWO_SIDED_95 * burst.log_factor_sd).then_some(burst)
}

/// The burst about `samples` of a record, of which `values` are those from the sample `from` on; `None` where it has no
/// noise beside it, or is not louder than that.
fn measured(
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
    let (loud, own) = strength_of(inside);
    let (quiet, _) = strength_of(&outside);
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
    let last = place.end.saturating_sub(LEAST);
    for (n, error) in errors.iter().enumerate().take(last).skip(from) {
        let (quiet, loud) = ((n - ORDER) as f64, (place.end - n) as f64);
        let gain = -quiet * (before / quiet).ln() - loud * (after / loud).ln();
        if gain > best.0 {
            best = (gain, Some(n));
        }
        let square = error * error;
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

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use crate::diagnosis::detect::shock::DETECTOR;
    use crate::diagnosis::detect::trial::{self, RATE_HZ, Trial, noise};
    use crate::model::burst::{Burst, KIND};
    use crate::model::random::{Gaussian, Seed};

    /// The burst that is told of a record; `None` where there is none.
    fn told(values: Vec<f64>) -> Option<Burst> {
        let found = trial::candidate(Trial::new(values).ask(&DETECTOR))?;
        (found.effect.kind == KIND).then(|| Burst::of(&found.effect.plain()))
    }

    /// A record in which a stretch is so many times as loud.
    fn record(seed: u64, stretch: Range<usize>, factor: f64) -> Vec<f64> {
        let mut values = noise(seed);
        values[stretch].iter_mut().for_each(|one| *one *= factor);
        values
    }

    fn is_told(seed: u64, values: Vec<f64>, stretch: Range<usize>, factor: f64) {
        let found = told(values).unwrap_or_else(|| panic!("seed {seed}, {factor}: nothing"));
        let ends = [(found.from_s, stretch.start), (found.to_s, stretch.end)];
        for (said_s, end) in ends {
            // The two strengths differ by 1.6 nats a sample at a factor of 2.5: an end is off by some of them. One near
            // the record's own is open.
            let off = (said_s * RATE_HZ - end as f64).abs();
            assert!(
                off < 12.0,
                "seed {seed}, {factor}: {found:?} of {stretch:?}"
            );
        }
        // The logarithm of a deviation of n samples under Hann's taper is known to sqrt(1.94 / 2 n): five of them.
        let sd = (0.97 / stretch.len() as f64).sqrt();
        let off = (found.factor / factor).ln().abs();
        assert!(off < 5.0 * sd, "seed {seed}, {factor}: {found:?}");
    }

    #[test]
    fn a_louder_stretch_is_told_whatever_its_factor() {
        for (seed, factor) in (40..).zip([2.5, 30.0, 1000.0]) {
            let stretch = 9001..9800;
            is_told(seed, record(seed, stretch.clone(), factor), stretch, factor);
        }
    }

    #[test]
    fn it_is_told_at_both_ends_and_across_single_gaps() {
        let length = noise(43).len();
        for (seed, stretch) in [(43, 0..700), (43, length - 700..length)] {
            is_told(seed, record(seed, stretch.clone(), 20.0), stretch, 20.0);
        }
        let mut values = record(44, 9000..9900, 20.0);
        values
            .iter_mut()
            .step_by(211)
            .for_each(|one| *one = f64::NAN);
        is_told(44, values, 9000..9900, 20.0);
    }

    /// What is slow goes on as it was, and the model says above which frequency it is louder.
    #[test]
    fn slow_noise_beside_it_is_not_louder() {
        let mut values = noise(45);
        values[9000..10_200].iter_mut().for_each(|one| *one *= 8.0);
        let mut normal = Gaussian::new(
            Seed {
                seed: 45,
                stream: 3,
            },
            0.1,
        );
        let mut level = 0.0;
        for value in &mut values {
            level += normal.draw();
            *value += level;
        }
        let found = told(values).expect("eight times as loud");
        // A walk of 0.1 a sample is as strong as the noise at 1.6 Hz. The corner of a running mean over this time is told to
        // within some octaves.
        let corner_hz = 1.0 / (std::f64::consts::TAU * found.level_s);
        assert!((0.4..6.4).contains(&corner_hz), "seed 45: {found:?}");
        let sd = (0.97_f64 / 1200.0).sqrt();
        let off = (found.factor / 8.0).ln().abs();
        assert!(off < 5.0 * sd, "seed 45: {found:?}");
    }

    #[test]
    fn clean_records_hold_none() {
        // At a level of 2e-4 each, one of 60 has a probability of 1.2 %.
        let seen: Vec<u64> = (200..260)
            .filter(|&seed| told(noise(seed)).is_some())
            .collect();
        assert!(seen.is_empty(), "seeds {seen:?}");
    }
}
