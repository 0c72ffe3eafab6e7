//! Outliers: single samples that do not belong.

mod beginning;
mod edges;
pub mod filter;
mod jumps;
mod nearby;
mod pursuit;
mod size_law;
#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::Arc;

use super::{Detector, steps};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::burst;
use crate::diagnosis::detect::look::{Lesson, Look, Proposal};
use crate::diagnosis::detect::telegraph::short_dwells::is_of_switching;
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::powers::Powers;
use crate::diagnosis::record::wave::{Outlier, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::matched_filter::Transform;
use crate::diagnosis::steady::band_events::is_of_excluded;
use crate::model::kind::Kind;
use crate::model::outliers::KIND;
use crate::model::shock::{self, Shock};
use beginning::Beginning;
use filter::Found;

/// How much further out an outlier must be where the strength of the noise moves: a choice. Its
/// local strength is known by the middle of some blocks only.
const MOVING: f64 = 3.0;

/// Looks for single samples.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let axis = look.axis;
    let in_groups = look.character.large_samples_in_groups;
    if !look.is_open(KIND) || in_groups.is_some_and(|among| taken_out(axis) <= among) {
        return Ok(Vec::new());
    }
    let powers = axis.powers();
    let old = axis.residual.outliers();
    // What else was taken out since they were found.
    let among = axis.explanations().len();
    let mut proposals = Vec::new();
    let mut found = Found::default();
    if old.is_empty() || look.character.outliers_sought_among == among {
        let seen = axis.whitened();
        found = sought(look, &seen.transform, &seen.density, &powers, &[]);
        if found.outliers.is_empty() {
            return Ok(proposals);
        }
    }
    if !old.is_empty() {
        // In noise that they themselves had raised, with lines and jumps still in it, the
        // first are known less well, in size and in place, than they can be now: all are looked
        // for again. What the record is without them makes room meanwhile.
        let density = axis.whitened().density.clone();
        axis.forget_whitened();
        // Those that the filter does not look for stay out of what it sees.
        let is_filtered = filtered(axis);
        let back = old.iter().filter(|one| is_filtered(one.index));
        let back: Vec<Outlier> = back.copied().collect();
        found = sought(look, &axis.with(&back, &density), &density, &powers, &back);
        proposals.push(Proposal::Learn(Lesson::OutliersSoughtAmong(among)));
        let places = |all: &[Outlier]| -> Vec<usize> { all.iter().map(|one| one.index).collect() };
        if places(&found.outliers) == places(old) {
            return Ok(proposals);
        }
        if found.outliers.is_empty() {
            proposals.push(Proposal::Withdraw(vec![KIND]));
            return Ok(proposals);
        }
    }
    proposals.extend(named(look, found, &powers));
    Ok(proposals)
}

/// How much is taken out of an axis beside outliers and laws: what large samples in groups are of may be the next.
fn taken_out(axis: &AxisState) -> usize {
    let explanations = axis.explanations().iter();
    explanations
        .filter(|one| one.kind() != KIND && !matches!(one.change, Change::Law(_)))
        .count()
}

/// What is to be done about large samples: some of them are other things.
fn named(look: &Look<'_>, found: Found, powers: &Powers) -> Vec<Proposal> {
    let moments: Vec<Range<usize>> = found
        .outliers
        .iter()
        .map(|one| one.index..one.index + 1)
        .collect();
    let grouped = filter::together(&found.outliers, look.axis.ring_len()) < look.level();
    let of_something = grouped || is_of_excluded(look.axis, &moments);
    if of_something || is_of_switching(look.axis, &found.outliers) {
        return vec![
            Proposal::Learn(Lesson::LargeSamplesInGroups(taken_out(look.axis))),
            Proposal::Withdraw(vec![KIND]),
        ];
    }
    if is_within_burst(&found, powers, look.level()) {
        return Vec::new();
    }
    vec![Proposal::Explain(Box::new(candidate(look, found)))]
}

/// Whether most of them are what the noise of one louder stretch reaches: then they are no outliers.
fn is_within_burst(found: &Found, powers: &Powers, level: f64) -> bool {
    let Some(burst) = burst::burst(powers, level) else {
        return false;
    };
    let wide = (3.0 * burst.end_sd) as usize;
    let stretch = burst.range.start.saturating_sub(wide)..burst.range.end + wide;
    let reached = burst.factor * found.threshold;
    let is_of_it = |one: &&Outlier| stretch.contains(&one.index) && one.size.abs() <= reached;
    let within = found.outliers.iter().filter(is_of_it).count();
    within > 0 && 3 * within >= 2 * found.outliers.len()
}

fn candidate(look: &Look<'_>, found: Found) -> Candidate {
    let [rate_hz, size] = law(look, &found);
    let freedom = 2.0 * found.outliers.len() as f64;
    let dated = dated(&found.outliers, look.axis.rate_hz);
    let waves = vec![Wave::Outliers(Arc::new(found.outliers))];
    Candidate {
        held_out_nats: Some(found.nats),
        amends: look.place_of(KIND),
        supersedes: single_shocks(look).into_iter().collect(),
        ..Candidate::new(
            Estimate::new(KIND, [rate_hz, size].into_iter().chain(dated)),
            found.p_value,
            freedom,
            Change::Waves(waves),
        )
    }
}

/// How many come a second and how large they are: by the law of those that the filter sees whole, among the samples at
/// which it would, with neighbours that were not drawn to be like them; where these are too few for a law, all that were found, without an interval.
fn law(look: &Look<'_>, found: &Found) -> [Value; 2] {
    let axis = look.axis;
    let is_sought = |n: usize| axis.usable(n) && !axis.is_beside_filled(n, 1);
    let sought = (0..axis.residual.len()).filter(|n| is_sought(*n)).count();
    let seen = found.outliers.iter().filter(|one| is_sought(one.index));
    let seen: Vec<Outlier> = seen.copied().collect();
    let Some(law) = size_law::law_of(&seen, found.threshold, sought) else {
        let squares = found.outliers.iter().map(|one| one.size * one.size);
        let count = found.outliers.len() as f64;
        let size = (squares.sum::<f64>() / count).sqrt();
        return [Value::told(count / look.duration_s()), Value::told(size)];
    };
    let sought_s = sought as f64 / axis.rate_hz;
    [
        Value::log_normal(law.count / sought_s, law.count_log_sd),
        Value::log_normal(law.size, law.size_log_sd),
    ]
}

/// Time and height of each, where there are few.
fn dated(outliers: &[Outlier], rate_hz: f64) -> Vec<Value> {
    /// Up to here the very outliers of a record say more than their law, which gives another record's power to 43 % of
    /// one standard deviation from 16 on (the fourth moment of a Poisson sum of Gaussian heights, `3 / 16`, to one half).
    const FEW: usize = 16;
    if outliers.len() > FEW {
        return Vec::new();
    }
    let row = |one: &Outlier| {
        [
            Value::exact(one.index as f64 / rate_hz),
            Value::normal(one.size, one.size_sd),
        ]
    };
    outliers.iter().flat_map(row).collect()
}

/// Shocks, where none that is known lasts for longer than a sample: beside outliers it is one of them, the largest.
fn single_shocks(look: &Look<'_>) -> Option<Kind> {
    /// Samples that one may take: it may begin between two.
    const SINGLE: f64 = 2.0;
    let axis = look.axis;
    let mut shocks = axis.residual.shocks().peekable();
    shocks.peek()?;
    let is_single = |one: &Shock| one.duration_s * axis.rate_hz <= SINGLE;
    shocks.all(is_single).then_some(shock::KIND)
}

/// Samples of `whole`, to which those that were taken out of the axis are put `back`, that stand out of noise of this
/// `density`, whose strength over time is known.
fn sought(
    look: &Look<'_>,
    whole: &Transform,
    density: &[f64],
    powers: &Powers,
    back: &[Outlier],
) -> Found {
    let local = look.character.strength_moves.then(|| powers.local());
    let mut found = filter::outliers(whole, density, look.level(), filtered(look.axis), |n| {
        let local = local.as_ref().map_or(1.0, |local| MOVING * local(n));
        // Where the noise is weak by what is known of it, other noise may be there still.
        local * look.axis.envelope(n).max(1.0)
    });
    if !look.character.level_switches {
        // Where few were drawn none is seen there. Else what was drawn beside an outlier was drawn to be like it.
        let many = !few_are_drawn(look.axis);
        let is_filtered = filtered(look.axis);
        let usable = |n| is_filtered(n) || many && look.axis.is_beside_filled(n, 0);
        found = edges::with_edges(found, &with_outliers(look), usable, look.level());
        let means = Beginning::of(look.axis);
        found
            .outliers
            .retain(|one| means.is_beyond(one, look.level()));
    }
    if !found.outliers.is_empty() {
        found.outliers = jumps::without(look, found.outliers, back, density);
    }
    found
}

/// Samples on either side of one that was drawn that the filter leaves out, where few were drawn: a choice, as far as a
/// jump is misplaced. What was drawn is known as well as the law, which may be wrong far below the noise.
const NEAR: usize = 4;

/// Where one sample of so many was drawn, or one run of them, few were: hardly another has it for a neighbour. A choice.
const FEW: usize = 100;

/// Which samples the filter looks at: measured ones. Others are held against their neighbours, whatever the law.
fn filtered(axis: &AxisState) -> impl Fn(usize) -> bool {
    let near = |few: bool| if few { NEAR } else { 0 };
    let of_missing = near(few_are_drawn(axis));
    // What lies beyond a limit is drawn by itself, however many others are missing; of a walk it comes in long runs.
    let replaced = axis.residual.replaced();
    let runs = replaced.chunk_by(|one, next| one + 1 == *next).count();
    let of_replaced = near(FEW * runs <= axis.residual.len());
    move |n| {
        let from = replaced.partition_point(|place| place + of_replaced < n);
        let is_beside = replaced
            .get(from)
            .is_some_and(|place| *place <= n + of_replaced);
        axis.usable(n) && !axis.is_beside_filled(n, of_missing) && !is_beside
    }
}

/// Whether so few samples were drawn that hardly one has a neighbour that was.
fn few_are_drawn(axis: &AxisState) -> bool {
    FEW * axis.filled_samples() <= axis.residual.len()
}

/// What is left of the record, with its outliers. Where many samples were drawn these count as seen: hardly one has
/// neighbours enough that were measured.
fn with_outliers(look: &Look<'_>) -> Arc<Vec<f64>> {
    let residual = &look.axis.residual;
    let mut values = if few_are_drawn(look.axis) {
        residual.seen()
    } else {
        residual.values()
    };
    Beginning::of(look.axis).put_back(look.axis, &mut values);
    let known = look.axis.residual.outliers();
    if !known.is_empty() {
        let values = Arc::make_mut(&mut values);
        known.iter().for_each(|one| values[one.index] += one.size);
    }
    values
}
