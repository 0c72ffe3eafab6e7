//! Transforms, planned once: a plan's tables cost more than the transform they serve.
//!
//! Those of whole records are made from short ones: [`long`], [`ring`].

pub mod long;
pub mod phasor;
pub mod ring;
pub mod turns;

use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use realfft::{RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};

static REAL: LazyLock<Mutex<RealFftPlanner<f64>>> =
    LazyLock::new(|| Mutex::new(RealFftPlanner::new()));

static COMPLEX: LazyLock<Mutex<FftPlanner<f64>>> = LazyLock::new(|| Mutex::new(FftPlanner::new()));

/// From `len` real samples to `len / 2 + 1` ordinates.
pub fn real_forward(len: usize) -> Arc<dyn RealToComplex<f64>> {
    // A planner that panicked half-way has planned nothing: what it holds is sound.
    let mut planner = REAL.lock().unwrap_or_else(PoisonError::into_inner);
    planner.plan_fft_forward(len)
}

/// Of `len` complex samples.
pub fn forward(len: usize) -> Arc<dyn Fft<f64>> {
    let mut planner = COMPLEX.lock().unwrap_or_else(PoisonError::into_inner);
    planner.plan_fft_forward(len)
}

/// Back to `len` complex samples, times `len`.
pub fn inverse(len: usize) -> Arc<dyn Fft<f64>> {
    let mut planner = COMPLEX.lock().unwrap_or_else(PoisonError::into_inner);
    planner.plan_fft_inverse(len)
}
