//! Burst: for a while the noise is larger, or smaller, at the same level.

pub mod even;
mod stretch;
#[cfg(test)]
mod tests;

use std::ops::Range;

use super::{Detector, coarse_grid, strength, telegraph};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::runs::runs_of;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::steady::band_events::is_of_excluded;
use crate::diagnosis::steady::lasting::Lasting;
use crate::model::burst::KIND;
use crate::model::{outliers, rounding};
pub use stretch::{Burst, burst};

/// Stretches at most: with more, it comes and goes all the time. Three are a choice.
pub const MOST_STRETCHES: usize = 3;

/// Samples from the end of a burst within which a short stretch belongs to it: a choice, two
/// seconds at 2000/s.
const NEAR_BURST: f64 = 4096.0;

/// Samples about an outlier where something of it may stay: a block of the powers.
const REMAINS: usize = 64;

/// Samples of a stretch that is no shock: a choice, half a second at 2000/s.
pub const LONG_STRETCH: usize = 1024;

/// Looks for the stretch that departs most from the rest.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    if !look.is_open(KIND) {
        return Ok(Vec::new());
    }
    let Some(burst) = even(look).filter(|burst| !lasts(look, &burst.range)) else {
        return Ok(Vec::new());
    };
    let axis = look.axis;
    let known = axis.explanations().iter().filter(|one| one.kind() == KIND);
    if known.count() == MOST_STRETCHES {
        return Ok(strength::moves());
    }
    // Where the level switches, a stretch shorter than its dwell is two jumps too close to be
    // resolved.
    let dwell_s = telegraph::levels(axis).map_or(0.0, |levels| levels.dwell_s);
    if (burst.range.len() as f64) < dwell_s * axis.rate_hz {
        return Ok(Vec::new());
    }
    let mut candidate = candidate(axis, &burst);
    // Large samples of the stretch may have passed for them.
    candidate.supersedes.push(outliers::KIND);
    Ok(vec![Proposal::Explain(Box::new(candidate))])
}

/// The stretch that departs most from the rest, if it is a burst: not most of the record, not of a
/// band alone, no rest on a coarse grid, and no more than where the level lies between two of its values makes.
pub fn even(look: &Look<'_>) -> Option<Burst> {
    let axis = look.axis;
    if look.character.strength_moves || coarse_grid::decides(axis) {
        return None;
    }
    let burst = burst(&axis.powers(), look.level())?;
    let of_grid = coarse_grid::most_power(axis).ln();
    if 2.0 * burst.factor.ln().abs() < of_grid {
        return None;
    }
    let seen = axis.whitened();
    let range = &burst.range;
    // A stretch that is most of the record is its law.
    let is_law = range.len() > seen.transform.len() / 2;
    let rests = burst.factor < 1.0 && axis.has(rounding::KIND);
    // Of samples that were taken out close together, something stays.
    let near = range.start.saturating_sub(REMAINS)..range.end + REMAINS;
    let mut outliers = axis.residual.outliers().iter();
    let remains = range.len() <= 4 * REMAINS && outliers.any(|one| near.contains(&one.index));
    // What is stronger in some band only is something else.
    let of_band = || {
        is_of_excluded(axis, std::slice::from_ref(range))
            || !even::evenness(&seen, range).is_even(look.level())
    };
    (!is_law && !rests && !remains && !of_band()).then_some(burst)
}

/// Whether a stretch is as loud as noise whose strength lasts is anyway.
fn lasts(look: &Look<'_>, range: &Range<usize>) -> bool {
    let axis = look.axis;
    let values = axis.residual.seen();
    let is_there = |n: usize| axis.usable(n) && !range.contains(&n) && values[n].is_finite();
    let quiet = runs_of(values.len(), is_there);
    Lasting::of(&values, &quiet, 0.0).is_some_and(|law| law.foretells(&values, range, look.level()))
}

/// A burst, or what is left of one that is known: noise that is switched behind the converter's filter leaves
/// what the filter shuts out.
pub fn candidate(axis: &AxisState, burst: &Burst) -> Candidate {
    let rate_hz = axis.rate_hz;
    let end = |index: usize| Value::normal(index as f64 / rate_hz, burst.end_sd / rate_hz);
    let factor = Value::log_normal(burst.factor, burst.log_factor_sd);
    let ends = [end(burst.range.start), end(burst.range.end)];
    let known = axis.explanations().iter().enumerate();
    let mut known = known.filter(|(_, one)| one.kind() == KIND);
    let near = known.find(|(_, one)| {
        let old = crate::model::burst::Burst::of(&one.effect.plain());
        let [from, to] = [old.from_s * rate_hz, old.to_s * rate_hz];
        let [start, end] = [burst.range.start as f64, burst.range.end as f64];
        let apart = (start - to).max(from - end);
        (to - from).min(end - start) <= LONG_STRETCH as f64 && apart < NEAR_BURST
    });
    let Some((place, old)) = near else {
        // The ends are known to within some blocks.
        let wide = 3.0 * burst.end_sd;
        let from = (burst.range.start as f64 - wide).max(0.0) as usize;
        let to = ((burst.range.end as f64 + wide) as usize).min(axis.residual.len());
        let level = burst.level.map(|samples| Value::told(samples / rate_hz));
        let effect = Estimate {
            kind: KIND,
            values: [ends[0], ends[1], factor]
                .map(Some)
                .into_iter()
                .chain([level])
                .collect(),
        };
        return Candidate {
            held_out_nats: burst.held_nats,
            ..Candidate::new(effect, burst.p_value, 3.0, Change::Mask(vec![from..to]))
        };
    };
    let mut stretches = match &old.change {
        Change::Mask(stretches) => stretches.clone(),
        _ => Vec::new(),
    };
    stretches.push(burst.range.clone());
    Candidate {
        held_out_nats: burst.held_nats.or(old.held_out_nats),
        amends: Some(place),
        ..Candidate::new(
            joined(
                &old.effect,
                ends,
                factor,
                burst.range.len() as f64 / rate_hz,
            ),
            old.p_value,
            old.freedom,
            Change::Mask(stretches),
        )
    }
}

/// A burst and a stretch that is a part of it: of the longer one's factor, between the outer ends of both.
fn joined(old: &Estimate, ends: [Value; 2], factor: Value, length_s: f64) -> Estimate {
    let of_old = |place: usize| old.values[place].unwrap_or(Value::exact(0.0));
    let is_longer = of_old(1).value - of_old(0).value > length_s;
    let from = if of_old(0).value < ends[0].value {
        of_old(0)
    } else {
        ends[0]
    };
    let to = if of_old(1).value < ends[1].value {
        ends[1]
    } else {
        of_old(1)
    };
    Estimate::new(KIND, [from, to, if is_longer { of_old(2) } else { factor }])
}
