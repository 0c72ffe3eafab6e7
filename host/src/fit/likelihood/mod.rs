//! Fit by likelihood: the bins of the spectrum against what a model expects them to be.
//!
//! ```text
//! Estimate -> data -> scoring (squares of the coefficients) -> information, profile, test
//! ```
//!
//! A bin averages squares of nearly Gaussian ordinates, so it follows a gamma law about its
//! expectation with as many degrees of freedom as it has (Whittle 1953); the expectation is exact
//! ([`crate::spectrum::expected`]) and linear in the squared coefficients. With many degrees of
//! freedom the law is Gaussian, with two it is the exponential law of a periodogram; nothing needs
//! to be chosen.
//!
//! Neighbouring bins share a part of what they average. Their degrees of freedom are therefore
//! reduced so that together they count what they hold ([`data`]), and the covariance of the result
//! is corrected for what is left (the "sandwich" of Godambe 1960; [`information`]).
//!
//! - P. Whittle, *Estimation and information in stationary time series*, Ark. Mat. 2 (1953).
//! - V. P. Godambe, *An optimum property of regular maximum likelihood estimation*, Ann. Math.
//!   Statist. 31 (1960).
//! - J. A. Nelder and R. W. M. Wedderburn, *Generalized linear models*, J. R. Stat. Soc. A 135
//!   (1972).

pub mod components;
pub mod data;
pub mod information;
pub mod longer;
pub mod misfit;
pub mod non_negative;
pub mod profile;
pub mod ramp;
pub mod scoring;
pub mod slope;
pub mod terms;
pub mod whittle;

#[cfg(test)]
mod measure;

pub use data::Data;
pub use scoring::{Fit, log_likelihood, maximise};
