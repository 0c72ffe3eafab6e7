//! Formats a finished [`Analysis`](crate::analyse::Analysis): text, JSON, HTML, PNG. Nothing is
//! computed here that the result does not hold.

pub mod json;
pub mod number;
pub mod text;
pub mod verdict;
