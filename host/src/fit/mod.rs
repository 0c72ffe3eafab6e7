//! Fits of the five coefficients to an Allan curve.

pub mod covariance;
pub mod design;
pub mod least_squares;
pub mod published;
pub mod weighted;
