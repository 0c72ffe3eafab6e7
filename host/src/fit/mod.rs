//! Fits of a noise model: to the Allan curve as published and weighted, to the spectrum by
//! likelihood.

pub mod covariance;
pub mod design;
pub mod least_squares;
pub mod likelihood;
pub mod published;
pub mod result;
pub mod weighted;
