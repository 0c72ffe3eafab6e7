//! Library behind `inm`, the noise bench for inertial accelerometers.
//!
//! Data flows one way:
//!
//! ```text
//! source -> bins, spectrum -> fit -> diagnosis -> report
//! ```
#![forbid(unsafe_code)]

pub mod analyse;
pub mod bins;
pub mod capture;
pub mod chain;
pub mod cli;
pub mod data_sheet;
pub mod diagnosis;
pub mod export;
pub mod fft;
pub mod fit;
#[cfg(feature = "flash")]
pub mod flash;
pub mod link;
pub mod live;
pub mod model;
pub mod navigate;
pub mod report;
pub mod signal;
pub mod simulate;
pub mod source;
pub mod spectrum;
pub mod virtual_board;
