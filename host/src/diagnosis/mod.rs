//! What a model gets wrong about a record, why, and what the extended model gains.

pub mod attempts;
pub mod axis;
pub mod decision;
pub mod describe;
pub mod detect;
pub mod doubt;
pub mod explain;
pub mod explanation;
pub mod family;
pub mod held_out;
pub mod laws;
pub mod loser;
pub mod options;
pub mod progress;
pub mod recognised;
pub mod record;
pub mod refused;
pub mod result;
pub mod room;
pub mod run;
pub mod search;
pub mod statistic;
pub mod steady;
pub mod suspect;
#[cfg(test)]
mod trial;
pub mod unnamed;
pub mod values;
pub mod views;
