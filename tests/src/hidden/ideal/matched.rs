//! The matched filter: how far a known waveform shifts the mean of coloured noise.

use std::f64::consts::PI;

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

use crate::hidden::scene::Scene;

/// Cosine coefficients (DCT-II) of a waveform over the noise's deviation at each. The cosine
/// transform makes white noise and the random walk independent coefficients exactly, and
/// stationary noise nearly so; the first coefficient, the mean, is left out.
pub struct Whitened(Vec<f64>);

impl Whitened {
    /// `waveform`, ahead of the chain, in the noise of `axis`.
    pub fn new(waveform: &[f64], scene: &Scene, axis: usize) -> Self {
        let n = waveform.len();
        let mut planner = RealFftPlanner::<f64>::new();
        let forward = planner.plan_fft_forward(2 * n);
        let mut mirrored: Vec<f64> = waveform
            .iter()
            .chain(waveform.iter().rev())
            .copied()
            .collect();
        let mut spectrum = forward.make_output_vec();
        forward
            .process(&mut mirrored, &mut spectrum)
            .expect("the buffers are the plan's");
        let spacing_hz = scene.rate_hz / (2 * n) as f64;
        let lost = scene.lost_density(axis);
        let coefficients = (1..n).map(|k| {
            let f_hz = k as f64 * spacing_hz;
            if !scene.passes(f_hz) {
                return 0.0;
            }
            let turn = Complex::from_polar(1.0, -PI * k as f64 / (2 * n) as f64);
            let cosine = (turn * spectrum[k]).re / (2.0 * n as f64).sqrt();
            let passed = scene.chain.power(f_hz, scene.rate_hz);
            let noise = (scene.density(axis, f_hz) + lost) * scene.rate_hz;
            cosine * (passed / noise).sqrt()
        });
        Self(coefficients.collect())
    }

    fn dot(&self, other: &Self) -> f64 {
        self.0.iter().zip(&other.0).map(|(a, b)| a * b).sum()
    }

    /// Non-centrality of the waveform.
    pub fn energy(&self) -> f64 {
        self.dot(self)
    }

    /// What `other` explains of it, taken away.
    #[must_use]
    pub fn without(mut self, other: &Self) -> Self {
        let share = self.dot(other) / other.energy();
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            *a -= share * b;
        }
        self
    }
}

/// Non-centrality of `waveform` where mean and ramp are fitted as well.
pub fn energy(waveform: &[f64], scene: &Scene, axis: usize) -> f64 {
    let n = waveform.len() as f64;
    let ramp: Vec<f64> = (0..waveform.len()).map(|i| i as f64 / n - 0.5).collect();
    let ramp = Whitened::new(&ramp, scene, axis);
    Whitened::new(waveform, scene, axis).without(&ramp).energy()
}
