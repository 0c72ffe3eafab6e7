//! The noise of the records: five terms, the signal chain, and data of any spectrum.

pub mod allan;
pub mod base;
pub mod chain;
pub mod cosines;
pub mod gaussian;
pub mod measured;
