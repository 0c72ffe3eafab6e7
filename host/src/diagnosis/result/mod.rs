//! The result of a diagnosis: plain structures, as `--json` writes them.

pub mod coefficients;
pub mod finding;
pub mod place;
