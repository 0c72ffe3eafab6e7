//! The parts of the page, as HTML: what is said of the recording now.

use std::fmt::Write;

use crate::analyse::{Analysis, AxisAnalysis};
use crate::live::{Noise, Snapshot, Strip, words};
use crate::model::Coefficient;
use crate::plain::shown;
use crate::report::svg::{escape, typeset};
use crate::report::watched::{self, Recent};
use crate::signal::Signal;

/// Events that are listed: the last of them; the capture has all.
const EVENTS: usize = 40;

/// What is in an element.
pub type Part = (String, String);

/// What is shown of a recording of `signal` before there is anything to see: the places of the pictures, in
/// their order.
pub fn empty(signal: &Signal) -> Vec<Part> {
    let places = (0..signal.axes.len()).flat_map(|axis| {
        ["allan", "spectrum", "strip"].map(|what| {
            let words = "<p>not enough samples yet</p>".to_owned();
            (format!("{what}{axis}"), words)
        })
    });
    let words = [("coefficients", "<p>no fit yet</p>"), ("diagnosis", "")];
    places
        .chain(words.map(|(id, html)| (id.to_owned(), html.to_owned())))
        .collect()
}

/// What changes all the time: how far the recording is, link and board, events.
pub fn state(snapshot: &Snapshot) -> Vec<Part> {
    let lines = snapshot.state();
    let lines = lines.iter().map(|line| format!("<p>{}</p>", text(line)));
    vec![
        ("title".to_owned(), text(&snapshot.headline())),
        ("progress".to_owned(), text(&snapshot.progress())),
        ("link".to_owned(), lines.collect()),
        ("events".to_owned(), events(&snapshot.news)),
    ]
}

/// What the diagnosis has seen.
pub fn diagnosis(words: &str) -> Part {
    (
        "diagnosis".to_owned(),
        format!("<pre>{}</pre>", text(words)),
    )
}

/// Of which samples that is, and how old.
pub fn diagnosis_age(words: &str) -> Part {
    ("diagnosis-age".to_owned(), text(words))
}

/// Text of others, harmless in markup and on a screen.
pub fn text(text: &str) -> String {
    escape(&shown(text))
}

/// What happened, the last first.
fn events(news: &[String]) -> String {
    if news.is_empty() {
        return "<p>nothing has happened so far</p>".to_owned();
    }
    let items = news.iter().rev().take(EVENTS);
    let items = items.map(|one| format!("<li>{}</li>", text(one)));
    format!("<ul>{}</ul>", items.collect::<String>())
}

/// The coefficients of all axes: found, or bounded and how much longer it takes.
pub fn coefficients(analysis: &Analysis) -> Part {
    let mut table =
        String::from("<div class=\"scroll\"><table><tr><th scope=\"col\">coefficient</th>");
    // Writing to a string cannot fail.
    for axis in &analysis.axes {
        let _ = write!(table, "<th scope=\"col\">{}</th>", text(&axis.name));
    }
    table += "</tr>";
    let duration_s = analysis.source.duration_s;
    for coefficient in Coefficient::ALL.into_iter().rev() {
        let unit = analysis
            .axes
            .first()
            .map(|axis| coefficient.unit(axis.unit));
        let _ = write!(
            table,
            "<tr><th scope=\"row\">{} {}, {}</th>",
            coefficient.symbol(),
            coefficient.name(),
            escape(&typeset(&unit.unwrap_or_default()))
        );
        for axis in &analysis.axes {
            let fit = axis.fits.likelihood.as_ref();
            let noise =
                fit.and_then(|fit| Noise::of(fit.coefficients.get(coefficient), duration_s));
            let class = match noise {
                Some(Noise::Value(..)) => "well",
                _ => "bound",
            };
            let words = escape(&words::coefficient(noise));
            let _ = write!(table, "<td class=\"{class}\">{words}</td>");
        }
        table += "</tr>";
    }
    ("coefficients".to_owned(), table + "</table></div>")
}

/// The pictures of an axis, by number; `None` where there is too little for one.
pub fn axis(number: usize, axis: &AxisAnalysis) -> Option<[Part; 2]> {
    if axis.allan.is_empty() || axis.spectrum.is_empty() {
        return None;
    }
    let head = |what: &str| format!("<h2>{what}, axis {}</h2>", text(&axis.name));
    let [allan, spectrum] = [format!("allan{number}"), format!("spectrum{number}")];
    Some([
        (
            allan.clone(),
            head("Allan deviation") + &watched::allan(axis, &allan),
        ),
        (
            spectrum.clone(),
            head("Spectrum") + &watched::spectrum(axis, &spectrum),
        ),
    ])
}

/// The last seconds of every axis.
pub fn strips(strip: &Strip) -> Vec<Part> {
    let axes = strip.axes().iter().enumerate();
    axes.map(|(number, axis)| {
        let id = format!("strip{number}");
        let recent = Recent {
            unit: axis.unit.symbol(),
            points: strip.points(number),
        };
        let head = format!("<h2>Last seconds, axis {}</h2>", text(&axis.name));
        (id.clone(), head + &watched::recent(&recent, &id))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::{AnalysisOptions, analyse};
    use crate::{Model, simulate};

    #[test]
    fn a_published_fit_that_has_holes_is_not_drawn_while_the_record_grows() {
        let model = Model::open("published:X").expect("built in");
        let mut record = simulate(&model, 8000, 1, None).expect("simulated");
        let analysis = analyse(&mut record, &AnalysisOptions::default(), |_| {});
        let mut one = analysis.expect("analysed").axes.remove(0);
        let drawn = |one: &AxisAnalysis| {
            let [(_, picture), _] = axis(0, one).expect("pictures");
            picture.contains("published fit")
        };
        for model in &mut one.curves {
            model.published = Some(1e-3);
        }
        assert!(drawn(&one));
        one.curves[3].published = None;
        assert!(!drawn(&one));
    }
}
