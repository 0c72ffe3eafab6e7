//! Runs the program on cases, compares its answers with the truth, and counts.

pub mod answer;
pub mod place;
pub mod program;
pub mod score;
pub mod tally;
pub mod trial;
