//! The Allan plots and spectra of all axes as one bitmap, drawn from the same SVG as the page's.
//!
//! The typeface (DejaVu Sans) is part of the program, so that a bare machine draws the same.

use std::sync::Arc;

use resvg::{tiny_skia, usvg};

use super::allan_plot::{self, HEIGHT, WIDTH};
use super::spectrum_plot;
use super::svg::{LIGHT, escape};
use crate::analyse::Analysis;

/// Pixels of the bitmap for one of the drawing.
const SCALE: f32 = 1.5;

/// Panels beside one another at most.
const PER_ROW: usize = 3;

/// Why a bitmap could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The drawing is no valid SVG.
    #[error("the plot cannot be drawn")]
    Drawing(#[from] usvg::Error),
    /// The bitmap would have no size, or be too large.
    #[error("a plot of {width} x {height} pixels cannot be made")]
    Size {
        /// Width in pixels.
        width: f32,
        /// Height in pixels.
        height: f32,
    },
    /// The bitmap cannot be encoded.
    #[error("the plot cannot be encoded: {0}")]
    Encoding(String),
}

/// The bitmap as the bytes of a PNG file.
///
/// # Errors
/// If there is no axis to draw.
pub fn render(analysis: &Analysis) -> Result<Vec<u8>, PngError> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    let options = usvg::Options {
        fontdb: Arc::new(fonts),
        font_family: "DejaVu Sans".into(),
        ..Default::default()
    };
    let tree = usvg::Tree::from_str(&drawing(analysis), &options)?;
    let size = tree.size();
    let (width, height) = (size.width() * SCALE, size.height() * SCALE);
    let mut pixels = tiny_skia::Pixmap::new(width.ceil() as u32, height.ceil() as u32)
        .ok_or(PngError::Size { width, height })?;
    resvg::render(
        &tree,
        tiny_skia::Transform::from_scale(SCALE, SCALE),
        &mut pixels.as_mut(),
    );
    pixels
        .encode_png()
        .map_err(|error| PngError::Encoding(error.to_string()))
}

/// The panels side by side, with common axes so that they compare.
fn drawing(analysis: &Analysis) -> String {
    let columns = analysis.axes.len().clamp(1, PER_ROW);
    let rows = analysis.axes.len().div_ceil(columns).max(1);
    let decades = allan_plot::decades(analysis.axes.iter());
    let spectra = spectrum_plot::decades(analysis.axes.iter());
    let tall = HEIGHT + spectrum_plot::HEIGHT;
    let (width, height) = (columns as f64 * WIDTH, rows as f64 * tall);
    let panels = analysis.axes.iter().enumerate().map(|(index, axis)| {
        let (x, y) = (
            (index % columns) as f64 * WIDTH,
            (index / columns) as f64 * tall,
        );
        let panel = allan_plot::panel(axis, &format!("p{index}"), decades, &LIGHT);
        let spectrum = spectrum_plot::panel(axis, &format!("s{index}"), spectra, &LIGHT);
        format!(
            "<g transform=\"translate({x} {y})\">{panel}<text x=\"64\" y=\"23\" font-size=\"15\" \
             font-weight=\"bold\" fill=\"{}\">Axis {}</text>\
             <g transform=\"translate(0 {HEIGHT})\">{spectrum}</g></g>",
            LIGHT.ink,
            escape(&axis.name)
        )
    });
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"DejaVu Sans\" font-size=\"12\">\
         <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>{}</svg>",
        LIGHT.paper,
        panels.collect::<String>()
    )
}
