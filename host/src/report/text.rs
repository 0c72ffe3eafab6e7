//! The result as a short table for the terminal.

use std::fmt::Write;

use super::{rate, verdict};
use crate::analyse::{
    Analysis, AxisAnalysis, CurvePoint, LikelihoodValue, PublishedValue, SourceSummary,
    UnusableSummary,
};
use crate::model::Coefficient;
use crate::numeric::written::{duration, grouped, plain, significant};
use crate::plain::on_a_line;

/// Rows of the Allan table at most; JSON and HTML have every point.
const MOST_ROWS: usize = 24;

/// Gaps listed at most.
const MOST_GAPS: usize = 5;

/// Notes printed at most.
const MOST_NEWS: usize = 10;

/// The whole text, with a newline at the end.
pub fn render(analysis: &Analysis) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = head(&mut text, &analysis.source)
        .and_then(|()| {
            analysis
                .axes
                .iter()
                .try_for_each(|axis| coefficients(&mut text, axis))
        })
        .and_then(|()| allan_table(&mut text, &analysis.axes));
    text
}

pub(super) fn head(text: &mut String, source: &SourceSummary) -> std::fmt::Result {
    writeln!(
        text,
        "{}: {} samples an axis at {}/s, {}",
        on_a_line(&source.file),
        grouped(source.samples),
        plain(source.rate_hz),
        duration(source.duration_s),
    )?;
    for (clock, words) in rate::by_clocks(source) {
        writeln!(text, "Data rate by {clock}: {words}.")?;
    }
    if let Some(words) = rate::contradicted(source) {
        writeln!(text, "{words}")?;
    }
    gaps(text, source)?;
    for news in source.news.iter().take(MOST_NEWS) {
        writeln!(text, "Note: {news}")?;
    }
    if source.news.len() > MOST_NEWS {
        writeln!(text, "and {} more notes", source.news.len() - MOST_NEWS)?;
    }
    Ok(())
}

fn gaps(text: &mut String, source: &SourceSummary) -> std::fmt::Result {
    if source.gaps.is_empty() && source.unusable.is_empty() {
        return writeln!(text, "No gaps.");
    }
    if source.gaps.is_empty() {
        writeln!(text, "No gaps that all axes share.")?;
        return unusable(text, source);
    }
    writeln!(
        text,
        "{} {}, {} samples known to be missing; no difference spans a gap.",
        source.gaps.len(),
        if source.gaps.len() == 1 {
            "gap"
        } else {
            "gaps"
        },
        grouped(source.lost_samples)
    )?;
    for gap in source.gaps.iter().take(MOST_GAPS) {
        let length = gap.samples.map_or("an unknown number of".into(), grouped);
        writeln!(
            text,
            "  at {} s: {length} samples, {}",
            significant(gap.from_s, 6),
            gap.cause
        )?;
    }
    if source.gaps.len() > MOST_GAPS {
        writeln!(text, "  and {} more", source.gaps.len() - MOST_GAPS)?;
    }
    unusable(text, source)
}

/// What is missing of single axes.
fn unusable(text: &mut String, source: &SourceSummary) -> std::fmt::Result {
    for one in &source.unusable {
        writeln!(text, "  {}", unusable_words(one))?;
    }
    Ok(())
}

/// What is missing of one axis alone, in words.
pub(super) fn unusable_words(one: &UnusableSummary) -> String {
    let stretches = match one.stretches {
        1 => "a stretch".to_owned(),
        many => format!("{} stretches", grouped(many)),
    };
    format!(
        "axis {} alone: {} samples in {stretches} do not count, the first at {} s, at most {} s on end",
        one.axis,
        grouped(one.samples),
        significant(one.first_s, 6),
        significant(one.longest_s, 3)
    )
}

fn coefficients(text: &mut String, axis: &AxisAnalysis) -> std::fmt::Result {
    writeln!(text)?;
    let mean = axis.mean.map_or("none".into(), |mean| significant(mean, 6));
    write!(text, "Axis {}: mean {mean} {}", axis.name, axis.unit)?;
    if axis.invalid_samples > 0 {
        write!(
            text,
            ", {} unusable samples left out",
            grouped(axis.invalid_samples)
        )?;
    }
    if let Some(chain) = &axis.chain {
        write!(text, "; the fit knows its chain {chain}")?;
    }
    writeln!(text)?;
    let (likelihood, weighted) = (&axis.fits.likelihood, &axis.fits.weighted);
    if likelihood.is_none() && weighted.is_none() {
        return writeln!(text, "  Too short for a fit of five coefficients.");
    }
    let width = Coefficient::ALL
        .iter()
        .map(|one| one.unit(axis.unit).len())
        .max()
        .unwrap_or_default();
    writeln!(
        text,
        "  {:<22} {:>11} {:>23} {:>11} {:>13}  {:<width$}",
        "", "likelihood", "95 % interval", "weighted", "published", "unit"
    )?;
    for coefficient in Coefficient::ALL.into_iter().rev() {
        let line = coefficient_line(axis, coefficient, width);
        writeln!(text, "{}", line.trim_end())?;
    }
    let tied = likelihood.as_ref().and_then(verdict::tied);
    let stands_in = likelihood
        .is_none()
        .then(|| verdict::NO_SPECTRUM.to_owned());
    for note in [
        tied,
        stands_in,
        verdict::misfit(axis),
        verdict::velocity_error(axis),
    ]
    .into_iter()
    .flatten()
    .chain(verdict::data_sheet(axis))
    {
        writeln!(text, "  {note}")?;
    }
    Ok(())
}

/// A coefficient by each of the fits, with a sentence; its unit takes `width` characters.
fn coefficient_line(axis: &AxisAnalysis, coefficient: Coefficient, width: usize) -> String {
    let (likelihood, weighted) = (&axis.fits.likelihood, &axis.fits.weighted);
    let value = likelihood
        .as_ref()
        .map(|fit| fit.coefficients.get(coefficient));
    let published = axis.fits.published.as_ref().map(|fit| fit.get(coefficient));
    let number = |value: Option<f64>| value.map_or("-".into(), |value| significant(value, 4));
    let remark = value
        .zip(published)
        .and_then(|(value, published)| verdict::published(published, value));
    format!(
        "  {} {:<20} {:>11} {:>23} {:>11} {:>13}  {:<width$}  {}{}",
        coefficient.symbol(),
        coefficient.name(),
        number(value.and_then(|value| value.value)),
        value.map_or("-".into(), interval),
        number(weighted.as_ref().and_then(|fit| fit.get(coefficient).value)),
        published.map_or("-".into(), published_value),
        coefficient.unit(axis.unit),
        value.map_or(String::new(), verdict::sentence),
        remark.map_or(String::new(), |remark| format!(" ({remark})")),
    )
}

fn interval(value: &LikelihoodValue) -> String {
    match (value.identified, value.hi, value.upper) {
        (true, Some(hi), _) => {
            format!("{} .. {}", significant(value.lo, 4), significant(hi, 4))
        }
        (true, None, _) => format!("above {}", significant(value.lo, 4)),
        (false, _, Some(upper)) => format!("below {}", significant(upper, 3)),
        (false, _, None) => "-".into(),
    }
}

fn published_value(value: &PublishedValue) -> String {
    match value.value {
        Some(value) => significant(value, 4),
        None => format!("sq {}", significant(value.squared, 3)),
    }
}

fn allan_table(text: &mut String, axes: &[AxisAnalysis]) -> std::fmt::Result {
    let Some(longest) = axes.iter().max_by_key(|axis| axis.allan.len()) else {
        return Ok(());
    };
    if longest.allan.is_empty() {
        return Ok(());
    }
    let overlap = match longest.overlap {
        crate::analyse::Overlap::Full => "every overlap",
        crate::analyse::Overlap::Strided => "bounded memory",
    };
    writeln!(
        text,
        "\nAllan deviation ({overlap}), half width of the 95 % interval in percent"
    )?;
    write!(text, "  {:>12}", "tau, s")?;
    for axis in axes {
        write!(text, "  {:>22}", format!("{}, {}", axis.name, axis.unit))?;
    }
    writeln!(text)?;
    for row in shown(&longest.allan) {
        write!(text, "  {:>12}", significant(row.tau_s, 6))?;
        for axis in axes {
            let cell = axis
                .allan
                .iter()
                .find(|point| point.m == row.m)
                .map_or("-".into(), cell);
            write!(text, "  {cell:>22}")?;
        }
        writeln!(text)?;
    }
    Ok(())
}

/// All points where they are few, else those at powers of two, else evenly chosen ones.
fn shown(points: &[CurvePoint]) -> Vec<&CurvePoint> {
    if points.len() <= MOST_ROWS {
        return points.iter().collect();
    }
    let octaves: Vec<_> = points
        .iter()
        .filter(|point| point.m.is_power_of_two())
        .collect();
    if (MOST_ROWS / 2..=MOST_ROWS + 8).contains(&octaves.len()) {
        return octaves;
    }
    points
        .iter()
        .step_by(points.len().div_ceil(MOST_ROWS))
        .collect()
}

fn cell(point: &CurvePoint) -> String {
    let percent = 50.0 * (point.hi - point.lo) / point.adev;
    let width = if percent < 0.1 {
        "<0.1".into()
    } else {
        significant(percent, 2)
    };
    format!("{} +-{width:>4}", significant(point.adev, 8))
}
