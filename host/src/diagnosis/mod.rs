//! What a model gets wrong about a record, why, and what is gained by mending it.

pub mod axis;
pub mod describe;
pub mod detect;
pub mod doubt;
pub mod explain;
pub mod held_out;
pub mod laws;
pub mod record;
pub mod result;
pub mod rounds;
pub mod run;
pub mod statistic;
pub mod views;
