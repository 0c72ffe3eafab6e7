//! The Allan plot of one axis: measured deviation with its 95 % band, the fits and their terms,
//! and below it how far the measurement lies from the fit.

use std::fmt::{Result, Write};

use super::svg::{LogScale, Theme, escape, path, power_of_ten, typeset};
use super::verdict;
use crate::analyse::{AxisAnalysis, CurveModel, CurvePoint};
use crate::model::Coefficient;

/// Size of a panel, pixels.
pub const WIDTH: f64 = 760.0;
/// Size of a panel, pixels.
pub const HEIGHT: f64 = 560.0;

pub(super) const LEFT: f64 = 64.0;
pub(super) const RIGHT: f64 = WIDTH - 18.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 392.0;
/// The strip of residuals.
pub(super) const STRIP: (f64, f64) = (418.0, 508.0);

/// Decades left free on either side of the averaging times.
const MARGIN: f64 = 0.15;

/// Colours of the five terms, told apart by colour-blind eyes too (Okabe and Ito 2008).
pub(super) const fn term_colour(coefficient: Coefficient) -> &'static str {
    match coefficient {
        Coefficient::Q => "#cc79a7",
        Coefficient::N => "#009e73",
        Coefficient::B => "#c98a00",
        Coefficient::K => "#3d9bd6",
        Coefficient::R => "#8a8f98",
    }
}

/// Name of the fit that is drawn.
pub(super) const fn fitted_by(axis: &AxisAnalysis) -> &'static str {
    match axis.fits.likelihood {
        Some(_) => "likelihood fit",
        None => "weighted fit",
    }
}

/// Decades that the curves of `axes` cover, in tau and (whole ones) in deviation.
pub fn decades<'a>(axes: impl Iterator<Item = &'a AxisAnalysis>) -> [(f64, f64); 2] {
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 2];
    for point in axes
        .flat_map(|axis| &axis.allan)
        .filter(|point| point.adev > 0.0)
    {
        for (range, value) in range.iter_mut().zip([point.tau_s, point.adev]) {
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

/// The panel of `axis` as an SVG group; `id` is unique within the document.
pub fn panel(axis: &AxisAnalysis, id: &str, decades: [(f64, f64); 2], theme: &Theme) -> String {
    let plot = Plot {
        axis,
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

/// What the parts of a panel need to draw themselves.
pub(super) struct Plot<'a> {
    pub(super) axis: &'a AxisAnalysis,
    pub(super) id: &'a str,
    pub(super) theme: &'a Theme,
    pub(super) x: LogScale,
    y: LogScale,
}

impl Plot<'_> {
    fn draw(&self, svg: &mut String) -> Result {
        let paper = self.theme.paper;
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
        self.fits(svg)?;
        write!(svg, "</g>")?;
        self.labels(svg)?;
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
             <text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"{ink}\">averaging time, s</text>\
             <text transform=\"translate(17 {}) rotate(-90)\" text-anchor=\"middle\" fill=\"{ink}\">\
             Allan deviation, {}</text>",
            BOTTOM - TOP,
            STRIP.0,
            STRIP.1 - STRIP.0,
            0.5 * (LEFT + RIGHT),
            HEIGHT - 12.0,
            0.5 * (TOP + BOTTOM),
            escape(&typeset(self.axis.unit.symbol())),
            w = RIGHT - LEFT,
        )
    }

    /// The straight lines of eq. 8 for the coefficients that were told from zero.
    fn terms(&self, svg: &mut String) -> Result {
        for (coefficient, line) in self.lines() {
            write!(
                svg,
                "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.4\" \
                 stroke-dasharray=\"5 4\"/>",
                path(line),
                term_colour(coefficient)
            )?;
        }
        Ok(())
    }

    fn lines(&self) -> Vec<(Coefficient, [(f64, f64); 2])> {
        let line = |coefficient: Coefficient| {
            let term = coefficient.term(verdict::drawn(self.axis, coefficient)?);
            let ends = [self.x.decades.0, self.x.decades.1].map(|decade| 10_f64.powf(decade));
            let at = |tau_s| {
                (
                    self.x.at(tau_s),
                    self.y.at(term.allan_asymptote(tau_s).sqrt()),
                )
            };
            Some((coefficient, ends.map(at)))
        };
        Coefficient::ALL.into_iter().filter_map(line).collect()
    }

    /// Each term's letter where its line leaves the frame.
    fn labels(&self, svg: &mut String) -> Result {
        let paper = if self.theme.paper == "none" {
            "var(--paper)"
        } else {
            self.theme.paper
        };
        for (coefficient, [(x0, y0), (x1, y1)]) in self.lines() {
            let slope = (y1 - y0) / (x1 - x0);
            // Along the line, from whichever end rises out of the frame.
            let inside = |x: f64| y0 + slope * (x - x0);
            let (mut x, step) = if slope > 0.5 {
                (LEFT + 26.0, 3.0)
            } else {
                (RIGHT - 26.0, -3.0)
            };
            while !(TOP + 16.0..=BOTTOM - 12.0).contains(&inside(x)) {
                x += step;
                if !(LEFT..=RIGHT).contains(&x) {
                    break;
                }
            }
            if !(LEFT..=RIGHT).contains(&x) {
                continue;
            }
            write!(
                svg,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-weight=\"bold\" \
                 fill=\"{}\" stroke=\"{paper}\" stroke-width=\"4\" paint-order=\"stroke\">{}</text>",
                inside(x) + 4.5,
                term_colour(coefficient),
                coefficient.symbol()
            )?;
        }
        Ok(())
    }

    fn points(&self) -> impl Iterator<Item = &CurvePoint> {
        self.axis.allan.iter().filter(|point| point.adev > 0.0)
    }

    fn measured(&self, svg: &mut String) -> Result {
        let Theme { measured, .. } = self.theme;
        // Ends of intervals may lie far outside: the frame cuts them.
        let bounded = |value: f64| value.clamp(1e-300, 1e300);
        let upper = self
            .points()
            .map(|p| (self.x.at(p.tau_s), self.y.at(bounded(p.hi))));
        let lower: Vec<_> = self
            .points()
            .map(|p| (self.x.at(p.tau_s), self.y.at(bounded(p.lo))))
            .collect();
        let band = path(upper.chain(lower.into_iter().rev()));
        write!(
            svg,
            "<path d=\"{band}Z\" fill=\"{measured}\" fill-opacity=\"0.16\"/>"
        )?;
        let curve = path(
            self.points()
                .map(|p| (self.x.at(p.tau_s), self.y.at(p.adev))),
        );
        write!(
            svg,
            "<path d=\"{curve}\" fill=\"none\" stroke=\"{measured}\" stroke-width=\"1\"/>"
        )?;
        for point in self.points() {
            write!(
                svg,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.3\" fill=\"{measured}\"/>",
                self.x.at(point.tau_s),
                self.y.at(point.adev)
            )?;
        }
        Ok(())
    }

    fn fits(&self, svg: &mut String) -> Result {
        let Theme { faint, fitted, .. } = self.theme;
        let curve = |value: &dyn Fn(&CurveModel) -> Option<f64>| {
            // Where the square is negative the curve has a hole.
            let pieces = self.axis.curves.split(|model| value(model).is_none());
            let piece = |models: &[CurveModel]| {
                path(models.iter().filter_map(|model| {
                    value(model).map(|deviation| (self.x.at(model.tau_s), self.y.at(deviation)))
                }))
            };
            pieces.map(piece).collect::<String>()
        };
        write!(
            svg,
            "<path d=\"{}\" fill=\"none\" stroke=\"{faint}\" stroke-width=\"1.6\" \
             stroke-dasharray=\"1.5 3.5\" stroke-linecap=\"round\"/>\
             <path d=\"{}\" fill=\"none\" stroke=\"{fitted}\" stroke-width=\"1.8\"/>",
            curve(&|model| model.published),
            curve(&|model| model.fitted)
        )
    }

    fn legend(&self, svg: &mut String) -> Result {
        let Theme {
            ink,
            faint,
            measured,
            fitted,
            ..
        } = self.theme;
        let y = TOP - 12.0;
        let entry = |svg: &mut String, x: f64, text: &str, mark: String| {
            write!(
                svg,
                "{mark}<text x=\"{}\" y=\"{y}\" fill=\"{ink}\">{text}</text>",
                x + 30.0
            )
        };
        let line = |x: f64, style: String| {
            format!("<path d=\"M{x} {0}h24\" fill=\"none\" {style}/>", y - 4.0)
        };
        entry(
            svg,
            178.0,
            "measured, 95 % band",
            format!(
                "<rect x=\"178\" y=\"{}\" width=\"24\" height=\"11\" fill=\"{measured}\" \
                 fill-opacity=\"0.16\"/><circle cx=\"190\" cy=\"{}\" r=\"2.6\" fill=\"{measured}\"/>",
                y - 9.5,
                y - 4.0
            ),
        )?;
        entry(
            svg,
            362.0,
            fitted_by(self.axis),
            line(362.0, format!("stroke=\"{fitted}\" stroke-width=\"1.8\"")),
        )?;
        entry(
            svg,
            490.0,
            "its terms",
            line(
                490.0,
                format!(
                    "stroke=\"{}\" stroke-width=\"1.4\" stroke-dasharray=\"5 4\"",
                    term_colour(Coefficient::N)
                ),
            ),
        )?;
        entry(
            svg,
            598.0,
            "published fit",
            line(
                598.0,
                format!(
                    "stroke=\"{faint}\" stroke-width=\"1.6\" stroke-dasharray=\"1.5 3.5\" stroke-linecap=\"round\""
                ),
            ),
        )
    }
}
