//! A record on its way to being explained: samples, residual, spectral bins. Knows no effect by name.

pub mod bins;
pub mod residual;
pub mod samples;
pub mod spill;
