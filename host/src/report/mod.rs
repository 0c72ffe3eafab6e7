//! Formats a finished [`Analysis`] or [`Diagnosis`]: text, JSON, HTML, PNG. Nothing is computed here
//! that the result does not hold.

pub mod allan_plot;
pub mod bitmap;
pub mod diagnosis;
pub mod html;
pub mod json;
pub mod page;
pub mod plot;
pub mod png;
mod rate;
pub mod reveal;
pub mod spectrum_plot;
pub mod svg;
pub mod text;
pub mod verdict;
pub mod watched;

use serde::Serialize;

use crate::analyse::Analysis;
use crate::diagnosis::result::finding::Diagnosis;

/// A result that can be shown.
pub trait Report: Serialize {
    /// For the terminal, with a newline at the end.
    fn text(&self) -> String;

    /// As a self-contained page.
    fn page(&self) -> String;

    /// Its pictures as the bytes of a PNG file.
    ///
    /// # Errors
    /// If there is nothing to draw.
    fn bitmap(&self) -> Result<Vec<u8>, bitmap::PngError>;
}

impl Report for Analysis {
    fn text(&self) -> String {
        text::render(self)
    }

    fn page(&self) -> String {
        html::render(self)
    }

    fn bitmap(&self) -> Result<Vec<u8>, bitmap::PngError> {
        png::render(self)
    }
}

impl Report for Diagnosis {
    fn text(&self) -> String {
        diagnosis::text::render(self)
    }

    fn page(&self) -> String {
        diagnosis::page::render(self)
    }

    fn bitmap(&self) -> Result<Vec<u8>, bitmap::PngError> {
        diagnosis::sheet::render(self)
    }
}
