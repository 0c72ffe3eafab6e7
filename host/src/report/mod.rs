//! Formats a finished [`Analysis`](crate::analyse::Analysis): text, JSON, HTML, PNG. Nothing is
//! computed here that the result does not hold.

pub mod allan_plot;
pub mod diagnosis_text;
pub mod html;
pub mod json;
pub mod number;
pub mod png;
mod residual_strip;
pub mod spectrum_plot;
pub mod svg;
pub mod text;
pub mod verdict;
