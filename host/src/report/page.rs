//! What all pages have in common: self-contained, no scripts, no outside resources; the head, and
//! what was read.

use std::fmt::{Result, Write};

use super::rate;
use super::svg::escape;
use super::text::unusable_words;
use crate::analyse::{GapSummary, SourceSummary};
use crate::numeric::written::{duration, grouped, plain, significant};

/// Colours, light and dark, and tables.
pub const STYLE: &str = include_str!("page.css");

/// Gaps, and notes, listed at most.
const MOST_GAPS: usize = 100;

/// Everything up to the first section; `what` is said under the name of the source.
pub fn head(page: &mut String, source: &SourceSummary, title: &str, what: &str) -> Result {
    let name = escape(&source.file);
    write!(
        page,
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{title} {name}</title><style>{STYLE}</style></head><body><main>\
         <h1>{name}</h1><p class=\"lead\">{what} by inm {}</p>",
        env!("CARGO_PKG_VERSION")
    )
}

/// A picture of `width` by `height` pixels, described by `label`.
pub fn picture(
    page: &mut String,
    (width, height): (f64, f64),
    label: &str,
    drawing: &str,
) -> Result {
    write!(
        page,
        "<svg viewBox=\"0 0 {width} {height}\" font-size=\"12\" role=\"img\" \
         aria-label=\"{}\">{drawing}</svg>",
        escape(label)
    )
}

/// The footer, and what closes the page.
pub fn foot(page: &mut String, text: &str) -> Result {
    writeln!(page, "<footer><p>{text}</p></footer></main></body></html>")
}

/// The section that says what was read.
pub fn source(page: &mut String, source: &SourceSummary) -> Result {
    let SourceSummary {
        samples,
        duration_s,
        rate_hz,
        lost_samples,
        gaps,
        unusable,
        news,
        chain,
        ..
    } = source;
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
    for (clock, words) in rate::by_clocks(source) {
        let words = escape(&words);
        write!(page, "<div><dt>By {clock}</dt><dd>{words}</dd></div>")?;
    }
    write!(page, "</dl>")?;
    if let Some(words) = rate::contradicted(source) {
        write!(page, "<p class=\"warning\">{}</p>", escape(&words))?;
    }
    for one in unusable {
        let words = escape(&unusable_words(one));
        write!(page, "<p class=\"warning\">{words}</p>")?;
    }
    if !gaps.is_empty() {
        timeline(page, source)?;
        gap_table(page, gaps)?;
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

/// The gaps one by one, folded away.
fn gap_table(page: &mut String, gaps: &[GapSummary]) -> Result {
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
    write!(page, "</details>")
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
