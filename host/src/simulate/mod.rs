//! Simulated records: seeded, streaming, in bounded memory for any length.
//!
//! ```text
//! term -> generator ─┐
//! term -> generator ─┴─> shaping (signal chain) ─> distorters ─> source, array file or capture
//! ```

pub mod axis;
pub mod capture;
pub mod file;
pub mod shaping;
pub mod source;
