//! The judge of `inm diagnose`: effects hidden in records, and whether they are found.
//!
//! Shares no code with the noise models, the simulator or the emulator of the workspace: every
//! law here is written a second time, from the formulas, so that one cannot excuse the other.
//!
//! ```text
//! draw ----> scene ----> effect, outside ----> case ----> judge
//! random     rates,      what is hidden,       a record   runs the program,
//! numbers    noise,      its strength by       on disk,   compares with the
//!            chain       the ideal detector    the truth  truth, counts
//!                                              in memory
//! ```
//! `noise` makes the records' noise; `ideal` says what an ideal detector could find in it.

pub mod added;
pub mod axis;
pub mod case;
pub mod draw;
pub mod effect;
pub mod everyday;
pub mod frozen;
pub mod ideal;
pub mod judge;
pub mod noise;
pub mod npy;
pub mod outside;
pub mod pairs;
pub mod robust;
pub mod scene;
pub mod strength;
pub mod truth;
pub mod wide;
