//! The Allan plot of one axis: measured deviation with its 95 % band, the fits and their terms,
//! and below it how far the measurement lies from the fit.

use super::plot::Stroke;
use super::plot::frame::{Field, Frame, LEFT, Layout, RIGHT, TOP, Title, Titles};
use super::plot::legend::Mark;
use super::plot::ratio::{self, Compared};
use super::plot::scale::Scale;
use super::svg::{Theme, escape, typeset};
use super::verdict;
use crate::analyse::{AxisAnalysis, CurveModel, CurvePoint};
use crate::model::Coefficient;

/// Height of the picture, pixels.
pub const HEIGHT: f64 = 560.0;

pub(super) const LAYOUT: Layout = Layout {
    height: HEIGHT,
    strip: true,
};

/// Decades left free on either side of the averaging times.
const MARGIN: f64 = 0.15;

/// Degrees of freedom from which a point has a say in the scale of the strip.
const SCALING_EDF: f64 = 10.0;

/// Opacity of the measured band.
const BAND: f64 = 0.16;

/// Colours of the five terms, distinguished by colour-blind eyes too (Okabe and Ito 2008).
pub(super) const fn term_colour(coefficient: Coefficient) -> &'static str {
    match coefficient {
        Coefficient::Q => "#cc79a7",
        Coefficient::N => "#009e73",
        Coefficient::B => "#c98a00",
        Coefficient::K => "#3d9bd6",
        Coefficient::R => "#8a8f98",
    }
}

/// How a term is drawn.
pub(super) const fn term_stroke(coefficient: Coefficient) -> Stroke {
    Stroke::dashed(term_colour(coefficient), 1.4, "5 4")
}

/// Name of the fit that is drawn.
const fn fitted_by(axis: &AxisAnalysis) -> &'static str {
    match axis.fits.likelihood {
        Some(_) => "likelihood fit",
        None => "weighted fit",
    }
}

/// Decades that the curves of `axes` cover, in tau and (whole ones) in deviation.
pub fn decades<'a>(axes: impl Iterator<Item = &'a AxisAnalysis>) -> [(f64, f64); 2] {
    let points = axes.flat_map(|axis| &axis.allan);
    decades_of(points.map(|point| (point.tau_s, point.adev)))
}

/// Decades that curves through these averaging times and deviations cover.
pub(super) fn decades_of(points: impl Iterator<Item = (f64, f64)>) -> [(f64, f64); 2] {
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 2];
    for (tau_s, adev) in points.filter(|(_, adev)| *adev > 0.0) {
        for (range, value) in range.iter_mut().zip([tau_s, adev]) {
            *range = (range.0.min(value.log10()), range.1.max(value.log10()));
        }
    }
    let [(from, to), (low, high)] = range;
    if from > to {
        return [(0.0, 1.0); 2];
    }
    [
        (from - MARGIN, to + MARGIN),
        (low.floor(), high.ceil().max(low.floor() + 1.0)),
    ]
}

/// The picture of `axis` as SVG elements, headed `head`; `id` is unique within the document.
pub fn panel(
    axis: &AxisAnalysis,
    id: &str,
    head: &str,
    [tau_s, deviation]: [(f64, f64); 2],
    theme: &Theme,
) -> String {
    let unit = escape(&typeset(axis.unit.symbol()));
    let titles = Titles {
        head: escape(head),
        x: Title::new("averaging time", "s"),
        y: Title::new("Allan deviation", unit),
        strip: Title::new(format!("measured over {}", fitted_by(axis)), "percent"),
    };
    let mut frame = Frame::new(
        id,
        theme,
        LAYOUT,
        titles,
        (
            |pixels| Scale::log(tau_s, pixels),
            |pixels| Scale::log(deviation, pixels),
        ),
    );
    terms(&mut frame, axis);
    measured(&mut frame, axis);
    fits(&mut frame, axis);
    strip(&mut frame, axis);
    frame.finish()
}

/// The straight lines of eq. 8 for the coefficients that were resolved from zero, each with its letter
/// where it leaves the field.
fn terms(frame: &mut Frame<'_>, axis: &AxisAnalysis) {
    let (from, to) = frame.x().ends();
    for coefficient in Coefficient::ALL {
        let Some(value) = verdict::drawn(axis, coefficient) else {
            continue;
        };
        let term = coefficient.term(value);
        let ends = [from, to].map(|tau_s| (tau_s, term.allan_asymptote(tau_s).sqrt()));
        frame.line(Field::Main, ends, term_stroke(coefficient));
        let (y0, y1) = (frame.y().at(ends[0].1), frame.y().at(ends[1].1));
        let Some((x, y)) = letter_place(y0, y1) else {
            continue;
        };
        frame.text(
            x,
            y + 4.5,
            &format!(
                "text-anchor=\"middle\" font-weight=\"bold\" fill=\"{}\"",
                term_colour(coefficient)
            ),
            coefficient.symbol(),
        );
    }
}

/// Where on a line from `y0` on the left to `y1` on the right its letter stands, pixels: from
/// whichever end rises out of the field.
fn letter_place(y0: f64, y1: f64) -> Option<(f64, f64)> {
    let slope = (y1 - y0) / (RIGHT - LEFT);
    let at = |x: f64| y0 + slope * (x - LEFT);
    let (first, step) = if slope > 0.5 {
        (LEFT + 26.0, 3.0)
    } else {
        (RIGHT - 26.0, -3.0)
    };
    let bottom = LAYOUT.main().1;
    (0..)
        .map(|count| first + step * f64::from(count))
        .take_while(|x| (LEFT..=RIGHT).contains(x))
        .find(|&x| (TOP + 16.0..=bottom - 12.0).contains(&at(x)))
        .map(|x| (x, at(x)))
}

fn measured(frame: &mut Frame<'_>, axis: &AxisAnalysis) {
    let colour = frame.theme().measured;
    let points = || axis.allan.iter().filter(|point| point.adev > 0.0);
    let curve = |point: &CurvePoint| (point.tau_s, point.adev);
    let band: Vec<_> = points().map(|p| (p.tau_s, p.lo, p.hi)).collect();
    frame.band(Field::Main, &band, colour, BAND);
    frame.line(Field::Main, points().map(curve), Stroke::solid(colour, 1.0));
    frame.dots(Field::Main, points().map(curve), 2.3, colour);
    frame.explain(Mark::DotOnBand(colour, BAND), "measured, 95 %");
}

fn fits(frame: &mut Frame<'_>, axis: &AxisAnalysis) {
    let Theme { faint, fitted, .. } = *frame.theme();
    let published = Stroke::dashed(faint, 1.6, "1.5 3.5");
    let fit = Stroke::solid(fitted, 1.8);
    // Where the square is negative the curve has a hole.
    let curve = |value: &dyn Fn(&CurveModel) -> Option<f64>| {
        let at = |model: &CurveModel| (model.tau_s, value(model).unwrap_or(f64::NAN));
        axis.curves.iter().map(at).collect::<Vec<_>>()
    };
    let is_published = axis.curves.iter().any(|model| model.published.is_some());
    if is_published {
        frame.line(Field::Main, curve(&|model| model.published), published);
    }
    frame.line(Field::Main, curve(&|model| model.fitted), fit);
    frame.explain(Mark::Line(fit), fitted_by(axis));
    frame.explain(Mark::Line(term_stroke(Coefficient::N)), "its terms");
    if is_published {
        frame.explain(Mark::Line(published), "published fit");
    }
}

/// Measured over fitted, minus one, in percent.
fn strip(frame: &mut Frame<'_>, axis: &AxisAnalysis) {
    let compared = |(point, model): (&CurvePoint, &CurveModel)| {
        let one = Compared {
            x: point.tau_s,
            measured: point.adev,
            lo: point.lo,
            hi: point.hi,
            expected: model.fitted?,
        };
        Some((point.edf, one))
    };
    let all: Vec<(f64, Compared)> = axis
        .allan
        .iter()
        .zip(&axis.curves)
        .filter_map(compared)
        .collect();
    let largest = all
        .iter()
        .filter(|(edf, _)| *edf >= SCALING_EDF)
        .map(|(_, one)| one.off().abs())
        .fold(0.0, f64::max);
    ratio::open(frame, ratio::limit(largest));
    let points: Vec<Compared> = all.into_iter().map(|(_, one)| one).collect();
    ratio::points(frame, &points, 2.0);
}
