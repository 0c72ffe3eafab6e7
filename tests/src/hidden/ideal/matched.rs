//! The matched filter: how far a known waveform shifts the mean of coloured noise.

use crate::hidden::noise::cosines::cosines;
use crate::hidden::scene::Scene;

/// Cosine coefficients (DCT-II) of a waveform over the noise's deviation at each. The cosine
/// transform makes white noise and the random walk independent coefficients exactly, and
/// stationary noise nearly so; the first coefficient, the mean, is left out.
pub struct Whitened(Vec<f64>);

impl Whitened {
    /// `waveform`, ahead of the chain, in the noise of `axis`.
    pub fn new(waveform: &[f64], scene: &Scene, axis: usize) -> Self {
        let n = waveform.len();
        let cosines = cosines(waveform);
        let spacing_hz = scene.rate_hz / (2 * n) as f64;
        let lost = scene.lost_density(axis);
        let coefficients = (1..n).map(|k| {
            let f_hz = k as f64 * spacing_hz;
            if !scene.passes(f_hz) {
                return 0.0;
            }
            let passed = scene.chain.power(f_hz, scene.rate_hz);
            let noise = (scene.density(axis, f_hz) + lost) * scene.rate_hz;
            cosines[k] * (passed / noise).sqrt()
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
