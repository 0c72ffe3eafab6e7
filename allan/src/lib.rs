//! Allan, modified Allan and Hadamard variance of integer codes, exact and in bounded memory.
//!
//! The crate is the statistics core of the noise bench: the same code runs on the board, one
//! conversion at a time, and on the host. Everything that accumulates does so in integers wide
//! enough for any record the types admit, so a variance does not depend on how the samples were
//! chunked, split or merged, and a mean that is a million times larger than the noise costs no
//! digit. Floating point enters once, when an [`Estimate`] is read out.
//!
//! - [`AllanBins`]: streaming Allan variance, small enough for the board.
//! - [`Bins`]: streaming Allan, modified Allan and Hadamard variance for the host.
//! - [`FloatBins`]: the same over floating-point samples, by way of a fixed grid.
//! - [`BlockMeans`]: Allan variance across gaps, biased and marked as such.
//! - [`full`]: every overlap at any averaging time, for records held in memory.
//! - [`edf`]: equivalent degrees of freedom of an estimate for a given noise type.
//! - [`octaves`]: the deviation of a slice at octaves, with 95 % intervals (feature `intervals`).
//! - [`identify`]: which noise rules at an averaging time (feature `intervals`).
//! - [`fixed_point`]: codes for floating-point samples, with a stated resolution.
//!
//! # Conventions
//!
//! A sample `y[i]` is the signal averaged over the sampling interval `tau0`; `S[k]` is the sum of
//! the first `k` samples, so `tau0 * S` is the signal's integral (`V` in Pavlov and Petrov eq. 5,
//! the phase `x` in the language of clocks). An averaging time is `m` samples, `tau = m * tau0`.
//! Variances are in the square of the samples' unit. With
//!
//! ```text
//! D[j] = S[j+2m] - 2 S[j+m] + S[j]                    E[j] = D[j] + ... + D[j+m-1]
//! H[j] = S[j+3m] - 3 S[j+2m] + 3 S[j+m] - S[j]
//! ```
//!
//! and angle brackets for the mean over `j`, the estimates are (W. J. Riley, NIST SP 1065, 2008,
//! sections 5.2.4, 5.2.5 and 5.2.9; the first is Pavlov and Petrov eq. 5)
//!
//! ```text
//! Allan <D^2> / (2 m^2)     modified <E^2> / (2 m^4)     Hadamard <H^2> / (6 m^2)
//! ```
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod allan_bins;
mod bins;
mod block;
mod block_means;
pub mod edf;
mod engine;
pub mod fixed_point;
mod float_bins;
pub mod full;
mod grid;
mod head;
mod history;
#[cfg(feature = "intervals")]
pub mod identify;
mod kernels;
mod knot;
mod merge;
#[cfg(feature = "intervals")]
mod octaves;
mod packed;
mod row;
mod state;
mod statistic;
mod sums;
mod wide;

pub use allan_bins::{AllanBins, BoardBins};
pub use bins::{Bins, HostBins};
pub use block_means::{BlockEstimate, BlockMeans};
pub use float_bins::{FloatBins, MergeError, OffGrid};
pub use merge::NotAdjacent;
#[cfg(feature = "intervals")]
pub use octaves::{Octave, interval, octaves};

pub use statistic::{Estimate, Statistic};

/// The examples of the README compile.
#[cfg(all(doctest, feature = "intervals"))]
#[doc = include_str!("../README.md")]
struct Readme;
