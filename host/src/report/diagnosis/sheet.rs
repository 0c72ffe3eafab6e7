//! The pictures of all axes as one bitmap.

use super::super::bitmap::{self, PngError};
use super::super::plot::frame::WIDTH;
use super::super::svg::LIGHT;
use super::{HEIGHT, pictures};
use crate::diagnosis::result::finding::Diagnosis;

/// Pictures next to one another.
const PER_ROW: usize = 2;

/// The bitmap as the bytes of a PNG file: for each axis two rows of two pictures.
///
/// # Errors
/// If there is no axis to draw.
pub fn render(diagnosis: &Diagnosis) -> Result<Vec<u8>, PngError> {
    let mut drawing = String::new();
    let mut count = 0;
    let axes = diagnosis.axes.iter().enumerate();
    for (number, axis) in axes.filter(|(_, axis)| axis.refused.is_none()) {
        for (_, picture) in pictures(axis, &format!("p{number}"), &LIGHT) {
            let x = (count % PER_ROW) as f64 * WIDTH;
            let y = (count / PER_ROW) as f64 * HEIGHT;
            drawing.push_str(&format!(
                "<g transform=\"translate({x} {y})\">{picture}</g>"
            ));
            count += 1;
        }
    }
    let height = (count / PER_ROW) as f64 * HEIGHT;
    bitmap::render(PER_ROW as f64 * WIDTH, height, &drawing)
}
