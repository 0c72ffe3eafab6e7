//! The spectrum of one axis: measured density with its 95 % band, what the likelihood fit expects
//! of it and what each term adds, and below it the measured over the expected density.

use std::fmt::{Result, Write};

use super::allan_plot::{LEFT, RIGHT, WIDTH, term_colour};
use super::svg::{LogScale, Theme, escape, path, power_of_ten, typeset};
use super::verdict;
use crate::analyse::AxisAnalysis;
use crate::bins::point;
use crate::fit::likelihood::components::SEEN;

/// Height of a panel, pixels.
pub const HEIGHT: f64 = 480.0;

const TOP: f64 = 34.0;
const BOTTOM: f64 = 312.0;
const STRIP: (f64, f64) = (338.0, 428.0);

/// Degrees of freedom that a plotted point has at least: bins with less are drawn as their mean.
const LEAST_EDF: f64 = 8.0;

/// Decades left free beside the frequencies.
const MARGIN: f64 = 0.1;

/// Decades below the highest density that are shown at most.
const MOST_DECADES: f64 = 14.0;

/// Neighbouring bins as one point.
struct Spot {
    f_hz: f64,
    psd: f64,
    lo: f64,
    hi: f64,
    expected: Option<f64>,
}

/// Decades that the spectra of `axes` cover, in frequency and (whole ones) in density.
pub fn decades<'a>(axes: impl Iterator<Item = &'a AxisAnalysis>) -> [(f64, f64); 2] {
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 2];
    for spot in axes.flat_map(spots).filter(|spot| spot.psd > 0.0) {
        for (range, value) in range.iter_mut().zip([spot.f_hz, spot.psd]) {
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

/// The panel of `axis` as an SVG group; `id` is unique within the document.
pub fn panel(axis: &AxisAnalysis, id: &str, decades: [(f64, f64); 2], theme: &Theme) -> String {
    let plot = Plot {
        axis,
        spots: spots(axis),
        id,
        theme,
        x: LogScale {
            decades: decades[0],
            pixels: (LEFT, RIGHT),
        },
        y: LogScale {
            decades: decades[1],
            pixels: (BOTTOM, TOP),
        },
    };
    let mut svg = String::new();
    // Writing to a string cannot fail.
    let _ = plot.draw(&mut svg);
    svg
}

fn spots(axis: &AxisAnalysis) -> Vec<Spot> {
    let expected = axis.fits.likelihood.as_ref().map(|fit| fit.expected());
    let mut spots = Vec::new();
    let mut first = 0;
    let mut edf = 0.0;
    for (last, bin) in axis.spectrum.iter().enumerate() {
        edf += bin.edf;
        if edf < LEAST_EDF && last + 1 < axis.spectrum.len() {
            continue;
        }
        let bins = &axis.spectrum[first..=last];
        let mean = |value: &dyn Fn(usize) -> f64| {
            let parts = bins.iter().enumerate();
            parts
                .map(|(i, bin)| bin.edf * value(first + i))
                .sum::<f64>()
                / edf
        };
        let psd = mean(&|b| axis.spectrum[b].psd);
        let (lo, hi) = point::interval(psd, edf);
        spots.push(Spot {
            f_hz: mean(&|b| axis.spectrum[b].f_hz),
            psd,
            lo: lo * lo,
            hi: hi * hi,
            expected: expected.as_ref().map(|expected| mean(&|b| expected[b])),
        });
        (first, edf) = (last + 1, 0.0);
    }
    spots
}

/// A unit squared, as it is typeset.
fn squared(unit: &str) -> String {
    if unit.chars().all(char::is_alphabetic) {
        format!("{unit}\u{b2}")
    } else {
        format!("({unit})\u{b2}")
    }
}

struct Plot<'a> {
    axis: &'a AxisAnalysis,
    spots: Vec<Spot>,
    id: &'a str,
    theme: &'a Theme,
    x: LogScale,
    y: LogScale,
}

impl Plot<'_> {
    fn draw(&self, svg: &mut String) -> Result {
        let Theme { paper, fitted, .. } = self.theme;
        let id = self.id;
        write!(
            svg,
            "<clipPath id=\"{id}-a\"><rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{w}\" height=\"{h}\"/></clipPath>\
             <clipPath id=\"{id}-b\"><rect x=\"{LEFT}\" y=\"{top}\" width=\"{w}\" height=\"{strip}\"/></clipPath>\
             <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"{paper}\"/>",
            w = RIGHT - LEFT,
            h = BOTTOM - TOP,
            top = STRIP.0,
            strip = STRIP.1 - STRIP.0,
        )?;
        self.grid(svg)?;
        write!(svg, "<g clip-path=\"url(#{id}-a)\">")?;
        self.terms(svg)?;
        self.measured(svg)?;
        let curve = self.spots.iter().filter_map(|spot| {
            let expected = spot.expected.filter(|expected| *expected > 0.0)?;
            Some((self.x.at(spot.f_hz), self.y.at(expected)))
        });
        write!(
            svg,
            "<path d=\"{}\" fill=\"none\" stroke=\"{fitted}\" stroke-width=\"1.8\"/></g>",
            path(curve)
        )?;
        self.legend(svg)?;
        self.strip(svg)
    }

    fn grid(&self, svg: &mut String) -> Result {
        let Theme {
            ink, faint, grid, ..
        } = self.theme;
        for exponent in self.x.powers() {
            let x = self.x.at(10_f64.powi(exponent));
            write!(
                svg,
                "<path d=\"M{x:.1} {TOP}V{BOTTOM}M{x:.1} {}V{}\" stroke=\"{grid}\"/>\
                 <text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\" fill=\"{faint}\">{}</text>",
                STRIP.0,
                STRIP.1,
                STRIP.1 + 17.0,
                power_of_ten(exponent)
            )?;
        }
        for exponent in self.y.powers() {
            let y = self.y.at(10_f64.powi(exponent));
            write!(
                svg,
                "<path d=\"M{LEFT} {y:.1}H{RIGHT}\" stroke=\"{grid}\"/>\
                 <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"{faint}\">{}</text>",
                LEFT - 7.0,
                y + 4.0,
                power_of_ten(exponent)
            )?;
        }
        write!(
            svg,
            "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{w}\" height=\"{}\" fill=\"none\" stroke=\"{faint}\"/>\
             <rect x=\"{LEFT}\" y=\"{}\" width=\"{w}\" height=\"{}\" fill=\"none\" stroke=\"{faint}\"/>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"{ink}\">frequency, Hz</text>\
             <text transform=\"translate(17 {}) rotate(-90)\" text-anchor=\"middle\" fill=\"{ink}\">\
             two-sided density, {}/Hz</text>",
            BOTTOM - TOP,
            STRIP.0,
            STRIP.1 - STRIP.0,
            0.5 * (LEFT + RIGHT),
            HEIGHT - 12.0,
            0.5 * (TOP + BOTTOM),
            escape(&squared(&typeset(self.axis.unit.symbol()))),
            w = RIGHT - LEFT,
        )
    }

    /// What each term that was told from zero adds.
    fn terms(&self, svg: &mut String) -> Result {
        let Some(fit) = &self.axis.fits.likelihood else {
            return Ok(());
        };
        for (coefficient, part) in SEEN.into_iter().zip(&fit.parts) {
            if verdict::drawn(self.axis, coefficient).is_none() {
                continue;
            }
            let curve = self.axis.spectrum.iter().zip(part);
            let curve = curve.filter(|(_, density)| **density > 0.0);
            write!(
                svg,
                "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.4\" \
                 stroke-dasharray=\"5 4\"/>",
                path(curve.map(|(bin, density)| (self.x.at(bin.f_hz), self.y.at(*density)))),
                term_colour(coefficient)
            )?;
        }
        Ok(())
    }

    fn measured(&self, svg: &mut String) -> Result {
        let Theme { measured, .. } = self.theme;
        let bounded = |value: f64| value.clamp(1e-300, 1e300);
        let at = |spot: &Spot, value: f64| (self.x.at(spot.f_hz), self.y.at(bounded(value)));
        let band = self
            .spots
            .iter()
            .map(|spot| at(spot, spot.hi))
            .chain(self.spots.iter().rev().map(|spot| at(spot, spot.lo)));
        write!(
            svg,
            "<path d=\"{}Z\" fill=\"{measured}\" fill-opacity=\"0.2\"/>\
             <path d=\"{}\" fill=\"none\" stroke=\"{measured}\" stroke-width=\"1.1\"/>",
            path(band),
            path(self.spots.iter().map(|spot| at(spot, spot.psd)))
        )
    }

    /// Measured over expected density, minus one, in percent.
    fn strip(&self, svg: &mut String) -> Result {
        let Theme {
            ink,
            faint,
            fitted,
            measured,
            ..
        } = self.theme;
        let residuals: Vec<_> = self
            .spots
            .iter()
            .filter_map(|spot| {
                let expected = spot.expected.filter(|expected| *expected > 0.0)?;
                let percent = |value: f64| 100.0 * (value / expected - 1.0);
                Some((spot, percent(spot.lo), percent(spot.psd), percent(spot.hi)))
            })
            .collect();
        // As far as the typical interval reaches: the lowest frequencies may leave the frame.
        let mut sizes: Vec<f64> = residuals
            .iter()
            .map(|(_, lo, _, hi)| hi.abs().max(lo.abs()))
            .collect();
        sizes.sort_by(f64::total_cmp);
        let typical = sizes.get(3 * sizes.len() / 4).copied().unwrap_or(0.0);
        let limit = [2.0, 5.0, 10.0, 20.0, 50.0, 100.0]
            .into_iter()
            .find(|&limit| limit >= 1.1 * typical)
            .unwrap_or(200.0);
        let middle = 0.5 * (STRIP.0 + STRIP.1);
        let at =
            |percent: f64| middle - 0.5 * (STRIP.1 - STRIP.0) * (percent / limit).clamp(-9.0, 9.0);
        write!(
            svg,
            "<g clip-path=\"url(#{}-b)\"><path d=\"M{LEFT} {middle}H{RIGHT}\" stroke=\"{fitted}\" \
             stroke-width=\"1.4\"/>",
            self.id
        )?;
        for (spot, lo, mid, hi) in residuals {
            let x = self.x.at(spot.f_hz);
            write!(
                svg,
                "<path d=\"M{x:.1} {:.1}V{:.1}\" stroke=\"{measured}\" stroke-opacity=\"0.35\"/>\
                 <circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"1.6\" fill=\"{measured}\"/>",
                at(lo),
                at(hi),
                at(mid)
            )?;
        }
        write!(svg, "</g>")?;
        for (value, dy) in [(limit, 8.0), (0.0, 4.0), (-limit, 0.0)] {
            let sign =
                ["\u{2212}", "", "+"][(1.0 + value.signum() * f64::from(value != 0.0)) as usize];
            write!(
                svg,
                "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"{faint}\">{sign}{}</text>",
                LEFT - 7.0,
                at(value) + dy,
                value.abs()
            )?;
        }
        write!(
            svg,
            "<text x=\"{}\" y=\"{}\" fill=\"{ink}\">measured over fitted density, percent</text>",
            LEFT + 8.0,
            STRIP.0 + 15.0
        )
    }

    fn legend(&self, svg: &mut String) -> Result {
        let Theme {
            ink,
            measured,
            fitted,
            ..
        } = self.theme;
        let y = TOP - 12.0;
        write!(
            svg,
            "<rect x=\"178\" y=\"{}\" width=\"24\" height=\"11\" fill=\"{measured}\" \
             fill-opacity=\"0.2\"/><path d=\"M178 {line}h24\" stroke=\"{measured}\" \
             stroke-width=\"1.1\"/><text x=\"208\" y=\"{y}\" fill=\"{ink}\">spectrum, 95 % band</text>",
            y - 9.5,
            line = y - 4.0,
        )?;
        if self.axis.fits.likelihood.is_none() {
            return Ok(());
        }
        write!(
            svg,
            "<path d=\"M362 {line}h24\" stroke=\"{fitted}\" stroke-width=\"1.8\"/>\
             <text x=\"392\" y=\"{y}\" fill=\"{ink}\">likelihood fit</text>",
            line = y - 4.0,
        )?;
        let mut x = 500.0;
        for coefficient in SEEN {
            if verdict::drawn(self.axis, coefficient).is_none() {
                continue;
            }
            write!(
                svg,
                "<path d=\"M{x} {}h18\" stroke=\"{}\" stroke-width=\"1.4\" stroke-dasharray=\"5 4\"/>\
                 <text x=\"{}\" y=\"{y}\" fill=\"{ink}\">{}</text>",
                y - 4.0,
                term_colour(coefficient),
                x + 23.0,
                coefficient.symbol()
            )?;
            x += 48.0;
        }
        Ok(())
    }
}
