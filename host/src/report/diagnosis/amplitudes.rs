//! How often the whitened record takes which values, before and after, with the normal law.

use std::f64::consts::TAU;

use super::super::plot::Stroke;
use super::super::plot::frame::{Field, Frame, Title, Titles};
use super::super::plot::legend::Mark;
use super::super::plot::scale::Scale;
use super::super::svg::{Theme, escape};
use super::WITHOUT_STRIP;
use crate::diagnosis::result::finding::AxisDiagnosis;
use crate::diagnosis::result::views::Counts;
use crate::diagnosis::views::amplitudes::WIDTH;

/// Standard deviations that are shown at least.
const LEAST: f64 = 6.0;

/// Lowest count on the logarithmic scale: below one, so that one shows.
const FLOOR: f64 = 0.5;

/// Opacity of the bars.
const BARS: f64 = 0.3;

/// The picture as SVG elements; `id` is unique within the document.
pub fn panel(axis: &AxisDiagnosis, id: &str, theme: &Theme) -> String {
    let views = &axis.views.amplitudes;
    let reach = views.before.reach().max(views.after.reach()).max(LEAST);
    let total = views.after.total() as f64;
    let most = (total * WIDTH).max(10.0).log10().ceil();
    let titles = Titles {
        head: escape(&format!("Axis {}, whitened", axis.name)),
        x: Title::new(
            "whitened sample, standard deviations (all beyond in the last class)",
            "",
        ),
        y: Title::new("samples in a class", ""),
        strip: Title::default(),
    };
    let mut frame = Frame::new(
        id,
        theme,
        WITHOUT_STRIP,
        titles,
        (
            |pixels| Scale::linear((-reach, reach), pixels),
            |pixels| Scale::log((FLOOR.log10(), most), pixels),
        ),
    );
    let after: Vec<_> = steps(&views.after)
        .into_iter()
        .map(|(z, count)| (z, FLOOR, count))
        .collect();
    frame.band(Field::Main, &after, theme.measured, BARS);
    let before = Stroke::solid(theme.before, 1.2);
    let outline = Stroke::solid(theme.measured, 1.0);
    frame.line(Field::Main, steps(&views.after), outline);
    frame.line(Field::Main, steps(&views.before), before);
    let normal = |z: f64| total * WIDTH * (-0.5 * z * z).exp() / TAU.sqrt();
    let points = (0..=400).map(|step| reach * (f64::from(step) / 200.0 - 1.0));
    let curve = points.map(|z| (z, normal(z).max(1e-3)));
    frame.line(Field::Main, curve, super::after(theme));
    frame.explain(Mark::Line(before), "before");
    frame.explain(Mark::LineOnBand(outline, BARS), "after");
    frame.explain(Mark::Line(super::after(theme)), "normal law");
    frame.finish()
}

/// The outline of the classes; empty ones lie below the field.
fn steps(counts: &Counts) -> Vec<(f64, f64)> {
    let ends = |(low, count): (f64, u64)| {
        let height = (count as f64).max(0.1 * FLOOR);
        [(low, height), (low + WIDTH, height)]
    };
    counts.classes().flat_map(ends).collect()
}
