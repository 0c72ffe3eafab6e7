//! A window of a band at one frequency.

use std::f64::consts::TAU;

use realfft::num_complex::Complex64;

/// Power of a window at `cycles` a sample.
pub fn power(window: &[Complex64], cycles: f64) -> f64 {
    phasor(window, cycles).norm_sqr()
}

/// Sum of a window at `cycles` a sample, its phase that in its middle, over the root of its length.
pub fn phasor(window: &[Complex64], cycles: f64) -> Complex64 {
    let length = window.len() as f64;
    let turn = Complex64::cis(-TAU * cycles);
    let mut now = Complex64::cis(TAU * cycles * 0.5 * (length - 1.0));
    let mut sum = Complex64::ZERO;
    for value in window {
        sum += value * now;
        now *= turn;
    }
    sum / length.sqrt()
}
