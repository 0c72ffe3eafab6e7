//! The spectrum of one axis: measured density with its 95 % band, what the likelihood fit expects
//! of it and what each term adds, and below it the measured over the expected density.

use super::allan_plot::term_stroke;
use super::plot::Stroke;
use super::plot::frame::{Field, Frame, Layout, Title, Titles};
use super::plot::legend::Mark;
use super::plot::ratio::{self, Compared};
use super::plot::scale::Scale;
use super::svg::{Theme, escape, squared, typeset};
use super::verdict;
use crate::analyse::AxisAnalysis;
use crate::bins::point;
use crate::fit::likelihood::components::SEEN;
use crate::numeric::order::quantile;
use crate::spectrum::pool;

/// Height of the picture, pixels.
pub const HEIGHT: f64 = 480.0;

/// Degrees of freedom that a plotted point has at least: bins with less are drawn as their mean.
const LEAST_EDF: f64 = 8.0;

/// Decades left free on either side of the frequencies.
const MARGIN: f64 = 0.1;

/// Decades below the highest density that are shown at most.
const MOST_DECADES: f64 = 14.0;

/// Opacity of the measured band.
pub(super) const BAND: f64 = 0.2;

/// Where spectra are drawn.
pub(super) const LAYOUT: Layout = Layout {
    height: HEIGHT,
    strip: true,
};

/// Decades that the spectra of `axes` cover, in frequency and (whole ones) in density.
pub fn decades<'a>(axes: impl Iterator<Item = &'a AxisAnalysis>) -> [(f64, f64); 2] {
    let spots = axes.flat_map(spots);
    decades_of(spots.map(|spot| (spot.x, spot.measured)))
}

/// Decades that these frequencies and densities cover.
pub(super) fn decades_of(points: impl Iterator<Item = (f64, f64)>) -> [(f64, f64); 2] {
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 2];
    for (f_hz, psd) in points.filter(|(_, psd)| *psd > 0.0) {
        for (range, value) in range.iter_mut().zip([f_hz, psd]) {
            *range = (range.0.min(value.log10()), range.1.max(value.log10()));
        }
    }
    let [(from, to), (low, high)] = range;
    if from > to {
        return [(0.0, 1.0); 2];
    }
    let high = high.ceil();
    [
        (from - MARGIN, to + MARGIN),
        (low.floor().clamp(high - MOST_DECADES, high - 1.0), high),
    ]
}

/// Titles of a spectrum of a signal in `unit`.
pub(super) fn titles(head: &str, unit: &str, strip: &str) -> Titles {
    let squared = escape(&squared(&typeset(unit)));
    Titles {
        head: escape(head),
        x: Title::new("frequency", "Hz"),
        y: Title::new("two-sided density", format!("{squared}/Hz")),
        strip: Title::new(strip, "percent"),
    }
}

/// The picture of `axis` as SVG elements, headed `head`; `id` is unique within the document.
pub fn panel(
    axis: &AxisAnalysis,
    id: &str,
    head: &str,
    [f_hz, density]: [(f64, f64); 2],
    theme: &Theme,
) -> String {
    let titles = titles(head, axis.unit.symbol(), "measured over fitted density");
    let mut frame = Frame::new(
        id,
        theme,
        LAYOUT,
        titles,
        (
            |pixels| Scale::log(f_hz, pixels),
            |pixels| Scale::log(density, pixels),
        ),
    );
    let spots = spots(axis);
    terms(&mut frame, axis);
    measured(&mut frame, &spots);
    if axis.fits.likelihood.is_some() {
        let fit = Stroke::solid(theme.fitted, 1.8);
        let curve = spots.iter().map(|spot| (spot.x, spot.expected));
        frame.line(Field::Main, curve, fit);
        frame.explain(Mark::Line(fit), "likelihood fit");
    }
    for coefficient in SEEN {
        if verdict::drawn(axis, coefficient).is_some() {
            frame.explain(Mark::Line(term_stroke(coefficient)), coefficient.symbol());
        }
    }
    let expected: Vec<Compared> = spots
        .into_iter()
        .filter(|spot| spot.expected > 0.0)
        .collect();
    ratio::open(&mut frame, typical_limit(&expected));
    ratio::points(&mut frame, &expected, 1.6);
    frame.finish()
}

/// The measured spectrum with its band.
pub(super) fn measured(frame: &mut Frame<'_>, spots: &[Compared]) {
    let stroke = Stroke::solid(frame.theme().measured, 1.1);
    let band: Vec<_> = spots
        .iter()
        .map(|spot| (spot.x, spot.lo, spot.hi))
        .collect();
    frame.band(Field::Main, &band, stroke.colour, BAND);
    let curve = spots.iter().map(|spot| (spot.x, spot.measured));
    frame.line(Field::Main, curve, stroke);
    frame.explain(Mark::LineOnBand(stroke, BAND), "measured, 95 %");
}

/// The limit of a strip as far as the typical interval reaches: the lowest frequencies may leave
/// the field.
pub(super) fn typical_limit(spots: &[Compared]) -> f64 {
    let mut sizes: Vec<f64> = spots.iter().map(Compared::reach).collect();
    ratio::limit(quantile(&mut sizes, 0.75).unwrap_or(0.0))
}

/// What each term that was resolved from zero adds.
fn terms(frame: &mut Frame<'_>, axis: &AxisAnalysis) {
    let Some(fit) = &axis.fits.likelihood else {
        return;
    };
    for (coefficient, part) in SEEN.into_iter().zip(&fit.parts) {
        if verdict::drawn(axis, coefficient).is_some() {
            let curve = axis.spectrum.iter().zip(part);
            let curve = curve.filter(|(_, density)| **density > 0.0);
            let curve = curve.map(|(bin, density)| (bin.f_hz, *density));
            frame.line(Field::Main, curve, term_stroke(coefficient));
        }
    }
}

/// Neighbouring bins as one point; nothing is expected (NaN) where there is no fit.
fn spots(axis: &AxisAnalysis) -> Vec<Compared> {
    let expected = axis.fits.likelihood.as_ref().map(|fit| fit.expected());
    pool::runs(axis.spectrum.iter().map(|bin| bin.edf), LEAST_EDF)
        .into_iter()
        .map(|(bins, edf)| {
            let mean = |value: &dyn Fn(usize) -> f64| {
                let parts = bins.clone().map(|b| axis.spectrum[b].edf * value(b));
                parts.sum::<f64>() / edf
            };
            let psd = mean(&|b| axis.spectrum[b].psd);
            let (lo, hi) = point::interval(psd, edf);
            Compared {
                x: mean(&|b| axis.spectrum[b].f_hz),
                measured: psd,
                lo: lo * lo,
                hi: hi * hi,
                expected: expected
                    .as_ref()
                    .map_or(f64::NAN, |expected| mean(&|b| expected[b])),
            }
        })
        .collect()
}
