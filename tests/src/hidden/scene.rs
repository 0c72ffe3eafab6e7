//! What a record is like apart from what is hidden in it.

use super::draw::Draw;
use super::noise::base::{Base, densities};
use super::noise::chain::Chain;

/// Samples a second, unless a test says otherwise.
pub const RATE_HZ: f64 = 2000.0;
/// Samples in a record, unless a test says otherwise.
pub const SAMPLES: usize = 1 << 20;

/// Rate, length, noise and chain of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Samples a second.
    pub rate_hz: f64,
    /// Samples.
    pub samples: usize,
    /// The noise of each axis: one, or three.
    pub axes: Vec<Base>,
    /// The axis in which something is hidden.
    pub target: usize,
    /// The chain, the same for all.
    pub chain: Chain,
    /// Whether the program is told of the chain.
    pub declared: bool,
    /// Whether what is hidden is drawn in units of rate and length.
    pub relative: bool,
}

impl Scene {
    /// A record of `samples` samples and `axes` axes.
    pub fn draw(samples: usize, axes: usize, draw: &mut Draw) -> Self {
        Self {
            rate_hz: RATE_HZ,
            samples,
            axes: (0..axes).map(|_| Base::draw(draw)).collect(),
            target: draw.index(axes),
            chain: Chain::draw(draw),
            declared: true,
            relative: false,
        }
    }

    /// Times to draw from, seconds: `usual`, or from so many samples to such a part of the record.
    pub fn times_s(&self, usual: (f64, f64), samples: f64, part: f64) -> (f64, f64) {
        match self.relative {
            true => (samples / self.rate_hz, self.duration_s() / part),
            false => usual,
        }
    }

    /// Length in seconds.
    pub fn duration_s(&self) -> f64 {
        self.samples as f64 / self.rate_hz
    }

    /// Two-sided densities per unit square of K, B, N, Q behind the chain.
    pub fn parts(&self, f_hz: f64) -> [f64; 4] {
        let power = self.chain.power(f_hz, self.rate_hz);
        densities(f_hz, self.rate_hz, self.chain.is_none()).map(|density| density * power)
    }

    /// Two-sided density of an axis' noise behind the chain, per hertz.
    pub fn density(&self, axis: usize, f_hz: f64) -> f64 {
        let squares = self.axes[axis].squares();
        let parts = self.parts(f_hz);
        parts.iter().zip(squares).map(|(part, s)| part * s).sum()
    }

    /// Two-sided density behind the chain of the two terms that have no memory beyond a sample:
    /// white and quantisation.
    pub fn short_density(&self, axis: usize, f_hz: f64) -> f64 {
        let squares = self.axes[axis].squares();
        let parts = self.parts(f_hz);
        parts[2] * squares[2] + parts[3] * squares[3]
    }

    /// How strongly a single sample stands out, given all others: the variance of a sample
    /// about what its neighbours say of it, `1 / mean(1 / (S rate))` (Kolmogorov's
    /// interpolation error), over the frequencies that the chain passes.
    pub fn interpolation_variance(&self, axis: usize) -> f64 {
        const POINTS: usize = 2048;
        let mean_inverse: f64 = (0..POINTS)
            .map(|i| 0.5 * self.rate_hz * (i as f64 + 0.5) / POINTS as f64)
            .filter(|&f_hz| self.passes(f_hz))
            .map(|f_hz| 1.0 / (self.density(axis, f_hz) * self.rate_hz))
            .sum::<f64>()
            / POINTS as f64;
        1.0 / mean_inverse
    }

    /// Whether the chain leaves enough of this frequency for a real record to hold it. An ideal
    /// detector of ideal numbers would see through a stop band of 140 dB; no converter does.
    pub fn passes(&self, f_hz: f64) -> bool {
        self.chain.power(f_hz, self.rate_hz) > 1e-4
    }
}
