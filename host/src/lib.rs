//! Library behind `inm`, the noise bench for inertial accelerometers.
//!
//! Data flows one way:
//!
//! ```text
//! source -> bins -> fit -> report
//! ```
#![forbid(unsafe_code)]

pub mod capture;
pub mod chain;
#[cfg(feature = "flash")]
pub mod flash;
pub mod link;
pub mod live;
pub mod signal;
pub mod source;
pub mod spectrum;
