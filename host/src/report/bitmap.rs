//! An SVG drawing as the bytes of a PNG file.
//!
//! The typeface (DejaVu Sans) is part of the program, so that a bare machine draws the same.

use std::sync::Arc;

use resvg::{tiny_skia, usvg};

use super::svg::LIGHT;

/// Pixels of the bitmap for one of the drawing.
const SCALE: f32 = 1.5;

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

/// The bitmap of `drawing`, SVG elements of `width` by `height` pixels on paper.
///
/// # Errors
/// If the drawing is no SVG or has no size.
pub fn render(width: f64, height: f64, drawing: &str) -> Result<Vec<u8>, PngError> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    let options = usvg::Options {
        fontdb: Arc::new(fonts),
        font_family: "DejaVu Sans".into(),
        ..Default::default()
    };
    let document = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"DejaVu Sans\" font-size=\"12\">\
         <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>{drawing}</svg>",
        LIGHT.paper,
    );
    let tree = usvg::Tree::from_str(&document, &options)?;
    let (width, height) = (width as f32 * SCALE, height as f32 * SCALE);
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
