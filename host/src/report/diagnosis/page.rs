//! A diagnosis as one self-contained page.

use std::fmt::{Result, Write};

use super::super::page;
use super::super::plot::frame::WIDTH;
use super::super::svg::{PAGE, escape, typeset};
use super::summary::summary;
use super::suspects::suspicion;
use super::text::MOST_TOLD;
use super::{HEIGHT, cards, pictures};
use crate::diagnosis::result::finding::{AxisDiagnosis, Diagnosis, Finding};
use crate::diagnosis::result::views::VelocityError;
use crate::numeric::written::significant;

/// The page.
pub fn render(diagnosis: &Diagnosis) -> String {
    let mut page = String::new();
    // Writing to a string cannot fail.
    let _ = write_page(&mut page, diagnosis);
    page
}

const FOOTER: &str = "Before is the model of the five terms alone, after that with the findings: \
    the law of its noise, and what its lines, steps and other courses add in this very record. \
    Intervals are 95 %. Averaging times are underlined where the former lies outside of the measured \
    interval, which one in twenty does by chance; frequencies where it is more than four standard \
    deviations off, which none should be. Whitened samples are divided by what the spectrum says \
    of their frequencies; before and after what was found is taken out.";

fn write_page(page: &mut String, diagnosis: &Diagnosis) -> Result {
    page::head(page, &diagnosis.source, "Diagnosis of", "Diagnosis")?;
    page::source(page, &diagnosis.source)?;
    for (index, axis) in diagnosis.axes.iter().enumerate() {
        self::axis(page, diagnosis, index, axis)?;
    }
    model(page, diagnosis)?;
    page::foot(page, FOOTER)
}

fn axis(page: &mut String, diagnosis: &Diagnosis, index: usize, axis: &AxisDiagnosis) -> Result {
    if let Some(refused) = &axis.refused {
        return write!(
            page,
            "<section class=\"wide\"><h2>Axis {}</h2><p class=\"lead\">Not diagnosed: {}.</p></section>",
            escape(&axis.name),
            escape(refused)
        );
    }
    write!(
        page,
        "<section class=\"wide\"><h2>Axis {}</h2><p class=\"lead\">{}</p><div class=\"pictures\">",
        escape(&axis.name),
        escape(&lead(axis, diagnosis.family_level))
    )?;
    for (label, picture) in pictures(axis, &format!("a{index}"), &PAGE) {
        write!(page, "<figure>")?;
        page::picture(page, (WIDTH, HEIGHT), label, &picture)?;
        write!(page, "</figure>")?;
    }
    write!(page, "</div><div class=\"cards\">")?;
    let is_folded =
        |number: &usize| axis.findings.len() > MOST_TOLD && axis.findings[*number].is_small();
    let (folded, plain): (Vec<_>, Vec<_>) = (0..axis.findings.len()).partition(is_folded);
    for number in plain {
        cards::finding(page, axis, number)?;
    }
    for one in &axis.unexplained {
        cards::remark(page, one)?;
    }
    write!(page, "</div>")?;
    if !folded.is_empty() {
        write!(
            page,
            "<details><summary>There, but small: {} more</summary><div class=\"cards\">",
            folded.len()
        )?;
        for number in folded {
            cards::finding(page, axis, number)?;
        }
        write!(page, "</div></details>")?;
    }
    suspects(page, axis)?;
    coefficients(page, axis)?;
    velocity(page, axis)?;
    write!(page, "</section>")
}

/// What came out, in a few sentences: first whether one may simulate with the model.
fn lead(axis: &AxisDiagnosis, level: f64) -> String {
    let names: Vec<String> = axis.findings.iter().map(Finding::name).collect();
    let found = match names.len() {
        0 => format!(
            "Nothing beyond the five terms (any finding in clean data: {} %)",
            significant(100.0 * level, 2)
        ),
        _ => format!("Beyond the five terms: {}", names.join(", ")),
    };
    let left = match axis.unexplained.len() {
        0 => "Nothing is left unexplained.".to_owned(),
        1 => "Something is left unexplained.".to_owned(),
        count => format!("{count} things are left unexplained."),
    };
    format!("{} {found}. {left}", summary(axis).join(" "))
}

/// What was suspected and not found.
fn suspects(page: &mut String, axis: &AxisDiagnosis) -> Result {
    for one in &axis.suspicions {
        let sentences = suspicion(one, axis.unit).join(". ");
        write!(
            page,
            "<p><b>Suspected, not found: {}.</b> {}.</p>",
            escape(one.effect.name()),
            escape(&sentences)
        )?;
    }
    Ok(())
}

fn coefficients(page: &mut String, axis: &AxisDiagnosis) -> Result {
    write!(
        page,
        "<div class=\"scroll\"><table><tr><th>coefficient</th><th>five terms alone</th>\
         <th>with the findings</th><th>95 % interval</th><th class=\"words\">unit</th></tr>"
    )?;
    for letter in cards::seen() {
        let before = *axis.base.model.coefficients.get(letter);
        let after = axis.last.coefficients.get(letter);
        let number =
            |value: Option<f64>| value.map_or("\u{2013}".into(), |value| significant(value, 4));
        let interval = match (after.lo, after.hi, after.upper) {
            (Some(lo), Some(hi), _) => {
                format!("{} \u{2026} {}", significant(lo, 4), significant(hi, 4))
            }
            (_, _, Some(upper)) => format!("&lt; {}", significant(upper, 3)),
            _ => "\u{2013}".into(),
        };
        write!(
            page,
            "<tr title=\"{}\"><td><b>{}</b> {}</td><td>{}</td><td>{}</td><td>{interval}</td>\
             <td class=\"words unit\">{}</td></tr>",
            escape(letter.meaning()),
            letter.symbol(),
            letter.name(),
            number(Some(before).filter(|value| *value > 0.0)),
            number(after.value),
            escape(&typeset(&letter.unit(axis.unit))),
        )?;
    }
    write!(page, "</table></div>")?;
    if let (Some(before), Some(after), Some(sampling)) = (
        axis.base.allan_error_percent,
        axis.last.allan_error_percent,
        axis.last.allan_error_sampling_percent,
    ) {
        write!(
            page,
            "<p>Allan deviation of the model on held-out data: off by {} %, with the findings {} % \
             (sampling alone: {} %).</p>",
            significant(before, 2),
            significant(after, 2),
            significant(sampling, 2)
        )?;
    }
    Ok(())
}

/// Error of the integral, observed and predicted.
fn velocity(page: &mut String, axis: &AxisDiagnosis) -> Result {
    let Some(first) = axis.views.velocity_error.first() else {
        return Ok(());
    };
    write!(
        page,
        "<details><summary>Error of the integral after an alignment of {} s, one sigma, {}\u{b7}s\
         </summary><div class=\"scroll\"><table><tr><th>after, s</th><th>observed</th>\
         <th>95 % interval</th><th>predicted by the five terms</th><th>with the findings</th></tr>",
        significant(first.alignment_s, 3),
        escape(&typeset(axis.unit.symbol()))
    )?;
    for one in &axis.views.velocity_error {
        let VelocityError {
            t_s,
            observed,
            lo,
            hi,
            before,
            after,
            ..
        } = *one;
        let [observed, lo, hi, before, after] =
            [observed, lo, hi, before, after].map(|value| significant(value, 3));
        write!(
            page,
            "<tr><td>{}</td><td>{observed}</td><td>{lo} \u{2026} {hi}</td><td>{before}</td>\
             <td>{after}</td></tr>",
            significant(t_s, 3)
        )?;
    }
    write!(page, "</table></div></details>")
}

/// The model and how to make data of it.
fn model(page: &mut String, diagnosis: &Diagnosis) -> Result {
    let text = serde_json::to_string_pretty(&diagnosis.model()).unwrap_or_default();
    write!(
        page,
        "<section><h2>The model</h2><p>Saved by <code>inm diagnose FILE --save-model model.json</code>; \
         data of it: <code>inm simulate --model model.json -o simulated.npy --duration {}</code></p>\
         <details><summary>model.json</summary><pre>{}</pre></details></section>",
        diagnosis.source.duration_s.round(),
        escape(&text)
    )
}
