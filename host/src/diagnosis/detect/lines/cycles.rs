//! Cycles of the level that come a few times in the record, such as those of a thermostat: slow lines with what stands at their
//! multiples, one cause.

use super::mains::{self, Group, Near};
use super::measure::{self, Measured, measure_near};
use super::{found, slow};
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::look::Look;
use crate::diagnosis::result::value::Value;
use crate::model::{hum, sinusoid};
use crate::numeric::normal::TWO_SIDED_95;
use crate::spectrum::{Line, record_lines};

/// Cycles of the level, each with its multiples among the lines; and the other lines. What follows a temperature is no cycle
/// of its own.
pub fn cycles(look: &Look<'_>) -> (Vec<Group>, Vec<Line>) {
    /// Lines that are asked whether they are multiples, at most: a choice. Where there are more, they are of a tone that
    /// wanders.
    const MOST: usize = 64;
    /// Error of a frequency at least, 1/T: what wanders below a strong line moves it by more than its noise does.
    const SURE: f64 = 0.05;
    /// Probability that a line stands as near to a multiple of a slow one by chance: a choice. Of a few cycles no multiple is
    /// told better, and most slow lines have some.
    const BY_CHANCE: f64 = 0.2;
    let axis = look.axis;
    let near = Near {
        least_sd_hz: SURE / look.duration_s(),
        by_chance: BY_CHANCE,
    };
    let mut others = found(axis, look.level());
    if look.context.covariate.is_some() || others.len() > MOST {
        return (Vec::new(), others);
    }
    let found = slow_lines(look, near.least_sd_hz);
    let measured = |line: Line| {
        let slow = found.iter().find(|one| one.line == line);
        slow.cloned()
            .unwrap_or_else(|| measure::measure(axis, &line))
    };
    let mut all: Vec<Line> = found.iter().map(|one| one.line).collect();
    all.append(&mut others);
    let mut groups = Vec::new();
    for base in known_cycles(axis, near.least_sd_hz) {
        let (own, rest) = mains::multiples(&base.line, all, near, |line| *line, measured);
        all = rest;
        if !own.is_empty() {
            let base = std::iter::once((1, base));
            groups.push(mains::of_base(base.chain(own).collect()));
        }
    }
    // Of a few cycles all multiples are slow, or in the reach of the search by neighbours.
    for base in &found {
        if let Some(place) = all.iter().position(|line| *line == base.line) {
            all.remove(place);
            let (group, rest) = mains::machine(base.clone(), all, near, |line| *line, measured);
            all = rest;
            groups.push(group);
        }
    }
    (groups, all)
}

/// Slow lines that have a name, as they were taken out. That of a family is known by all of it.
fn known_cycles(axis: &AxisState, least_sd_hz: f64) -> Vec<Measured> {
    let duration_s = axis.filled.len() as f64 / axis.rate_hz;
    let slow = axis.explanations().iter().filter(|one| {
        let base = one.effect.values.first().copied().flatten();
        base.is_some_and(|base| base.value * duration_s < record_lines::LEAST_CYCLES)
    });
    let lines = slow.filter(|one| [sinusoid::KIND, hum::KIND].contains(&one.kind()));
    let known = lines.filter_map(|one| {
        let sd = |value: Value| {
            let hi = value.hi.unwrap_or(value.value);
            (hi - value.value) / TWO_SIDED_95
        };
        let base = one.effect.values[0]?;
        let size = one.effect.values.last().copied().flatten()?;
        Some(Measured {
            line: Line {
                frequency_hz: base.value,
                frequency_sd_hz: if one.kind() == hum::KIND {
                    sd(base)
                } else {
                    sd(base).max(least_sd_hz)
                },
                amplitude: size.value,
                ratio: f64::INFINITY,
                false_alarm: one.p_value,
            },
            wave: one.waves().first()?.clone(),
            amplitude_sd: sd(size),
        })
    });
    known.collect()
}

/// The slow lines of an axis, measured.
fn slow_lines(look: &Look<'_>, least_sd_hz: f64) -> Vec<Measured> {
    let slow = slow::lines(look.axis, look.level()).into_iter();
    let measured = slow.map(|one| {
        let mut measured = measure_near(look.axis, one.f_hz, one.p_value);
        let line = &mut measured.line;
        line.ratio = one.ratio;
        line.frequency_sd_hz = line.frequency_sd_hz.max(least_sd_hz);
        measured
    });
    measured.collect()
}
