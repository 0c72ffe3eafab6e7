//! Allan, modified Allan and Hadamard deviation of a record: averaging times, estimates, and
//! their 95 % intervals.

pub mod bridge;
pub mod full;
pub mod point;
pub mod read;
pub mod record;
pub mod strided;
pub mod taus;
pub mod unusable;
