//! A finding as a card: what it is, how sure, what it changes, what to check.

use std::fmt::{Result, Write};

use super::super::svg::{escape, typeset};
use super::numbers::{Numbers, Rows};
use super::rivals::way;
use crate::diagnosis::result::finding::{AxisDiagnosis, Finding, Remark};
use crate::diagnosis::result::value::Value;
use crate::model::effect::Parameter;
use crate::model::{Coefficient, PerCoefficient};
use crate::numeric::written::{estimated, probability, significant};

/// Rivals that are named at most.
const MOST_RIVALS: usize = 3;

/// The finding with this index of an axis.
pub fn finding(page: &mut String, axis: &AxisDiagnosis, index: usize) -> Result {
    let one = &axis.findings[index];
    write!(
        page,
        "<article class=\"card\"><h3><span class=\"number\">{}</span> {}</h3><p>{}</p>",
        index + 1,
        escape(&one.name()),
        escape(&one.cause)
    )?;
    parameters(page, axis, one)?;
    evidence(page, one)?;
    if Coefficient::ALL
        .iter()
        .any(|&letter| one.without.get(letter).is_some())
    {
        coefficients(page, axis, one, &with(axis, index))?;
    }
    write!(
        page,
        "<p class=\"check\"><b>On the bench:</b> {}</p></article>",
        escape(&one.check)
    )
}

/// What is left unexplained.
pub fn remark(page: &mut String, one: &Remark) -> Result {
    write!(
        page,
        "<article class=\"card unexplained\"><h3>unexplained: {}</h3><p>{}: {}</p>\
         <dl><div><dt>by chance</dt><dd>{}</dd></div></dl></article>",
        escape(&one.test),
        escape(&one.place.to_string()),
        escape(&one.description),
        probability(one.p_value)
    )
}

/// Coefficients with the finding: those that the next one was found with, else the final ones.
fn with(axis: &AxisDiagnosis, index: usize) -> PerCoefficient<Option<f64>> {
    let has_any = |one: &&Finding| {
        Coefficient::ALL
            .iter()
            .any(|&letter| one.without.get(letter).is_some())
    };
    let next = axis.findings[index + 1..].iter().find(has_any);
    next.map_or_else(
        || PerCoefficient::from_fn(|letter| axis.last.coefficients.get(letter).value),
        |next| next.without,
    )
}

fn parameters(page: &mut String, axis: &AxisDiagnosis, one: &Finding) -> Result {
    let numbers = Numbers::of(&one.estimate);
    if !numbers.alone.is_empty() {
        alone(page, axis, &numbers.alone)?;
    }
    numbers.rows.map_or(Ok(()), |rows| table(page, axis, &rows))
}

/// What stands for itself, a number a line, with its interval.
fn alone(page: &mut String, axis: &AxisDiagnosis, numbers: &[(Parameter, Value)]) -> Result {
    write!(
        page,
        "<div class=\"scroll\"><table><tr><th>parameter</th><th class=\"words\">what it is</th>\
         <th>value</th><th>95 % interval</th><th class=\"words\">unit</th></tr>"
    )?;
    for (parameter, value) in numbers {
        let [number, interval] = shown(value);
        write!(
            page,
            "<tr><td>{}</td><td class=\"words small\">{}</td><td>{number}</td><td>{interval}</td>\
             <td class=\"words unit\">{}</td></tr>",
            escape(&parameter.name),
            escape(parameter.meaning),
            escape(&typeset(&parameter.quantity.unit(axis.unit)))
        )?;
    }
    write!(page, "</table></div>")
}

/// What happened several times, a row each.
fn table(page: &mut String, axis: &AxisDiagnosis, rows: &Rows) -> Result {
    write!(page, "<div class=\"scroll\"><table><tr>")?;
    for column in &rows.columns {
        let unit = typeset(&column.quantity.unit(axis.unit));
        write!(
            page,
            "<th title=\"{}\">{} <span class=\"unit\">{}</span></th>",
            escape(column.meaning),
            escape(column.stem()),
            escape(&unit)
        )?;
    }
    write!(page, "</tr>")?;
    for row in &rows.values {
        write!(page, "<tr>")?;
        for value in row {
            let number = value.map_or("\u{2013}".into(), |one| significant(one.value, 6));
            write!(page, "<td>{number}</td>")?;
        }
        write!(page, "</tr>")?;
    }
    write!(page, "</table></div>")?;
    match rows.more {
        0 => Ok(()),
        more => write!(page, "<p>and {more} more, in the JSON</p>"),
    }
}

/// The value, and its interval.
fn shown(value: &Value) -> [String; 2] {
    match (value.lo, value.hi) {
        (Some(lo), Some(hi)) if lo == hi => [significant(value.value, 6), "as it is".into()],
        (Some(lo), Some(hi)) => {
            let [value, lo, hi] = estimated(value.value, lo, hi);
            [value, format!("{lo} \u{2026} {hi}")]
        }
        _ => [significant(value.value, 6), "\u{2013}".into()],
    }
}

fn evidence(page: &mut String, one: &Finding) -> Result {
    write!(page, "<dl>")?;
    let mut entry =
        |name: &str, value: String| write!(page, "<div><dt>{name}</dt><dd>{value}</dd></div>");
    entry("by chance", probability(one.p_value))?;
    if let Some(nats) = one.gain.heldout_nats {
        entry(
            "gain on held-out data",
            format!("{} nats", significant(nats, 3)),
        )?;
    }
    if let Some(change) = one.gain.allan_change_percent {
        let small = if one.is_small() { ", small" } else { "" };
        entry(
            "changes the Allan deviation by",
            format!("{} % at most{small}", significant(change, 2)),
        )?;
    }
    if let (Some(before), Some(after)) = (
        one.gain.allan_error_percent_before,
        one.gain.allan_error_percent_after,
    ) {
        entry(
            "error of the model's Allan deviation",
            format!(
                "{} % \u{2192} {} %",
                significant(before, 2),
                significant(after, 2)
            ),
        )?;
    }
    for rival in one.rivals.iter().take(MOST_RIVALS) {
        entry(
            &format!("or {}", escape(rival.effect.name())),
            format!(
                "e<sup>{}</sup> times {} likely",
                significant(rival.log_odds.abs(), 3),
                way(rival)
            ),
        )?;
    }
    write!(page, "</dl>")
}

/// The coefficients as fitted without and with the finding.
fn coefficients(
    page: &mut String,
    axis: &AxisDiagnosis,
    one: &Finding,
    with: &PerCoefficient<Option<f64>>,
) -> Result {
    let cells = |row: &dyn Fn(Coefficient) -> Option<f64>| -> String {
        seen()
            .map(|letter| {
                let text = row(letter).map_or_else(
                    || "not resolved from zero".to_owned(),
                    |value| significant(value, 4),
                );
                format!("<td>{text}</td>")
            })
            .collect()
    };
    let heads: String = seen()
        .map(|letter| {
            let unit = escape(&typeset(&letter.unit(axis.unit)));
            format!(
                "<th>{}, <span class=\"unit\">{unit}</span></th>",
                letter.symbol()
            )
        })
        .collect();
    write!(
        page,
        "<div class=\"scroll\"><table><tr><th>coefficients</th>{heads}</tr>\
         <tr><td>without it</td>{}</tr><tr><td>with it</td>{}</tr></table></div>",
        cells(&|letter| *one.without.get(letter)),
        cells(&|letter| *with.get(letter)),
    )
}

/// The coefficients that change with a finding; the ramp is shown once, with all of them.
pub fn seen() -> impl Iterator<Item = Coefficient> {
    Coefficient::ALL
        .into_iter()
        .rev()
        .filter(|&letter| letter != Coefficient::R)
}
