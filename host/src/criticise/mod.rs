//! What a model gets wrong about a record, why, and what is gained by mending it.

pub mod amplitudes;
pub mod axis;
pub mod bursts;
pub mod codes;
pub mod coherence;
pub mod demodulate;
pub mod diagnose;
pub mod finding;
pub mod frame;
pub mod gain;
pub mod impulses;
pub mod laws;
pub mod levels;
pub mod lines;
pub mod mend;
pub mod phase;
pub mod reference;
pub mod rounds;
pub mod samples;
pub mod slow;
pub mod steadiness;
pub mod tail;
pub mod telegraph;
pub mod timebase;
pub mod views;
pub mod whole;
