//! The transform in which white noise, walks and, nearly, all stationary noise have independent coefficients.

use std::f64::consts::PI;

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

/// Coefficients of the orthonormal cosine transform (DCT-II) of `samples`, the first that of their mean. Number `k` is at
/// `k / 2T` of a record of the length `T`, and the mean of its square is the two-sided density there times the rate.
pub fn cosines(samples: &[f64]) -> Vec<f64> {
    let n = samples.len();
    let mirrored = samples.iter().chain(samples.iter().rev());
    let mut mirrored: Vec<f64> = mirrored.copied().collect();
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(2 * n);
    let mut spectrum = forward.make_output_vec();
    forward
        .process(&mut mirrored, &mut spectrum)
        .expect("the buffers are the plan's");
    let cosine = |k: usize| {
        let turn = Complex::from_polar(1.0, -PI * k as f64 / (2 * n) as f64);
        (turn * spectrum[k]).re / (2.0 * n as f64).sqrt()
    };
    (0..n).map(cosine).collect()
}
