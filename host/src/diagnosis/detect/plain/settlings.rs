//! Settlings from the start, of the sensor and, slower, of the box around it.

use super::fit::{Course, Fitted};
use super::means::Means;
use crate::numeric::simplex::climbed;

/// Time constants tried an octave: from there on the top is climbed.
const PER_OCTAVE: f64 = 2.0;

/// Shortest time constant, means: below it is a few of them that show it.
const SHORTEST: f64 = 8.0;

/// Time constants that a record holds of each, at least: a choice, a tenth is left then. What goes on at its end did not settle.
const HELD: f64 = 2.3;

/// How many times as long the other's time constant is, at least: closer ones are one, with sizes that cancel. A choice.
const APART: f64 = 2.0;

/// Time constants that are tried, samples.
pub fn times(means: &Means) -> impl Iterator<Item = f64> + use<> {
    let [shortest, longest] = ends(means);
    let count = (PER_OCTAVE * (longest / shortest).log2()) as i32;
    (0..=count.max(0)).map(move |step| shortest * (f64::from(step) / PER_OCTAVE).exp2())
}

fn ends(means: &Means) -> [f64; 2] {
    let factor = means.factor as f64;
    [SHORTEST * factor, means.len() as f64 * factor / HELD]
}

/// Whether the record holds the settlings of a course, each by itself.
pub fn are_held(means: &Means, course: &Course) -> bool {
    let [shortest, longest] = ends(means);
    let mut all = course.settlings.iter();
    let apart = |two: &[f64]| (two[1] / two[0]).max(two[0] / two[1]) >= APART;
    all.all(|one| (shortest..=longest).contains(one)) && course.settlings.windows(2).all(apart)
}

/// The likeliest settling, and the likeliest two.
pub fn best(means: &Means) -> [Option<Fitted>; 2] {
    let of = |settlings: Vec<f64>| {
        let course = Course {
            settlings,
            cycle: None,
        };
        Fitted::new(means, course)
    };
    let nats = |fitted: Option<Fitted>| fitted.map_or(f64::NEG_INFINITY, |one| one.nats(means));
    let climbed_from = |start: Vec<f64>| {
        let logs: Vec<f64> = start.iter().map(|samples: &f64| samples.ln()).collect();
        let steps = vec![0.2; logs.len()];
        let at = |logs: &[f64]| logs.iter().map(|log| log.exp()).collect::<Vec<f64>>();
        let top = climbed(&logs, &steps, |logs| nats(of(at(logs))));
        of(at(&top)).filter(|one| are_held(means, &one.course))
    };
    let with_nats = |settlings: Vec<f64>| (nats(of(settlings.clone())), settlings);
    let larger = |a: &(f64, Vec<f64>), b: &(f64, Vec<f64>)| a.0.total_cmp(&b.0);
    let times: Vec<f64> = times(means).collect();
    let one = times
        .iter()
        .map(|time| with_nats(vec![*time]))
        .max_by(larger);
    let pairs = times.iter().enumerate().flat_map(|(number, slow)| {
        let quicker = times[..number].iter();
        let quicker = quicker.filter(move |quick| slow / *quick >= APART);
        quicker.map(move |quick| vec![*quick, *slow])
    });
    let two = pairs.map(with_nats).max_by(larger);
    [one, two].map(|start| climbed_from(start?.1))
}
