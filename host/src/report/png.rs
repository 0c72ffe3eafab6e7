//! The Allan plots and spectra of all axes as one bitmap, drawn from the same SVG as the page's.

use super::allan_plot;
use super::bitmap::{self, PngError};
use super::plot::frame::WIDTH;
use super::spectrum_plot;
use super::svg::LIGHT;
use crate::analyse::Analysis;

/// Axes next to one another at most.
const PER_ROW: usize = 3;

/// The bitmap as the bytes of a PNG file: the axes side by side, with common scales so that they
/// compare.
///
/// # Errors
/// If there is no axis to draw.
pub fn render(analysis: &Analysis) -> Result<Vec<u8>, PngError> {
    let columns = analysis.axes.len().clamp(1, PER_ROW);
    let rows = analysis.axes.len().div_ceil(columns).max(1);
    let decades = allan_plot::decades(analysis.axes.iter());
    let spectra = spectrum_plot::decades(analysis.axes.iter());
    let tall = allan_plot::HEIGHT + spectrum_plot::HEIGHT;
    let panels = analysis.axes.iter().enumerate().map(|(index, axis)| {
        let (x, y) = (
            (index % columns) as f64 * WIDTH,
            (index / columns) as f64 * tall,
        );
        let head = format!("Axis {}", axis.name);
        let allan = allan_plot::panel(axis, &format!("p{index}"), &head, decades, &LIGHT);
        let spectrum = spectrum_plot::panel(axis, &format!("s{index}"), &head, spectra, &LIGHT);
        format!(
            "<g transform=\"translate({x} {y})\">{allan}\
             <g transform=\"translate(0 {})\">{spectrum}</g></g>",
            allan_plot::HEIGHT
        )
    });
    let drawing: String = panels.collect();
    bitmap::render(columns as f64 * WIDTH, rows as f64 * tall, &drawing)
}
