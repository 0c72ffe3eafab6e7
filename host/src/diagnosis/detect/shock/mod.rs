//! Shock: short transients, found before anything else, dated and kept out of the fits.
//!
//! `usual` knows what powers short `windows` have where nothing happens, `scan` finds what stands out, from short windows to
//! long ones, `event` what it is, `fit` its course in noise that `prediction` and `about` whiten.

mod about;
mod course;
mod event;
mod fit;
mod prediction;
mod runs;
mod scan;
mod simplex;
mod tails;
#[cfg(test)]
mod tests;
mod usual;
mod windows;

use std::ops::Range;

use super::Detector;
use crate::diagnosis::axis::{NoFit, SPREAD};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::shock::{KIND, Shock};
use course::Course;
use event::{Event, What};
use runs::without;
use scan::{Scan, Stretch, joined};

/// Shocks of a record, at most: a choice. With more, they come all the time, and the noise is of another law.
const MOST_SHOCKS: usize = 40;

/// Stretches that are looked at one by one, at most: a choice.
const MOST_STRETCHES: usize = 4000;

/// Part of the record that they may take: a choice. What takes more is no event.
const MOST_OF_RECORD: f64 = 0.15;

/// Pauses within an event are shorter than its longest part by this factor, at least: a choice.
const PAUSE: usize = 4;

/// Of more shocks than this those are told that stand out no less than the plainest by this factor: choices. What
/// follows a knock of a thousand deviations all day long is not asked for.
const MANY: usize = 12;
const BESIDE: f64 = 10.0;

/// How many times as far as chance asks for an event must stand out, tried in turn: where it is once, others stand
/// out all the time. Threes are a choice.
const FURTHER: [f64; 3] = [1.0, 3.0, 9.0];

/// Looks for transients, once.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    if !look.is_open(KIND) || look.axis.has(KIND) {
        return Ok(Vec::new());
    }
    let values = look.axis.residual.values();
    let scan = Scan::new(&values, &look.axis.filled);
    let found = scan.and_then(|scan| found(scan, look));
    Ok(found
        .into_iter()
        .map(|one| Proposal::Explain(Box::new(one)))
        .collect())
}

/// Shocks of a record: at the level of one test, or, where something stands out all the time, what stands out of
/// that.
fn found(mut scan: Scan<'_>, look: &Look<'_>) -> Option<Candidate> {
    let stretches = scan.stretches(look.level(), look.axis.rate_hz);
    // What pauses for a small part of what it lasts is one event.
    let pause = |a: &Stretch, b: &Stretch| {
        let shorter = a.samples.len().min(b.samples.len());
        shorter.max(a.longest.max(b.longest) / PAUSE)
    };
    let stretches = joined(stretches, pause);
    let shocks = FURTHER.iter().find_map(|times| {
        let least = times * scan.threshold();
        let plain: Vec<Stretch> = stretches
            .iter()
            .filter(|one| one.z >= least)
            .cloned()
            .collect();
        shocks(&scan, &plain)
    })?;
    let plainest = shocks.iter().map(|(z, _)| *z).fold(0.0, f64::max);
    let p_value = scan.p_value(plainest);
    let shocks: Vec<Course> = shocks.into_iter().map(|(_, one)| one).collect();
    (!shocks.is_empty()).then(|| candidate(look, &shocks, p_value))
}

/// The shocks among some stretches, with how far they stand out; `None` where they are no events.
fn shocks(scan: &Scan<'_>, stretches: &[Stretch]) -> Option<Vec<(f64, Course)>> {
    if stretches.len() > MOST_STRETCHES {
        return None;
    }
    let holes: Vec<Range<usize>> = stretches.iter().map(|one| one.samples.clone()).collect();
    let quiet = without(scan.runs(), &holes);
    // A louder stretch may show in parts.
    let reach = |a: &Stretch, b: &Stretch| 2 * a.window.max(b.window).max(a.longest).max(b.longest);
    let wider = joined(stretches.to_vec(), reach)
        .into_iter()
        .filter(|wide| {
            let parts = stretches
                .iter()
                .filter(|one| wide.samples.contains(&one.samples.start));
            let nats: f64 = parts.clone().map(|one| 0.5 * one.z * one.z).sum();
            parts.count() > 1 && Event::new(scan, wide, &quiet).is_even(nats)
        });
    let louder: Vec<Stretch> = wider.collect();
    let mut shocks: Vec<(f64, Course)> = Vec::new();
    let mut jumps: Vec<f64> = Vec::new();
    for stretch in stretches {
        if louder
            .iter()
            .any(|wide| wide.samples.contains(&stretch.samples.start))
        {
            continue;
        }
        match Event::new(scan, stretch, &quiet).what() {
            What::Shock(shock) => shocks.push((stretch.z, shock)),
            What::Jump => jumps.push(stretch.z),
            What::Other => {}
        }
        if shocks.len() > MOST_SHOCKS {
            return None;
        }
    }
    without_two_jumps(&mut shocks, &jumps);
    let mut shocks = without_echoes(shocks);
    let taken: usize = shocks.iter().map(|(_, one)| one.samples.len()).sum();
    if taken as f64 > MOST_OF_RECORD * scan.values().len() as f64 {
        return None;
    }
    let plainest = shocks.iter().map(|(z, _)| *z).fold(0.0, f64::max);
    if shocks.len() > MANY {
        shocks.retain(|(z, _)| *z >= plainest / BESIDE);
    }
    Some(shocks)
}

/// Takes what begins while another shock lasts for a part of it: the plainer of them, until both are over.
fn without_echoes(mut shocks: Vec<(f64, Course)>) -> Vec<(f64, Course)> {
    shocks.sort_by_key(|(_, one)| one.samples.start);
    let mut all: Vec<(f64, Course)> = Vec::new();
    for mut next in shocks {
        while let Some(last) = all.pop_if(|(_, last)| next.1.samples.start < last.samples.end) {
            let from = last.1.samples.start.min(next.1.samples.start);
            let to = last.1.samples.end.max(next.1.samples.end);
            if last.0 >= next.0 {
                next = last;
            }
            let course = &mut next.1;
            course.samples = from..to;
            if course.shock.f_hz > 0.0 {
                let lasts = to as f64 - course.shock.time_s;
                course.shock.duration_s = lasts.max(course.shock.duration_s);
            }
        }
        all.push(next);
    }
    all
}

/// Leaves out bumps where the level jumps far more often than it bulges: there a bump is a jump up and one back.
fn without_two_jumps(shocks: &mut Vec<(f64, Course)>, jumps: &[f64]) {
    /// Jumps a bump, at least, and how far a bump stands out beyond the plainest of them, at most: choices.
    const OFTEN: usize = 4;
    const BEYOND: f64 = 2.0;
    let is_bump = |shock: &(f64, Course)| shock.1.shock.f_hz == 0.0;
    let bumps = shocks.iter().filter(|shock| is_bump(shock)).count();
    if jumps.len() >= OFTEN * bumps {
        let plainest = jumps.iter().copied().fold(0.0, f64::max);
        shocks.retain(|shock| !is_bump(shock) || shock.0 > BEYOND * plainest);
    }
}

fn candidate(look: &Look<'_>, shocks: &[Course], p_value: f64) -> Candidate {
    let axis = look.axis;
    let rate_hz = axis.rate_hz;
    let values = shocks
        .iter()
        .flat_map(|one| row(one, axis.rate_hz, |f_hz| passed(look, f_hz)));
    let effect = Estimate {
        kind: KIND,
        values: values.collect(),
    };
    let spread = if axis.is_filtered() { SPREAD } else { 0 };
    let last = axis.residual.len();
    let masked = shocks
        .iter()
        .map(|one| one.samples.start.saturating_sub(spread)..(one.samples.end + spread).min(last));
    let waves = vec![Wave::Shocks {
        shocks: shocks
            .iter()
            .map(|one| in_seconds(&one.shock, rate_hz))
            .collect(),
        rate_hz,
    }];
    let change = Change::Happened {
        masked: masked.collect(),
        waves,
    };
    let freedom = effect.values.iter().flatten().count() as f64;
    Candidate {
        held_out_nats: Some(shocks.iter().map(|one| one.nats).sum()),
        ..Candidate::new(effect, p_value, freedom, change)
    }
}

/// Amplitude that the chain lets through.
fn passed(look: &Look<'_>, f_hz: f64) -> f64 {
    /// What is let through of a shock that is seen, at least: a choice.
    const LEAST: f64 = 0.1;
    look.axis.bins.chain_power(f_hz).sqrt().max(LEAST)
}

fn in_seconds(shock: &Shock, rate_hz: f64) -> Shock {
    Shock {
        time_s: shock.time_s / rate_hz,
        peak: shock.peak,
        duration_s: shock.duration_s / rate_hz,
        f_hz: shock.f_hz * rate_hz,
        decay_s: shock.decay_s / rate_hz,
    }
}

/// The parameters of one shock, ahead of the chain; `None` for what it has not.
fn row(course: &Course, rate_hz: f64, passed: impl Fn(f64) -> f64) -> [Option<Value>; 5] {
    let shock = in_seconds(&course.shock, rate_hz);
    let gain = if shock.f_hz > 0.0 {
        passed(shock.f_hz).recip()
    } else {
        1.0
    };
    let plain = |value: f64, sd: Option<f64>| sd.map_or(told(value), |sd| Value::normal(value, sd));
    let relative =
        |value: f64, sd: Option<f64>| sd.map_or(told(value), |sd| Value::log_normal(value, sd));
    let [time, peak, duration, frequency, decay] = course.sd;
    let is_there = |value: f64| value > 0.0;
    [
        Some(plain(shock.time_s, time.map(|sd| sd / rate_hz))),
        Some(plain(gain * shock.peak, peak.map(|sd| gain * sd))),
        Some(relative(shock.duration_s, duration)),
        Some(relative(shock.f_hz, frequency)).filter(|_| is_there(shock.f_hz)),
        Some(relative(shock.decay_s, decay)).filter(|_| is_there(shock.decay_s)),
    ]
}

/// A number without an interval.
const fn told(value: f64) -> Value {
    Value {
        value,
        lo: None,
        hi: None,
    }
}
