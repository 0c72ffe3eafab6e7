//! What a program asks of this library beyond reading and writing: each function takes a record or a
//! model and gives a plain result. The command line reads arguments, opens files, calls one of these
//! and writes what it returns.
//!
//! [`analyse`](crate::analyse()) and [`export`](crate::export()) stand with their results.

pub mod covariate;
pub mod diagnose;
pub mod simulate;
