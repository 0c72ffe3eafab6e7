//! Streaming multi-rate spectrum.

pub mod cascade;
pub mod covariance;
pub mod decimate;
pub mod estimate;
pub mod expected;
pub mod history;
pub mod multitaper;
pub mod quadrature;
pub mod segments;
pub mod window;
