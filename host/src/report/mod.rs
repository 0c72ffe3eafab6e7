//! Formats a finished [`Analysis`](crate::analyse::Analysis) or
//! [`Diagnosis`](crate::criticise::finding::Diagnosis): text, JSON, HTML, PNG. Nothing is computed
//! here that the result does not hold.

pub mod allan_plot;
pub mod bitmap;
pub mod diagnosis_text;
pub mod html;
pub mod json;
pub mod number;
pub mod page;
pub mod plot;
pub mod png;
pub mod spectrum_plot;
pub mod svg;
pub mod text;
pub mod verdict;
