//! Whether what is named is there once, with the right parameters: one step is one step, at its moment
//! and of its height.

use crate::hidden::case::Case;
use crate::hidden::judge::answer::{Axis, Finding, Interval};
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

/// What doubles of codes show.
const GRID: &str = "quantisation";

/// Deviations of its own interval that a parameter may be off: by chance in one of two million.
const DEVIATIONS: f64 = 5.0;

/// Share that it may be off whatever its interval says: at a thousand times the threshold that is a small
/// fraction of a decibel, but many deviations.
const SHARE: f64 = 0.01;

/// What an `unnamed` part may change at most where a name of the catalogue was hidden, percent of the
/// Allan deviation.
const UNNAMED_PERCENT: f64 = 1.0;

/// Names of what a chain does to a record that does not declare it: any one of them is right.
pub const OF_A_CHAIN: [&str; 3] = ["rolloff", "averaging", "converter"];

/// Takes one name for the chain off each axis of a record that does not declare it.
pub fn take_chain(left: &mut Vec<(usize, &Finding)>, case: &Case, axes: usize) {
    if case.scene.declared || case.scene.chain.is_none() {
        return;
    }
    for axis in 0..axes {
        let is_of_chain = |(at, one): &(usize, &Finding)| {
            *at == axis && OF_A_CHAIN.contains(&one.effect.as_str())
        };
        if let Some(place) = left.iter().position(is_of_chain) {
            left.remove(place);
        }
    }
}

/// Whether a finding says what is so of the numbers: doubles of codes lie on a grid that nothing declares.
pub fn is_of_the_form(finding: &Finding, case: &Case) -> bool {
    let step = finding.parameters.get("step").and_then(|one| one.value);
    let hidden = case.truths.iter().any(|truth| truth.effect == GRID);
    let is_so = |(step, code): (f64, f64)| (step / code - 1.0).abs() < SHARE;
    finding.effect == GRID && !hidden && step.zip(case.code()).is_some_and(is_so)
}

/// Whether the findings say of a truth what is so: as many rows, and each parameter that is said within
/// `DEVIATIONS` or `SHARE` of it.
pub fn is_held(truth: &Truth, found: &[(usize, &Finding)], scene: &Scene) -> bool {
    let [(_, finding)] = found else {
        // Axes that share noise say it of each.
        return !found.is_empty();
    };
    let rows = |name: &str| name.starts_with("time_s_") || name.starts_with("amplitude_");
    let hidden = truth.parameters.iter().filter(|(name, _)| rows(name));
    let said = finding.parameters.iter();
    let said = said.filter(|(name, one)| rows(name) && one.value.is_some_and(|value| value != 0.0));
    if hidden.count() != said.count() {
        return false;
    }
    truth.parameters.iter().all(|(name, value)| {
        let said = finding.parameters.get(name.as_str());
        said.is_none_or(|said| is_near(name, *value, said, scene))
    })
}

fn is_near(name: &str, truth: f64, said: &Interval, scene: &Scene) -> bool {
    let is_moment = name.starts_with("time_s_") || matches!(name, "from_s" | "to_s");
    // Of what lies ahead of an unknown chain only moments and frequencies are known.
    let is_known = scene.declared || is_moment || name == "f_hz";
    let Some(value) = said.value.filter(|_| is_known && name != "phase_rad") else {
        return true;
    };
    let deviation = match (said.lo, said.hi) {
        (Some(lo), Some(hi)) => (hi - lo) / 3.92,
        _ => 0.0,
    };
    let share = match is_moment {
        true => 2.0 / scene.rate_hz,
        false => SHARE * truth.abs(),
    };
    (value - truth).abs() <= share.max(DEVIATIONS * deviation)
}

/// Whether what has no name is small: null, or less than a percent of every averaging time.
pub fn is_small(axis: &Axis) -> bool {
    let unnamed = axis.unnamed.as_ref();
    let change = unnamed.and_then(|one| one.get("allan_change_percent")?.as_f64());
    change.is_none_or(|percent| percent.abs() <= UNNAMED_PERCENT)
}
