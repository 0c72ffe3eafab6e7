//! Is the clock of a record right? By what other clocks counted ([`counted()`]), and by the lines of another record
//! of the same sensor, as follows.
//!
//! All axes have one clock, so their lines count together. A line that keeps its frequency to one
//! cycle in the record is as sure as its height over the noise makes it; one that wanders, or a
//! band of noise, is a [`Band`] and as sure as it stays in its place.

mod bands;
mod counted;
mod mark;
mod matching;
mod ratio;
mod sources;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::lines::{self, Group};
use crate::diagnosis::detect::timebase::bands::Band;
use crate::diagnosis::detect::timebase::mark::Mark;
use crate::diagnosis::detect::timebase::ratio::Rate;
use crate::diagnosis::record::samples::Samples;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::{Finding, Rival};
use crate::diagnosis::result::value::Value;
use crate::diagnosis::steady::line;
use crate::model::sinusoid;
use crate::model::timebase::KIND;
use crate::spectrum::Line;

pub use self::counted::counted;

/// Tests that it makes: its share of the family's level.
pub const TESTS: u32 = 1;

/// Share of a band's power that a line within it must hold to stand for it: most of it.
const HOLDS: f64 = 0.5;

/// The finding that `samples` were taken at another rate than they say, compared with `reference`, at a
/// family-wise `level`: for each axis whose lines say so.
pub fn clock(samples: &Samples, reference: &Samples, level: f64) -> Vec<(usize, Finding)> {
    let count = samples.axes.len();
    let of = |samples: &Samples| -> Vec<Vec<Mark>> {
        (0..count)
            .map(|number| marks_of(samples, number, level).unwrap_or_default())
            .collect()
    };
    let (here, there) = (of(samples), of(reference));
    let Some(rate) = ratio::ratio(&merged(&here), &merged(&there), level) else {
        return Vec::new();
    };
    let finding = finding(&rate);
    (0..count)
        .filter(|&axis| ratio::agree(&here[axis], &there[axis], &rate))
        .map(|axis| (axis, finding.clone()))
        .collect()
}

fn finding(rate: &Rate) -> Finding {
    let ratio = Value::normal(rate.ratio, rate.ratio_sd);
    let mut finding = Finding::new(&Estimate::new(KIND, [ratio]), rate.p_value);
    if rate.sources < 2 {
        // Both say exactly the same about every line.
        finding.rivals.push(Rival {
            effect: sinusoid::KIND,
            log_odds: 0.0,
        });
        finding.check.push_str(
            "; all lines that moved may come from one machine, which then itself turned slower by \
             as much: only a line of another source, or that clock, can tell",
        );
    }
    finding
}

/// The marks of all axes: what stands at the same place in several is one, by the surest.
fn merged(axes: &[Vec<Mark>]) -> Vec<Mark> {
    let mut all: Vec<Mark> = axes.iter().flatten().copied().collect();
    all.sort_by(|a, b| a.f_sd_hz.total_cmp(&b.f_sd_hz));
    let mut kept: Vec<Mark> = Vec::new();
    for mark in all {
        if !kept.iter().any(|other| other.is(&mark)) {
            kept.push(mark);
        }
    }
    kept
}

/// What can be recognised in the spectrum of an axis by its place.
fn marks_of(samples: &Samples, number: usize, level: f64) -> Option<Vec<Mark>> {
    let signal = samples.signal.axes.get(number)?;
    let (measured, _) = samples.axes.get(number)?.clone().centred(signal.scale);
    let axis = AxisState::new(
        Arc::new(measured),
        samples.signal.rate_hz,
        signal.chain.as_ref(),
    )?;
    let bands = bands::bands(&axis.filled, axis.rate_hz);
    let found: Vec<Line> = lines::lines(&axis, level)
        .into_iter()
        .flat_map(|group| match group {
            Group::Single(one) => vec![one.line],
            Group::Hum { lines, .. } => lines.into_iter().map(|(_, one)| one.line).collect(),
            Group::Cluster { lines, .. } => lines,
        })
        .collect();
    let steady: Vec<Line> = found
        .into_iter()
        .filter(|line| {
            let holds = |band: &Band| 0.5 * line.amplitude.powi(2) > HOLDS * band.power;
            let within = bands.iter().find(|band| inside(band, line));
            within.is_none_or(holds)
                && line::p_steady(&axis, line.frequency_hz / axis.rate_hz) >= level
        })
        .collect();
    let wandering = bands
        .iter()
        .filter(|band| !steady.iter().any(|line| inside(band, line)))
        .map(|band| Mark {
            f_hz: band.f_hz,
            f_sd_hz: band.f_sd_hz,
            wanders: true,
        });
    let lines = steady.iter().map(|line| Mark {
        f_hz: line.frequency_hz,
        f_sd_hz: line.frequency_sd_hz,
        wanders: false,
    });
    Some(lines.chain(wandering).collect())
}

fn inside(band: &Band, line: &Line) -> bool {
    (band.ends_hz[0]..=band.ends_hz[1]).contains(&line.frequency_hz)
}
