//! The result of a diagnosis: plain structures, as `--json` writes them. Nothing here knows how it came about.

pub mod estimate;
pub mod finding;
pub mod place;
pub mod rival;
pub mod suspicion;
pub mod value;
pub mod verdict;
pub mod views;
