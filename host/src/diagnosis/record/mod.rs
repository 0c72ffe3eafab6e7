//! A record on its way to being explained: samples, waveforms, residual, spectral bins. Knows no effect by
//! name.

pub mod beyond;
pub mod bins;
pub mod bridge;
pub mod drawn;
pub mod envelope;
pub mod in_record;
pub mod long_gaps;
pub mod powers;
pub mod reading;
pub mod residual;
pub mod runs;
pub mod samples;
pub mod short_gaps;
pub mod spill;
pub mod switching;
pub mod wave;
