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
use crate::numeric::product::dot;
use fit::{Course, Cycle, Fitted};
use means::Means;

/// Share of its energy that a course may leave: a choice, a fifth of its size.
const LEFT: f64 = 0.04;

/// Means in which what is left is looked at, a time constant and a period: a choice. As many show a bend, and noise that single samples have
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
    // Noise that rises with the frequency is the smaller the fewer means there are.
    let most = (values.len() / FEWEST_MEANS).max(means.factor);
    let factor = shown_by(&found.course).clamp(means.factor, most);
    let coarser = Means::over(&values, factor);
    let again = Fitted::new(&coarser, found.course).map(|one| one.climbed(&coarser));
    again.map_or_else(Vec::new, |one| proposals::proposals(look, &coarser, &one))
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

/// Energy that a course leaves, in means that resolve it.
fn left(means: &Means, fitted: &Fitted) -> f64 {
    let quickest = fitted.course.quickest() / means.factor as f64;
    means.energy(&fitted.left, (quickest / RESOLVED) as usize)
}

/// Whether next to nothing of the means is left beside a course, and a part of it is plain.
fn is_plain(means: &Means, fitted: &Fitted) -> bool {
    let mut parts = fitted.course.parts().into_iter();
    left(means, fitted) < LEFT * dot(&means.values, &means.values)
        && parts.any(|without| is_plain_part(means, fitted, without))
}

/// Whether what a course has more than that `without` a part of it is far more than what is left, and than a walk could make that what is
/// left has room for.
fn is_plain_part(means: &Means, fitted: &Fitted, without: Course) -> bool {
    let without = Fitted::new(means, without);
    let own = without.map_or(0.0, |one| one.energy - fitted.energy);
    let walk = means.known() * means.walk(&fitted.left);
    own > (OVER_WALK * walk).max(OVER_LEFT * left(means, fitted))
}
