//! What a model gets wrong about a record, why, and what is gained by mending it.

pub mod bursts;
pub mod codes;
pub mod frame;
pub mod impulses;
pub mod laws;
pub mod levels;
pub mod samples;
pub mod tail;

pub mod whole;
