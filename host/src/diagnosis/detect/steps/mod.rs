//! Steps: the level jumps and stays. Jumps to and fro by as much are two levels (`telegraph`).

mod filter;
mod heights;
mod pursuit;
#[cfg(test)]
mod tests;

use crate::diagnosis::axis::profile::Noise;
use crate::diagnosis::detect::look::{Lesson, Look, Proposal};
use crate::diagnosis::detect::slow_change::LEAST_GAIN;
use crate::diagnosis::detect::{burst, telegraph};
use crate::diagnosis::explanation::{Candidate, Change, Explanation};
use crate::diagnosis::record::wave::{Jump, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::steps::KIND;
use crate::model::{thermal, warmup};
pub use filter::{is_jump, statistic};
use pursuit::Pursuit;

/// Jumps that are named one by one, at most: a choice. Each costs another look at the slow copy;
/// with more, their spectrum says what they are.
pub const MOST_JUMPS: usize = 150;

/// The largest jump of an axis that is significant, unless it is the business of another detector.
pub fn find(look: &Look<'_>, noise: Noise) -> Option<Jump> {
    if look.character.level_switches {
        return None;
    }
    Pursuit::new(look).largest(noise)
}

/// What is to be done about the jumps of which `first` is the largest.
pub fn proposals(look: &Look<'_>, first: Jump) -> Vec<Proposal> {
    let axis = look.axis;
    let place = known(look);
    let mut jumps = place.map_or_else(Vec::new, |place| jumps_of(&axis.explanations()[place]));
    let mut pursuit = Pursuit::new(look);
    let new = pursuit.all(first, jumps.len());
    if new.is_empty() {
        return Vec::new();
    }
    let gain = pursuit.gain(&new);
    join(&mut jumps, new, 4 * axis.slow_factor());
    if jumps.len() > MOST_JUMPS {
        // Their spectrum decides, and another look at an axis that switches.
        let kinds = place.map(|place| axis.explanations()[place].kind());
        return vec![
            Proposal::Learn(Lesson::LevelSwitches),
            Proposal::Withdraw(kinds.into_iter().collect()),
        ];
    }
    let effect = if telegraph::is_to_and_fro(&jumps) {
        telegraph::of_jumps(&jumps, look.duration_s())
    } else {
        estimate(&jumps, axis.rate_hz)
    };
    if !look.is_open(effect.kind) {
        return Vec::new();
    }
    let before = place.map(|place| &axis.explanations()[place]);
    let held_out_nats = match before {
        Some(one) => one.held_out_nats.map(|nats| nats + gain),
        None => Some(gain),
    };
    let freedom = 2.0 * jumps.len() as f64;
    let change = Change::Waves(vec![Wave::Steps(jumps)]);
    let reopens = if place.is_some() {
        Vec::new()
    } else {
        // What is slower may have been found for the jumps.
        vec![warmup::KIND, thermal::KIND]
    };
    vec![Proposal::Explain(Box::new(Candidate {
        held_out_nats,
        amends: place,
        reopens,
        ..Candidate::new(effect, first.p_value, freedom, change)
    }))]
}

/// Steps that are known, where their heights are known better now: first they were measured in noise that they raised
/// themselves.
pub fn measured_again(look: &Look<'_>) -> Option<Proposal> {
    /// How many times better a height is known from which it is told anew: a choice. Noise without the jumps is known anew
    /// after each change.
    const BETTER: f64 = 1.5;
    let axis = look.axis;
    let place = look.place_of(KIND)?;
    let known = &axis.explanations()[place];
    let before = jumps_of(known);
    let mut jumps = before.clone();
    heights::measure(axis, &mut axis.filled.to_vec(), &mut jumps);
    let both = || before.iter().zip(&jumps);
    let moved = both().map(|(old, new)| ((new.height - old.height) / new.height_sd).powi(2));
    let gained_nats = 0.5 * moved.sum::<f64>();
    let is_better = both().any(|(old, new)| old.height_sd > BETTER * new.height_sd);
    // A weaker jump did not raise the noise, and must stand in what it was found in.
    let is_strong = jumps.iter().any(Jump::is_strong);
    let is_known_better = is_better || gained_nats > LEAST_GAIN * jumps.len() as f64;
    (is_strong && is_known_better).then(|| {
        let effect = estimate(&jumps, axis.rate_hz);
        let change = Change::Waves(vec![Wave::Steps(jumps)]);
        Proposal::Explain(Box::new(Candidate {
            held_out_nats: known.held_out_nats,
            amends: Some(place),
            ..Candidate::new(effect, known.p_value, known.freedom, change)
        }))
    })
}

/// Number of the explanation that jumps of an axis belong to; the levels that a stretch of motion leaves are its own.
fn known(look: &Look<'_>) -> Option<usize> {
    let mut explanations = look.axis.explanations().iter();
    explanations.position(|one| !one.happened() && !jumps_of(one).is_empty())
}

/// Jumps of an explanation.
fn jumps_of(one: &Explanation) -> Vec<Jump> {
    let jumps = one.waves().iter().filter_map(|wave| match wave {
        Wave::Steps(jumps) => Some(jumps.as_slice()),
        _ => None,
    });
    jumps.flatten().copied().collect()
}

/// Joins new jumps with those that are known: within `reach` samples it is the same one again.
fn join(jumps: &mut Vec<Jump>, new: Vec<Jump>, reach: usize) {
    for jump in new {
        let same = |old: &&mut Jump| old.index.abs_diff(jump.index) <= reach;
        match jumps.iter_mut().find(same) {
            // What was left of its height.
            Some(old) => old.height += jump.height,
            None => jumps.push(jump),
        }
    }
    jumps.sort_by_key(|jump| jump.index);
}

/// The effect of jumps that stay, with the moment and the height of each.
fn estimate(jumps: &[Jump], rate_hz: f64) -> Estimate {
    /// Standard deviation of a moment between two samples, over their distance: `1 / sqrt 12`.
    const BETWEEN: f64 = 0.288_675_134_594_812_9;
    let rows = jumps.iter().flat_map(|jump| {
        // It came between the sample that has it first and the one before.
        let index = jump.index as f64 - 0.5;
        let index_sd = jump.index_sd.hypot(BETWEEN);
        [
            Value::normal(index / rate_hz, index_sd / rate_hz),
            Value::normal(jump.height, jump.height_sd),
        ]
    });
    Estimate::new(KIND, rows)
}

/// Whether a jump lies in a loud stretch that is worth more: there the level seems to jump, as about a jump the
/// noise seems loud.
fn is_of_burst(look: &Look<'_>, jump: &Jump, index: usize) -> bool {
    let louder = burst::even(look).filter(|burst| {
        let nats = -burst.p_value.max(f64::MIN_POSITIVE).ln();
        burst.range.len() >= burst::LONG_STRETCH && nats > 0.5 * jump.z * jump.z
    });
    louder.is_some_and(|burst| burst.range.contains(&index))
}
