//! Streaming multi-rate spectrum of one axis or several, in bounded memory.
//!
//! ```text
//! samples -> level 0 -> decimate by 8 -> level 1 -> decimate by 8 -> level 2 ...
//!               |                           |                           |
//!            segments                    segments          segments, and the whole record
//!               \___________________________|___________________________/   while it is short
//!                                           v
//!                     log-spaced bins: density, degrees of freedom,
//!                     expectation under any model, covariance
//! ```
//!
//! - [`cascade`]: one axis, sample by sample; [`segments`], [`window`], [`decimate`] and
//!   [`history`] are its parts. Averaged, tapered, half-overlapped periodograms (Welch 1967), at
//!   rates that follow the frequency, so that resolution is a share of it (the aim of Tröbs and
//!   Heinzel 2006, reached here in one pass instead of one transform a frequency).
//! - [`estimate`]: from its sums to bins, each from the source that serves it best; [`cosine`] for
//!   the lowest frequencies, where segments are few.
//! - [`expected`] with [`quadrature`], and [`covariance`]: what a fit compares the bins with. A
//!   Whittle-type likelihood needs no more than the bins, their expectation and their covariance.
//! - [`record_lines`]: narrow lines of a recorded file.
//! - [`cross`]: cross-spectra and coherence of axes; [`pool`]: neighbouring bins as one.
//!
//! Densities are two-sided per hertz, `S(f) = tau0 sum_l R_l e^{-2 pi i f l tau0}`: white noise of
//! variance `v` has `v / fs`. (One-sided densities, as in most instruments' displays, are twice
//! that.) They are those of the samples: the signal chain belongs to the model.
//!
//! # References
//! - P. D. Welch, *The use of fast Fourier transform for the estimation of power spectra*, IEEE
//!   Trans. Audio Electroacoust. 15 (1967).
//! - D. B. Percival and A. T. Walden, *Spectral Analysis for Physical Applications* (1993).
//! - F. J. Harris, *On the use of windows for harmonic analysis*, Proc. IEEE 66 (1978); A. H.
//!   Nuttall, *Some windows with very good sidelobe behavior*, IEEE Trans. ASSP 29 (1981).
//! - M. Tröbs and G. Heinzel, *Improved spectrum estimation from digitized time series on a
//!   logarithmic frequency axis*, Measurement 39 (2006).

mod binning;
pub mod cascade;
pub mod cosine;
pub mod covariance;
pub mod cross;
pub mod decimate;
pub mod estimate;
pub mod expected;
mod fill;
mod floor;
mod fold;
mod gather;
pub mod history;
pub mod pool;
pub mod quadrature;
pub mod record_lines;
pub mod segments;
mod slow_floor;
mod sources;
pub mod window;

pub use binning::Settings;
pub use cascade::Cascade;
pub use cross::CrossCascade;
pub use estimate::{Bin, Estimate};
pub use record_lines::Line;
pub use segments::Plan;

#[cfg(test)]
mod expected_tests;
#[cfg(test)]
mod line_tests;
#[cfg(test)]
mod measure;
#[cfg(test)]
mod statistics_tests;
