//! A diagnosis as text for the terminal.

use std::fmt::Write;

use super::super::text::head;
use super::numbers::{Numbers, Rows};
use super::rivals::rival;
use super::summary::summary;
use super::suspects::suspicion;
use crate::diagnosis::result::finding::{AxisDiagnosis, Diagnosis, Finding, Remark, SMALL_PERCENT};
use crate::diagnosis::result::value::Value;
use crate::model::Coefficient;
use crate::model::effect::Parameter;
use crate::numeric::written::{estimated, probability, significant};

/// Findings that are all printed in full; of more, the small ones in a line each.
pub(super) const MOST_TOLD: usize = 3;

/// Numbers of a small finding that are listed, at most; JSON has all.
const MOST_PARAMETERS: usize = 12;

/// Values in a line of a column that stands by itself: with four digits a line has less than 80 letters.
const IN_A_LINE: usize = 6;

/// The whole text, with a newline at the end.
pub fn render(diagnosis: &Diagnosis) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = head(&mut text, &diagnosis.source).and_then(|()| {
        diagnosis
            .axes
            .iter()
            .try_for_each(|one| axis(&mut text, one, diagnosis.family_level))
    });
    text
}

fn axis(text: &mut String, axis: &AxisDiagnosis, level: f64) -> std::fmt::Result {
    writeln!(text, "\nAxis {}", axis.name)?;
    if let Some(refused) = &axis.refused {
        return writeln!(text, "  Not diagnosed: {refused}.");
    }
    for sentence in summary(axis) {
        writeln!(text, "  {sentence}")?;
    }
    if axis.findings.is_empty() && axis.unexplained.is_empty() && axis.unnamed.is_none() {
        writeln!(
            text,
            "  Nothing beyond the five terms (any finding in clean data: {} %).",
            significant(100.0 * level, 2)
        )?;
    }
    let numbered = (1_u32..).zip(&axis.findings);
    let (small, plain): (Vec<_>, Vec<_>) =
        numbered.partition(|(_, one)| axis.findings.len() > MOST_TOLD && one.is_small());
    for (number, one) in plain {
        finding(text, number, one)?;
    }
    if !small.is_empty() {
        writeln!(
            text,
            "  There, but small: each changes the model's Allan deviation by less than {} %.",
            significant(SMALL_PERCENT, 2)
        )?;
        for (number, one) in small {
            brief(text, number, one)?;
        }
    }
    for one in &axis.unexplained {
        remark(text, one)?;
    }
    for one in &axis.suspicions {
        writeln!(text, "  Suspected, not found: {}", one.effect)?;
        for sentence in suspicion(one, axis.unit) {
            writeln!(text, "     {sentence}")?;
        }
    }
    coefficients(text, axis)?;
    errors(text, axis)
}

fn finding(text: &mut String, number: u32, finding: &Finding) -> std::fmt::Result {
    writeln!(text, "  {number}. {}: {}", finding.name(), finding.cause)?;
    let numbers = Numbers::of(&finding.estimate);
    for (parameter, value) in &numbers.alone {
        writeln!(text, "       {:<14} {}", parameter.name, interval(value))?;
    }
    if let Some(rows) = &numbers.rows {
        table(text, rows)?;
    }
    write!(text, "     by chance: {}", probability(finding.p_value))?;
    if let Some(nats) = finding.gain.heldout_nats {
        write!(
            text,
            "; gain on held-out data: {} nats",
            significant(nats, 3)
        )?;
    }
    if let Some(size) = finding.gain.allan_change_percent {
        write!(
            text,
            "; changes the Allan deviation by {} % at most",
            significant(size, 2)
        )?;
    }
    writeln!(text)?;
    for one in &finding.rivals {
        writeln!(text, "     {}", rival(one))?;
    }
    writeln!(text, "     check: {}", finding.check)
}

/// What happened several times, a row each; a column that stands by itself goes on from line to line.
fn table(text: &mut String, rows: &Rows) -> std::fmt::Result {
    let [column] = &rows.columns[..] else {
        let heads = rows.columns.iter().map(Parameter::stem);
        line(text, heads)?;
        for row in &rows.values {
            let cells: Vec<String> = row.iter().map(|one| cell(one.as_ref(), 6)).collect();
            line(text, cells.iter().map(String::as_str))?;
        }
        return more(text, rows);
    };
    let all: Vec<String> = rows
        .values
        .iter()
        .map(|row| cell(row[0].as_ref(), 4))
        .collect();
    let mut head = format!("{}_1 \u{2026}", column.stem());
    for values in all.chunks(IN_A_LINE) {
        writeln!(text, "       {head:<14} {}", values.join("  "))?;
        head.clear();
    }
    more(text, rows)
}

fn line<'a>(text: &mut String, mut cells: impl Iterator<Item = &'a str>) -> std::fmt::Result {
    write!(text, "      ")?;
    cells.try_for_each(|one| write!(text, " {one:>11}"))?;
    writeln!(text)
}

fn cell(value: Option<&Value>, digits: usize) -> String {
    value.map_or("-".into(), |one| significant(one.value, digits))
}

fn more(text: &mut String, rows: &Rows) -> std::fmt::Result {
    match rows.more {
        0 => Ok(()),
        more => writeln!(text, "       and {more} more, in the JSON"),
    }
}

/// In one line.
fn brief(text: &mut String, number: u32, finding: &Finding) -> std::fmt::Result {
    let known = finding.estimate.known().take(MOST_PARAMETERS);
    let values: Vec<String> = known
        .map(|(parameter, value)| format!("{} {}", parameter.name, significant(value.value, 4)))
        .collect();
    let colon = if values.is_empty() { "" } else { ": " };
    let size = finding.gain.allan_change_percent;
    writeln!(
        text,
        "  {number}. {}{colon}{} ({} %)",
        finding.name(),
        values.join(", "),
        size.map_or("0".into(), |size| significant(size, 2))
    )
}

fn remark(text: &mut String, remark: &Remark) -> std::fmt::Result {
    writeln!(
        text,
        "  Unexplained ({}, {}): {}; by chance: {}",
        remark.test,
        remark.place,
        remark.description,
        probability(remark.p_value)
    )
}

fn coefficients(text: &mut String, axis: &AxisDiagnosis) -> std::fmt::Result {
    writeln!(
        text,
        "       {:<28} {:>10}   with the findings, 95 %",
        "", "five terms"
    )?;
    for letter in Coefficient::ALL {
        let before = *axis.base.model.coefficients.get(letter);
        let after = axis.last.coefficients.get(letter);
        let now = match (after.value, after.lo, after.hi) {
            (Some(value), Some(lo), Some(hi)) => format!(
                "{} ({} to {})",
                significant(value, 4),
                significant(lo, 4),
                significant(hi, 4)
            ),
            _ => after.upper.map_or_else(
                || "not resolved next to what was taken out of the level".to_owned(),
                |upper| format!("not resolved from zero, below {}", significant(upper, 3)),
            ),
        };
        writeln!(
            text,
            "     {} {:<20} {:<13} {:>4}   {now}",
            letter.symbol(),
            letter.name(),
            letter.unit(axis.unit),
            if before > 0.0 {
                significant(before, 4)
            } else {
                "0".into()
            },
        )?;
    }
    Ok(())
}

fn errors(text: &mut String, axis: &AxisDiagnosis) -> std::fmt::Result {
    if let (Some(before), Some(after), Some(sampling)) = (
        axis.base.allan_error_percent,
        axis.last.allan_error_percent,
        axis.last.allan_error_sampling_percent,
    ) {
        writeln!(
            text,
            "     Allan deviation of the model on held-out data: off by {} %, with the findings {} % \
             (sampling alone: {} %)",
            significant(before, 2),
            significant(after, 2),
            significant(sampling, 2)
        )?;
    }
    Ok(())
}

fn interval(value: &Value) -> String {
    match (value.lo, value.hi) {
        (Some(lo), Some(hi)) if lo == hi => significant(value.value, 6),
        (Some(lo), Some(hi)) => {
            let [value, lo, hi] = estimated(value.value, lo, hi);
            format!("{value} ({lo} to {hi})")
        }
        _ => significant(value.value, 6),
    }
}
