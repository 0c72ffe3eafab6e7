//! Library behind `inm`, the noise bench for inertial accelerometers.
//!
//! Data flows one way:
//!
//! ```text
//! source -> bins -> fit -> report
//! ```
#![forbid(unsafe_code)]

pub mod chain;
pub mod signal;
pub mod source;
