//! The strip below the Allan plot: how far the measurement lies from the fit.

use std::fmt::{Result, Write};

use super::allan_plot::{LEFT, Plot, RIGHT, STRIP, fitted_by};
use super::svg::Theme;

/// Degrees of freedom from which a point has a say in the scale of the strip.
const SCALING_EDF: f64 = 10.0;

impl Plot<'_> {
    /// Measured over fitted, minus one, in percent.
    pub(super) fn strip(&self, svg: &mut String) -> Result {
        let Theme {
            ink,
            faint,
            fitted,
            measured,
            ..
        } = self.theme;
        let residuals: Vec<_> = self
            .axis
            .allan
            .iter()
            .zip(&self.axis.curves)
            .filter_map(|(point, model)| {
                let expected = model.fitted?;
                let percent = |value: f64| 100.0 * (value / expected - 1.0);
                Some((
                    point,
                    percent(point.lo),
                    percent(point.adev),
                    percent(point.hi),
                ))
            })
            .collect();
        let largest = residuals
            .iter()
            .filter(|(point, ..)| point.edf >= SCALING_EDF)
            .map(|(_, _, percent, _)| percent.abs())
            .fold(0.0_f64, f64::max);
        let limit = [2.0, 5.0, 10.0, 20.0, 50.0, 100.0]
            .into_iter()
            .find(|&limit| limit >= 1.1 * largest)
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
        for (point, lo, mid, hi) in residuals {
            let x = self.x.at(point.tau_s);
            write!(
                svg,
                "<path d=\"M{x:.1} {:.1}V{:.1}\" stroke=\"{measured}\" stroke-opacity=\"0.45\"/>\
                 <circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"2\" fill=\"{measured}\"/>",
                at(lo),
                at(hi),
                at(mid)
            )?;
        }
        write!(svg, "</g>")?;
        for (value, dy) in [(limit, 8.0), (0.0, 4.0), (-limit, 0.0)] {
            let sign = if value > 0.0 {
                "+"
            } else if value < 0.0 {
                "\u{2212}"
            } else {
                ""
            };
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
            "<text x=\"{}\" y=\"{}\" fill=\"{ink}\">measured over {}, percent</text>",
            LEFT + 8.0,
            STRIP.0 + 15.0,
            fitted_by(self.axis)
        )
    }
}
