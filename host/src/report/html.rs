//! The result as one self-contained page: no scripts, no outside resources.

use std::fmt::{Result, Write};

use super::allan_plot::{self, HEIGHT, WIDTH};
use super::number::{duration, grouped, plain, significant};
use super::spectrum_plot;
use super::svg::{PAGE, escape, typeset};
use super::verdict::{self, Trust};
use crate::analyse::{Analysis, AxisAnalysis, LikelihoodValue, PublishedValue, SourceSummary};
use crate::model::Coefficient;

const STYLE: &str = include_str!("page.css");

/// Gaps, and notes, listed at most.
const MOST_GAPS: usize = 100;

/// The page.
pub fn render(analysis: &Analysis) -> String {
    let mut page = String::new();
    // Writing to a string cannot fail.
    let _ = write_page(&mut page, analysis);
    page
}

fn write_page(page: &mut String, analysis: &Analysis) -> Result {
    let name = escape(&analysis.source.file);
    write!(
        page,
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Noise of {name}</title><style>{STYLE}</style></head><body><main>\
         <h1>{name}</h1><p class=\"lead\">Noise analysis by inm {}</p>",
        env!("CARGO_PKG_VERSION")
    )?;
    source(page, analysis)?;
    for (index, axis) in analysis.axes.iter().enumerate() {
        self::axis(page, index, axis)?;
    }
    writeln!(page, "{FOOTER}</main></body></html>")
}

const FOOTER: &str = "<footer><p>Intervals are 95 %: chi-squared with the equivalent degrees of \
    freedom of the noise type that the local slope of the curve shows; for coefficients from the \
    profile of the likelihood of the spectrum, and a coefficient counts as told from zero by a test \
    of 5 %. The weighted fit weighs each point of the modified Allan variance by its own \
    uncertainty and keeps squares from becoming negative. The published fit is unweighted least \
    squares at 17 averaging times (Pavlov and Petrov, eq. 9 to 11), squares as they come \
    out.</p><p>Spectral densities behind the coefficients are two-sided. N in the one-sided \
    convention of data sheets is larger by the root of two.</p></footer>";

fn source(page: &mut String, analysis: &Analysis) -> Result {
    let SourceSummary {
        samples,
        duration_s,
        rate_hz,
        lost_samples,
        gaps,
        news,
        chain,
        ..
    } = &analysis.source;
    write!(page, "<section><dl>")?;
    for (name, value) in [
        ("Samples an axis", grouped(*samples)),
        ("Rate", format!("{} /s", plain(*rate_hz))),
        ("Duration", duration(*duration_s)),
        (
            "Lost samples",
            if gaps.is_empty() {
                "none".into()
            } else {
                grouped(*lost_samples)
            },
        ),
        ("Gaps", grouped(gaps.len() as u64)),
        (
            "Signal chain",
            chain.as_deref().map_or("not stated".into(), escape),
        ),
    ] {
        write!(page, "<div><dt>{name}</dt><dd>{value}</dd></div>")?;
    }
    write!(page, "</dl>")?;
    if !gaps.is_empty() {
        timeline(page, &analysis.source)?;
        write!(
            page,
            "<details><summary>All gaps</summary><div class=\"scroll\"><table><tr><th>at, s</th>\
             <th>samples</th><th>length, s</th><th class=\"words\">cause</th></tr>"
        )?;
        for gap in gaps.iter().take(MOST_GAPS) {
            write!(
                page,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"words\">{}</td></tr>",
                significant(gap.from_s, 7),
                gap.samples.map_or("unknown".into(), grouped),
                gap.duration_s
                    .map_or("unknown".into(), |length| significant(length, 4)),
                escape(&gap.cause)
            )?;
        }
        write!(page, "</table></div>")?;
        if gaps.len() > MOST_GAPS {
            write!(page, "<p>and {} more</p>", gaps.len() - MOST_GAPS)?;
        }
        write!(page, "</details>")?;
    }
    if !news.is_empty() {
        write!(
            page,
            "<details><summary>Notes ({})</summary><ul>",
            news.len()
        )?;
        for note in news.iter().take(MOST_GAPS) {
            write!(page, "<li>{}</li>", escape(note))?;
        }
        write!(page, "</ul></details>")?;
    }
    write!(page, "</section>")
}

/// The record as a bar, with its gaps.
fn timeline(page: &mut String, source: &SourceSummary) -> Result {
    write!(
        page,
        "<svg viewBox=\"0 0 1000 26\" style=\"margin-top:16px\" role=\"img\" aria-label=\"gaps in time\">\
         <rect y=\"6\" width=\"1000\" height=\"14\" rx=\"3\" fill=\"var(--measured)\" fill-opacity=\"0.35\"/>"
    )?;
    let scale = 1000.0 / source.duration_s.max(f64::MIN_POSITIVE);
    for gap in &source.gaps {
        // At least two pixels, so that the shortest gap shows.
        let width = (gap.duration_s.unwrap_or(0.0) * scale).max(2.0);
        write!(
            page,
            "<rect x=\"{:.1}\" y=\"2\" width=\"{width:.1}\" height=\"22\" fill=\"var(--bad)\"/>",
            (gap.from_s * scale).min(998.0)
        )?;
    }
    write!(page, "</svg>")
}

fn axis(page: &mut String, index: usize, axis: &AxisAnalysis) -> Result {
    let mean = axis.mean.map_or("none".into(), |mean| significant(mean, 6));
    write!(
        page,
        "<section><h2>Axis {}</h2><p class=\"lead\">mean {mean} {}{}</p>",
        escape(&axis.name),
        escape(&typeset(axis.unit.symbol())),
        match axis.invalid_samples {
            0 => String::new(),
            count => format!(", {} unusable samples left out", grouped(count)),
        }
    )?;
    if axis.allan.is_empty() {
        return write!(page, "<p>Too short for an Allan deviation.</p></section>");
    }
    let decades = allan_plot::decades(std::iter::once(axis));
    let plot = allan_plot::panel(axis, &format!("axis{index}"), decades, &PAGE);
    write!(
        page,
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-size=\"12\" role=\"img\" \
         aria-label=\"Allan deviation\">{plot}</svg>"
    )?;
    if !axis.spectrum.is_empty() {
        let decades = spectrum_plot::decades(std::iter::once(axis));
        let plot = spectrum_plot::panel(axis, &format!("spectrum{index}"), decades, &PAGE);
        write!(
            page,
            "<svg viewBox=\"0 0 {WIDTH} {}\" font-size=\"12\" role=\"img\" \
             aria-label=\"spectrum\">{plot}</svg>",
            spectrum_plot::HEIGHT
        )?;
    }
    if let Some(warning) = verdict::misfit(axis) {
        write!(page, "<p class=\"warning\">{}</p>", escape(&warning))?;
    }
    coefficients(page, axis)?;
    points(page, axis)?;
    write!(page, "</section>")
}

fn coefficients(page: &mut String, axis: &AxisAnalysis) -> Result {
    let (likelihood, weighted) = (&axis.fits.likelihood, &axis.fits.weighted);
    if likelihood.is_none() && weighted.is_none() {
        return write!(page, "<p>Too short for a fit of five coefficients.</p>");
    }
    write!(
        page,
        "<div class=\"scroll\"><table><tr><th>coefficient</th><th>likelihood fit</th>\
         <th>95 % interval</th><th class=\"words\">unit</th><th class=\"words\">verdict</th>\
         <th>weighted fit</th><th>published fit</th></tr>"
    )?;
    let number =
        |value: Option<f64>| value.map_or("\u{2013}".into(), |value| significant(value, 4));
    for coefficient in Coefficient::ALL.into_iter().rev() {
        let value = likelihood
            .as_ref()
            .map(|fit| fit.coefficients.get(coefficient));
        let published = axis.fits.published.as_ref().map(|fit| fit.get(coefficient));
        write!(
            page,
            "<tr title=\"{}\"><td><b>{}</b> {}</td><td>{}</td><td>{}</td>\
             <td class=\"words unit\" style=\"min-width:0\">{}</td><td class=\"words {}\">{}</td>\
             <td>{}</td><td>{}</td></tr>",
            escape(coefficient.meaning()),
            coefficient.symbol(),
            coefficient.name(),
            number(value.and_then(|value| value.value)),
            value.map_or("\u{2013}".into(), interval),
            escape(&typeset(&coefficient.unit(axis.unit))),
            value.map_or("", |value| class(verdict::trust(value))),
            value.map_or(String::new(), |value| escape(&verdict::sentence(value))),
            number(weighted.as_ref().and_then(|fit| fit.get(coefficient).value)),
            published.map_or("\u{2013}".into(), |published| published_value(
                published, value
            )),
        )?;
    }
    write!(page, "</table></div>")?;
    if let Some(tied) = likelihood.as_ref().and_then(verdict::tied) {
        write!(page, "<p>{}</p>", escape(&tied))?;
    }
    if likelihood.is_none() {
        write!(page, "<p>{}</p>", verdict::NO_SPECTRUM)?;
    }
    for note in verdict::velocity_error(axis)
        .into_iter()
        .chain(verdict::data_sheet(axis))
    {
        write!(page, "<p>{}</p>", escape(&note))?;
    }
    Ok(())
}

fn interval(value: &LikelihoodValue) -> String {
    match (value.identified, value.hi, value.upper) {
        (true, Some(hi), _) => format!(
            "{} \u{2026} {}",
            significant(value.lo, 4),
            significant(hi, 4)
        ),
        (true, None, _) => format!("&gt; {}", significant(value.lo, 4)),
        (false, _, Some(upper)) => format!("&lt; {}", significant(upper, 3)),
        (false, _, None) => "\u{2013}".into(),
    }
}

const fn class(trust: Trust) -> &'static str {
    match trust {
        Trust::Well => "well",
        Trust::Roughly | Trust::Barely => "roughly",
        Trust::Bound => "bound",
    }
}

fn published_value(published: &PublishedValue, value: Option<&LikelihoodValue>) -> String {
    let text = match published.value {
        Some(value) => significant(value, 4),
        None => format!("square {}", significant(published.squared, 3)),
    };
    match value.and_then(|value| verdict::published(published, value)) {
        Some(remark) => {
            format!(
                "<span class=\"negative\" title=\"{}\">{text}</span>",
                escape(&remark)
            )
        }
        None => text,
    }
}

/// Every point, folded away.
fn points(page: &mut String, axis: &AxisAnalysis) -> Result {
    write!(
        page,
        "<details><summary>All {} points</summary><div class=\"scroll\"><table><tr>\
         <th>tau, s</th><th>m</th><th>Allan</th><th>95 % interval</th><th>edf</th>\
         <th>modified</th><th>Hadamard</th></tr>",
        axis.allan.len()
    )?;
    for point in &axis.allan {
        let same = |curve: &[crate::analyse::CurvePoint]| {
            let found = curve.iter().find(|other| other.m == point.m);
            found.map_or("\u{2013}".into(), |other| significant(other.adev, 5))
        };
        write!(
            page,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{} \u{2026} {}</td><td>{}</td><td>{}</td>\
             <td>{}</td></tr>",
            significant(point.tau_s, 6),
            grouped(point.m),
            significant(point.adev, 6),
            significant(point.lo, 4),
            significant(point.hi, 4),
            significant(point.edf, 3),
            same(&axis.modified),
            same(&axis.hadamard)
        )?;
    }
    write!(page, "</table></div></details>")
}
