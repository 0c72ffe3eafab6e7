//! A diagnosis for people: text, one self-contained page, one bitmap.
//!
//! Four pictures an axis, each with the record, the model of five terms alone (before) and the
//! extended model (after) on the same scales, and a simulation of the latter next to them.

mod allan;
mod amplitudes;
mod cards;
mod course;
mod numbers;
pub mod page;
mod places;
mod rivals;
pub mod sheet;
mod spectrum;
mod summary;
mod suspects;
pub mod text;

use super::plot::Stroke;
use super::plot::frame::{Field, Frame, Layout};
use super::plot::legend::Mark;
use super::svg::Theme;
use crate::diagnosis::result::finding::AxisDiagnosis;

/// Height of a picture, pixels.
const HEIGHT: f64 = 480.0;

/// A picture with a strip, and one without.
const WITH_STRIP: Layout = Layout {
    height: HEIGHT,
    strip: true,
};
const WITHOUT_STRIP: Layout = Layout {
    height: HEIGHT,
    strip: false,
};

/// Opacity of what marks a difference.
const DIFFERS: f64 = 0.13;

/// The four pictures of an axis, each with what it shows; `id` is unique within the document.
fn pictures(axis: &AxisDiagnosis, id: &str, theme: &Theme) -> [(&'static str, String); 4] {
    let id = |name: &str| format!("{id}-{name}");
    [
        ("Allan deviation", allan::panel(axis, &id("allan"), theme)),
        ("spectrum", spectrum::panel(axis, &id("spectrum"), theme)),
        ("record in time", course::panel(axis, &id("course"), theme)),
        (
            "law of the whitened samples",
            amplitudes::panel(axis, &id("amplitudes"), theme),
        ),
    ]
}

/// How the model of five terms alone is drawn, and the extended one.
const fn before(theme: &Theme) -> Stroke {
    Stroke::dashed(theme.before, 1.7, "6 5")
}

const fn after(theme: &Theme) -> Stroke {
    Stroke::solid(theme.fitted, 1.8)
}

/// A point of a curve: where it is, and what is expected there before and after, and simulated.
type Modelled = (f64, f64, f64, Option<f64>);

/// Draws what both models expect, and the simulated record.
fn models(frame: &mut Frame<'_>, points: &[Modelled], simulated: Mark) {
    let theme = frame.theme();
    let made: Vec<(f64, f64)> = points
        .iter()
        .map(|&(x, _, _, simulated)| (x, simulated.unwrap_or(f64::NAN)))
        .collect();
    let any = made.iter().any(|(_, value)| value.is_finite());
    match simulated {
        Mark::Line(stroke) => frame.line(Field::Main, made, stroke),
        _ => frame.crosses(Field::Main, made.into_iter().filter(|(_, y)| y.is_finite())),
    }
    let of = |which: fn(&Modelled) -> f64| points.iter().map(move |one| (one.0, which(one)));
    frame.line(Field::Main, of(|one| one.1), before(theme));
    frame.line(Field::Main, of(|one| one.2), after(theme));
    frame.explain(Mark::Line(before(theme)), "before");
    frame.explain(Mark::Line(after(theme)), "after");
    if any {
        frame.explain(simulated, "simulated");
    }
}
