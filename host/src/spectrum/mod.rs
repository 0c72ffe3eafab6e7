//! Streaming multi-rate spectrum.

pub mod cascade;
pub mod covariance;
pub mod cross;
pub mod decimate;
pub mod estimate;
pub mod expected;
mod fill;
pub mod history;
pub mod lines;
pub mod multitaper;
pub mod quadrature;
pub mod record_lines;
pub mod segments;
pub mod window;

#[cfg(test)]
mod expected_tests;
#[cfg(test)]
mod statistics_tests;
