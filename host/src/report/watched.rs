//! Pictures for a page whose script reads values from them: each says where its values are, as ends of
//! its scales in values and in pixels.

use std::borrow::Cow;

use super::plot::frame::{Frame, LEFT, Layout, RIGHT, Title, Titles, WIDTH};
use super::plot::scale::Scale;
use super::plot::{Stroke, frame::Field};
use super::svg::{PAGE, escape, typeset};
use super::{allan_plot, page, spectrum_plot};
use crate::analyse::AxisAnalysis;

/// Height of the strip of the last seconds, pixels.
const STRIP_HEIGHT: f64 = 240.0;

const STRIP: Layout = Layout {
    height: STRIP_HEIGHT,
    strip: false,
};

/// Opacity of what lies between the least and the largest sample.
const BETWEEN: f64 = 0.5;

/// Room above and below the samples, as a part of their span.
const MARGIN: f64 = 0.1;

/// The last seconds of an axis.
pub struct Recent<'a> {
    /// Unit of its values.
    pub unit: &'a str,
    /// Time, seconds; least and largest value about then.
    pub points: Vec<(f64, f64, f64)>,
}

/// A scale: logarithmic or not, ends in values (their common logarithms), ends in pixels.
struct Reading {
    log: bool,
    ends: (f64, f64),
    pixels: (f64, f64),
    /// What is read, and its unit.
    name: String,
}

impl Reading {
    fn attributes(&self, axis: &str) -> String {
        let kind = if self.log { "log" } else { "linear" };
        let [(from, to), (first, last)] = [self.ends, self.pixels];
        format!(
            " data-{axis}=\"{kind} {from} {to} {first} {last}\" data-{axis}-name=\"{}\"",
            escape(&self.name)
        )
    }
}

/// The Allan deviation of an axis; `id` is unique within the page.
pub fn allan(axis: &AxisAnalysis, id: &str) -> String {
    let decades = allan_plot::decades(std::iter::once(axis));
    let drawing = allan_plot::panel(&without_arches(axis), id, "", decades, &PAGE);
    let readings = logarithmic(decades, allan_plot::LAYOUT, ["tau in s", "deviation"]);
    figure(
        id,
        "Allan deviation",
        allan_plot::LAYOUT,
        &readings,
        &drawing,
    )
}

/// The axis without a published fit that has holes. It weighs all averaging times alike, so on a record that
/// is short yet its sum of squares falls below zero, and what is left of the curve are arches that stray
/// through the picture. A report of the whole record shows them as they are.
fn without_arches(axis: &AxisAnalysis) -> Cow<'_, AxisAnalysis> {
    if axis.curves.iter().all(|model| model.published.is_some()) {
        return Cow::Borrowed(axis);
    }
    let mut axis = axis.clone();
    for model in &mut axis.curves {
        model.published = None;
    }
    Cow::Owned(axis)
}

/// The spectrum of an axis; `id` is unique within the page.
pub fn spectrum(axis: &AxisAnalysis, id: &str) -> String {
    let decades = spectrum_plot::decades(std::iter::once(axis));
    let drawing = spectrum_plot::panel(axis, id, "", decades, &PAGE);
    let readings = logarithmic(
        decades,
        spectrum_plot::LAYOUT,
        ["frequency in Hz", "density"],
    );
    figure(id, "spectrum", spectrum_plot::LAYOUT, &readings, &drawing)
}

/// The last seconds of an axis; nothing where there are no samples. `id` is unique within the page.
pub fn recent(axis: &Recent<'_>, id: &str) -> String {
    let Some((from, to)) = ends(axis.points.iter().map(|point| point.0)) else {
        return String::new();
    };
    let values = axis.points.iter().flat_map(|point| [point.1, point.2]);
    let Some((low, high)) = ends(values) else {
        return String::new();
    };
    let room = (MARGIN * (high - low))
        .max(f64::EPSILON * high.abs())
        .max(f64::MIN_POSITIVE);
    let [x, y] = [(from, to.max(from + 1.0)), (low - room, high + room)];
    let titles = Titles {
        x: Title::new("time", "s"),
        y: Title::new("signal", escape(&typeset(axis.unit))),
        ..Titles::default()
    };
    let mut frame = Frame::new(
        id,
        &PAGE,
        STRIP,
        titles,
        (
            |pixels| Scale::linear(x, pixels),
            |pixels| Scale::linear(y, pixels),
        ),
    );
    let colour = PAGE.measured;
    frame.band(Field::Main, &axis.points, colour, BETWEEN);
    let middle = axis
        .points
        .iter()
        .map(|&(t_s, least, most)| (t_s, 0.5 * (least + most)));
    frame.line(Field::Main, middle, Stroke::solid(colour, 1.0));
    let readings = [(x, false, "time in s"), (y, false, "signal")];
    let readings = read(readings, STRIP);
    figure(id, "last seconds", STRIP, &readings, &frame.finish())
}

fn ends(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |ends: Option<(f64, f64)>, one| {
        let (low, high) = ends.unwrap_or((one, one));
        Some((low.min(one), high.max(one)))
    })
}

fn logarithmic([x, y]: [(f64, f64); 2], layout: Layout, names: [&str; 2]) -> [Reading; 2] {
    read([(x, true, names[0]), (y, true, names[1])], layout)
}

fn read([x, y]: [((f64, f64), bool, &str); 2], layout: Layout) -> [Reading; 2] {
    let (top, bottom) = layout.main();
    [(x, (LEFT, RIGHT)), (y, (bottom, top))].map(|((ends, log, name), pixels)| Reading {
        log,
        ends,
        pixels,
        name: name.to_owned(),
    })
}

fn figure(id: &str, label: &str, layout: Layout, [x, y]: &[Reading; 2], drawing: &str) -> String {
    let mut figure = format!(
        "<figure id=\"figure-{id}\" tabindex=\"0\"{}{}>",
        x.attributes("x"),
        y.attributes("y")
    );
    // Writing to a string cannot fail.
    let _ = page::picture(&mut figure, (WIDTH, layout.height), label, drawing);
    figure + "<figcaption class=\"readout\"></figcaption></figure>"
}
