//! The result of an analysis as one self-contained page.

use std::fmt::{Result, Write};

use super::allan_plot;
use super::page;
use super::plot::frame::WIDTH;
use super::spectrum_plot;
use super::svg::{PAGE, escape, typeset};
use super::verdict::{self, Trust};
use crate::analyse::{Analysis, AxisAnalysis, LikelihoodValue, PublishedValue};
use crate::model::Coefficient;
use crate::numeric::written::{grouped, significant};

/// The page.
pub fn render(analysis: &Analysis) -> String {
    let mut page = String::new();
    // Writing to a string cannot fail.
    let _ = write_page(&mut page, analysis);
    page
}

fn write_page(page: &mut String, analysis: &Analysis) -> Result {
    page::head(page, &analysis.source, "Noise of", "Noise analysis")?;
    page::source(page, &analysis.source)?;
    for (index, axis) in analysis.axes.iter().enumerate() {
        self::axis(page, index, axis)?;
    }
    page::foot(page, FOOTER)
}

const FOOTER: &str = "Intervals are 95 %: chi-squared with the equivalent degrees of \
    freedom of the noise type that the local slope of the curve shows; for coefficients from the \
    profile of the likelihood of the spectrum, and a coefficient counts as resolved from zero by a test \
    of 5 %. The weighted fit weighs each point of the modified Allan variance by its own \
    uncertainty and keeps squares from becoming negative. The published fit is unweighted least \
    squares at 17 averaging times (Pavlov and Petrov, eq. 9 to 11), squares as they come \
    out.</p><p>Spectral densities behind the coefficients are two-sided. N in the one-sided \
    convention of data sheets is larger by the root of two.";

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
    let plot = allan_plot::panel(axis, &format!("axis{index}"), "", decades, &PAGE);
    page::picture(page, (WIDTH, allan_plot::HEIGHT), "Allan deviation", &plot)?;
    if !axis.spectrum.is_empty() {
        let decades = spectrum_plot::decades(std::iter::once(axis));
        let plot = spectrum_plot::panel(axis, &format!("spectrum{index}"), "", decades, &PAGE);
        page::picture(page, (WIDTH, spectrum_plot::HEIGHT), "spectrum", &plot)?;
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
