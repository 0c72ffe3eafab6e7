//! Runs the program on cases, compares its answers with the truth, and counts.

pub mod allan;
pub mod allan_table;
pub mod answer;
pub mod closure;
pub mod place;
pub mod program;
pub mod score;
pub mod tally;
pub mod trial;
