//! What the level does far above all noise, read off the record before anything else: two settlings from the start, and what
//! comes again and again, as a thermostat's heater makes it.
//!
//! Noise that is fitted to such a record is that of a walk as strong as the course, in which its bends and kinks look like
//! shocks. So it is asked for first, as a whole, by least squares among means. It is believed only where next to nothing of it is left, and
//! where what is left has no room for a walk that could have gone the same way ([`is_plain`]).

mod cycle;
mod fit;
mod means;
mod proposals;
mod settlings;
#[cfg(test)]
mod tests;

use super::Detector;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::model::{hum, sinusoid, warmup};
use fit::{Course, Cycle, Fitted, Part};
use means::Means;

/// Share of its energy that a course may leave: a choice, a fifth of its size.
const LEFT: f64 = 0.04;

/// Means in which what is left is looked at, a time constant or a period: a choice. As many show a bend, and noise that single samples have
/// is small in them.
const RESOLVED: f64 = 16.0;

/// How many times more energy than the walk that may be left a course has, at least: a choice. Most of a walk is in its slowest part,
/// whose square is so much larger than usual once in some 10^7 records.
const OVER_WALK: f64 = 16.0;

/// How many times more energy than what is left each part of a course has, at least: a choice. Less is left to those that look for it in
/// fitted noise.
const OVER_LEFT: f64 = 1.0;

/// Means that a course is measured in, at least: a choice. A 32nd of them, in which its noise is told, is still some of them.
const FEWEST_MEANS: usize = 1 << 10;

/// Looks for a course that leaves nothing. Its test is that of the level.
pub static DETECTOR: Detector = Detector {
    tests: 0,
    look: |look| Ok(plain(look)),
};

fn plain(look: &Look<'_>) -> Vec<Proposal> {
    let kinds = [warmup::KIND, hum::KIND, sinusoid::KIND];
    let is_free = |kind| look.is_open(kind) && !look.axis.has(kind);
    // What follows a temperature is no course of its own.
    if look.context.covariate.is_some() || !kinds.into_iter().all(is_free) {
        return Vec::new();
    }
    let values = look.axis.residual.values();
    let means = Means::new(&values);
    let Some(found) = found(&means) else {
        return Vec::new();
    };
    let course = cycle::continued(&values, &means, found.course);
    // Noise that rises with the frequency is the smaller the fewer means there are.
    let most = (values.len() / FEWEST_MEANS).max(means.factor);
    let means = Means::over(&values, shown_by(&course).clamp(1, most));
    let again = Fitted::new(&means, course).map(|one| one.climbed(&means));
    again.map_or_else(Vec::new, |one| proposals::proposals(look, &means, &one))
}

/// Samples from mean to mean of those that still show a course.
fn shown_by(course: &Course) -> usize {
    let highest = course.cycle.map_or(0.0, Cycle::highest);
    let of_cycle = cycle::HIGHEST / highest;
    (course.quickest() / RESOLVED).min(of_cycle) as usize
}

/// The course of the fewest numbers that is plain, unless that is a single settling, which is
/// [looked for](super::warmup::plain) where it is quicker too.
fn found(means: &Means) -> Option<Fitted> {
    // A course leaves no less than noise, in as few means as show its slowest.
    let m = means.len() / (RESOLVED as usize * cycle::FEWEST);
    if LEFT * means.energy(&means.values, m)
        < means.white(&means.values, 1) * (means.len() / m) as f64
    {
        return None;
    }
    let [one, two] = settlings::best(means);
    let all = [one, two, cycle::best(means)];
    let plain = all.into_iter().flatten();
    let plain = plain.filter(|fitted| is_plain(means, fitted));
    let cost = |fitted: &Fitted| cycle::costs(fitted, means);
    let best = plain.min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
    (best.course.cycle.is_some() || best.course.settlings.len() > 1).then_some(best)
}

/// Whether a part of a course is plain.
fn is_plain(means: &Means, fitted: &Fitted) -> bool {
    let parts = fitted.course.parts();
    parts.iter().any(|part| is_plain_part(means, fitted, part))
}

/// Whether a part of a course, in means that resolve it, is far more than what is left, of which there is next to nothing, and than a walk
/// could make that what is left has room for.
fn is_plain_part(means: &Means, fitted: &Fitted, part: &Part) -> bool {
    let m = (part.samples / means.factor as f64 / RESOLVED) as usize;
    let left = means.energy(&fitted.left, m);
    let without = Fitted::new(means, part.without.clone());
    let own = without.map_or(0.0, |one| one.energy - fitted.energy);
    let walk = means.known() * means.walk(&fitted.left);
    left < LEFT * means.energy(&means.values, m) && own > (OVER_WALK * walk).max(OVER_LEFT * left)
}
