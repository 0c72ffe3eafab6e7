//! Gaussian noise of any spectrum, walks and flicker included.

use std::f64::consts::PI;

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

use crate::hidden::draw::Draw;

/// Normal noise of `count` samples at `rate_hz` with the two-sided `density`, per hertz. Starts
/// within a few steps of zero.
///
/// What is drawn is the *differences*, `4 sin^2(pi f / rate)` times the density: they are
/// stationary even where the process is not (any law flatter than f^-3), and half of a period of
/// twice the length is free of the period's other end. The walk's differences are white, so its
/// law is exact at every lag; flicker's structure function is a few percent short at a lag of
/// the whole record.
pub fn gaussian(
    count: usize,
    rate_hz: f64,
    density: impl Fn(f64) -> f64,
    draw: &mut Draw,
) -> Vec<f64> {
    let length = 2 * count;
    let spacing_hz = rate_hz / length as f64;
    let mut spectrum: Vec<Complex<f64>> = (0..=count)
        .map(|j| {
            // At zero the limit: density times frequency squared.
            let f_hz = spacing_hz * if j == 0 { 1e-3 } else { j as f64 };
            let differences = 4.0 * (PI * f_hz / rate_hz).sin().powi(2) * density(f_hz);
            let deviation = (differences * spacing_hz).sqrt();
            if j == 0 || j == count {
                return Complex::new(deviation * draw.normal(), 0.0);
            }
            let half = deviation * std::f64::consts::FRAC_1_SQRT_2;
            Complex::new(half * draw.normal(), half * draw.normal())
        })
        .collect();
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(length);
    let mut differences = inverse.make_output_vec();
    inverse
        .process(&mut spectrum, &mut differences)
        .expect("the buffers are the plan's");
    differences.truncate(count);
    let mut level = 0.0;
    for value in &mut differences {
        level += *value;
        *value = level;
    }
    differences
}
