//! Streaming multi-rate spectrum.

pub mod cascade;
pub mod decimate;
pub mod history;
pub mod segments;
pub mod window;
