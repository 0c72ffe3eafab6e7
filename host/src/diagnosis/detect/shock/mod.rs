//! Shock and motion: what happened once, found before anything else, dated and kept out of the fits.
//!
//! `usual` knows what powers short `windows` have where nothing happens, `scan` finds what stands out, from short windows to
//! long ones and `across` what they found, `event` what it is, `fit` its course in noise that `prediction` and `about` whiten, `moved` what it is about
//! where it has no course that another would have.

mod about;
mod across;
mod alone;
mod bands;
mod course;
mod described;
mod ends;
mod energy;
mod even;
mod event;
mod fading;
mod fit;
mod happened;
mod loud;
mod moment;
mod moved;
mod quiet;
mod scan;
mod singles;
mod strength;
mod stretch;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trial;
mod usual;
mod windows;

pub use bands::NEXT as NEXT_GROUP;

use std::ops::Range;

use super::Detector;
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::telegraph::short_dwells::are_of_switching;
use crate::diagnosis::explanation::Candidate;
use crate::diagnosis::record::runs::without;
use crate::diagnosis::steady::lasting::Lasting;
use crate::model::{motion, shock};
use event::{Event, What};
use happened::{Happened, Known};
use quiet::Quiet;
use scan::Scan;
use stretch::{Stretch, joined};

/// Events of a record, at most: a choice. With more, they come all the time, and the noise is of another law.
const MOST_EVENTS: usize = 40;

/// Stretches that are looked at one by one, at most: a choice.
const MOST_STRETCHES: usize = 4000;

/// Part of the record that they may take: a choice. What takes more is no event.
const MOST_OF_RECORD: f64 = 0.15;

/// Part that as few as these may take: somebody who handles the sensor does so once. What is usual is a median, which
/// that still leaves to the rest. Choices.
const MOST_OF_FEW: f64 = 0.45;
const FEW: usize = 2;

/// Pauses within an event are shorter than its longest part by this factor, at least: a choice.
const PAUSE: usize = 4;

/// Of more shocks than this those are told that stand out no less than the plainest by this factor: choices. What
/// follows a knock of a thousand deviations all day long is not asked for.
const MANY: usize = 12;
const BESIDE: f64 = 10.0;

/// How many times as far as chance asks for an event must stand out, tried in turn: where it is once, others stand
/// out all the time. Threes are a choice.
const FURTHER: [f64; 3] = [1.0, 3.0, 9.0];

/// Steps of a grid within which most of a stretch goes to and fro between two of its values: where noise spans few of them, it
/// does so wherever its level lies between two. Half a step more than one, for what is taken out of the record, and the
/// share at either end that is not looked at: of noise that spans a third of a step, as many lie beyond. Choices.
const TO_AND_FRO: f64 = 1.5;
const BEYOND: f64 = 0.01;

/// Looks for transients, once.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let kinds = [shock::KIND, motion::KIND];
    if kinds.iter().any(|kind| look.axis.has(*kind)) {
        return Ok(Vec::new());
    }
    let values = look.axis.residual.seen();
    let scan = Scan::new(&values, &look.axis.filled);
    let found = scan.map_or_else(Vec::new, |scan| found(scan, look));
    let found = found
        .into_iter()
        .filter(|one| look.is_open(one.effect.kind))
        .filter(|one| !are_of_switching(look.axis, one));
    Ok(found.map(|one| Proposal::Explain(Box::new(one))).collect())
}

/// What happened in a record: at the level of one test, or, where something stands out all the time, what stands out of
/// that.
fn found(mut scan: Scan<'_>, look: &Look<'_>) -> Vec<Candidate> {
    let stretches = scan.stretches(look.level(), look.axis.rate_hz);
    // What pauses for a small part of what it lasts is one event.
    let pause = |a: &Stretch, b: &Stretch| {
        let shorter = a.samples.len().min(b.samples.len());
        shorter.max(a.longest.max(b.longest) / PAUSE)
    };
    let mut stretches = joined(stretches, pause);
    if let Some(coarse) = look.context.values.coarse.filter(|coarse| coarse.decides) {
        stretches.retain(|one| leaves_two_codes(&scan, &one.samples, coarse.step));
    }
    let all = FURTHER.iter().find_map(|times| {
        let least = times * scan.threshold();
        let plain: Vec<Stretch> = stretches
            .iter()
            .filter(|one| one.together() >= least)
            .cloned()
            .collect();
        events(&scan, &plain, look.level())
    });
    happened::candidates(look, &scan, all.unwrap_or_default())
}

/// Whether more than a few of some samples lie beyond two neighbouring values of a grid with this `step`.
fn leaves_two_codes(scan: &Scan<'_>, samples: &Range<usize>, step: f64) -> bool {
    scan.span(samples, BEYOND) > TO_AND_FRO * step
}

/// What happened in some stretches; `None` where they are no events.
fn events(scan: &Scan<'_>, stretches: &[Stretch], level: f64) -> Option<Vec<Happened>> {
    if stretches.len() > MOST_STRETCHES {
        return None;
    }
    let holes: Vec<Range<usize>> = stretches.iter().map(|one| one.samples.clone()).collect();
    let quiet = Quiet {
        runs: without(scan.runs(), &holes),
        whole: without(scan.whole_runs(), &holes),
    };
    // A louder stretch may show in parts.
    let reach = |a: &Stretch, b: &Stretch| 2 * a.window.max(b.window).max(a.longest).max(b.longest);
    let wider = joined(stretches.to_vec(), reach)
        .into_iter()
        .filter(|wide| {
            let parts = stretches
                .iter()
                .filter(|one| wide.samples.contains(&one.samples.start));
            let nats: f64 = parts.clone().map(|one| 0.5 * one.z * one.z).sum();
            let event = Event::new(scan, wide, &quiet);
            parts.count() > 1 && event.is_even(nats) && !event.are_single_samples()
        });
    let louder: Vec<Stretch> = wider.collect();
    let lasting = Lasting::of(scan.seen(), &quiet.whole, scan.faint());
    let is_foretold = |stretch: &Stretch| {
        let foretells = |law: &Lasting| law.foretells(scan.seen(), &stretch.samples, level);
        lasting.as_ref().is_some_and(foretells)
    };
    let mut events: Vec<Happened> = Vec::new();
    for wide in louder.iter().filter(|wide| !is_foretold(wide)) {
        if let What::Louder(burst) = Event::new(scan, wide, &quiet).louder() {
            events.push(Happened::new(wide, Known::Louder(burst)));
        }
    }
    let is_in_louder = |stretch: &Stretch| {
        let mut louder = louder.iter();
        louder.any(|wide| wide.samples.contains(&stretch.samples.start))
    };
    let (mut jumps, mut singles): (Vec<f64>, Vec<f64>) = Default::default();
    for stretch in stretches {
        if is_in_louder(stretch) || is_foretold(stretch) {
            continue;
        }
        match Event::new(scan, stretch, &quiet).what() {
            What::Shock(course) => events.push(Happened::new(stretch, Known::Shock(course))),
            What::Motion(moved) => events.push(Happened::new(stretch, Known::Motion(moved))),
            What::Louder(burst) => events.push(Happened::new(stretch, Known::Louder(burst))),
            What::Jump => jumps.push(stretch.z),
            What::Singles => singles.push(stretch.z),
            What::Other => {}
        }
        if events.len() > MOST_EVENTS {
            return None;
        }
    }
    without_some_of(&mut events, &jumps, Happened::is_bump);
    without_some_of(&mut events, &singles, Happened::is_short);
    let mut events = without_echoes(events);
    let taken: usize = events.iter().map(|one| one.samples().len()).sum();
    let most = if events.len() <= FEW {
        MOST_OF_FEW
    } else {
        MOST_OF_RECORD
    };
    if taken as f64 > most * scan.values().len() as f64 {
        return None;
    }
    let plainest = events.iter().map(|one| one.z).fold(0.0, f64::max);
    if events.len() > MANY {
        events.retain(|one| one.z >= plainest / BESIDE);
    }
    Some(events)
}

/// Takes what begins while another event lasts for a part of it: the plainer of them, until both are over.
fn without_echoes(mut events: Vec<Happened>) -> Vec<Happened> {
    events.sort_by_key(|one| one.samples().start);
    let mut all: Vec<Happened> = Vec::new();
    for mut next in events {
        while let Some(last) = all.pop_if(|last| next.samples().start < last.samples().end) {
            let from = last.samples().start.min(next.samples().start);
            let to = last.samples().end.max(next.samples().end);
            if last.z >= next.z {
                next = last;
            }
            next.last(from..to);
        }
        all.push(next);
    }
    all
}

/// Leaves out what `could_be` one of some others that stand out as far as `heights` say, where these come far more often:
/// a bump is a jump up and one back, a short shock some samples that came together.
fn without_some_of(events: &mut Vec<Happened>, heights: &[f64], could_be: fn(&Happened) -> bool) {
    /// Others for each, at least, and how far it stands out beyond the plainest of them, at most: choices.
    const OFTEN: usize = 4;
    const BEYOND: f64 = 2.0;
    let count = events.iter().filter(|one| could_be(one)).count();
    if heights.len() >= OFTEN * count {
        let plainest = heights.iter().copied().fold(0.0, f64::max);
        events.retain(|one| !could_be(one) || one.z > BEYOND * plainest);
    }
}
