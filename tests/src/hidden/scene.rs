//! What a record is like apart from what is hidden in it.

use std::sync::Arc;

use super::draw::Draw;
use super::noise::allan;
use super::noise::base::{Base, densities};
use super::noise::chain::Chain;
use super::noise::measured::Measured;

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
    /// Share of the samples that is missing, one here and one there.
    pub missing: f64,
    /// Size of a code over the typical difference between neighbours; zero where the record is no codes.
    pub code: f64,
    /// The law of the noise, where the record is a real one: then `axes` are about as strong at both ends of the
    /// spectrum.
    pub measured: Option<Arc<Measured>>,
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
            missing: 0.0,
            code: 0.0,
            measured: None,
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
        if let Some(measured) = &self.measured {
            return measured.density(f_hz);
        }
        let squares = self.axes[axis].squares();
        let parts = self.parts(f_hz);
        parts.iter().zip(squares).map(|(part, s)| part * s).sum()
    }

    /// Allan variance of an axis' noise ahead of the chain, without the ramp, averages over `tau_s`.
    pub fn allan_variance(&self, axis: usize, tau_s: f64) -> f64 {
        match &self.measured {
            None => self.axes[axis].allan_variance(tau_s),
            Some(measured) => {
                let samples = (tau_s * self.rate_hz).round().max(1.0) as u64;
                let law = |f_hz: f64| measured.density(f_hz);
                allan::of_law(self.rate_hz, &[samples], law)[0]
            }
        }
    }

    /// Two-sided density behind the chain of the two terms that have no memory beyond a sample:
    /// white and quantisation. Of a real record, of what is fast ([`Measured::short`]).
    pub fn short_density(&self, axis: usize, f_hz: f64) -> f64 {
        self.short_ahead(axis, f_hz) * self.chain.power(f_hz, self.rate_hz)
    }

    /// The same ahead of the chain. A real record has none that is known.
    pub fn short_ahead(&self, axis: usize, f_hz: f64) -> f64 {
        if let Some(measured) = &self.measured {
            return measured.density(f_hz) * measured.short(f_hz);
        }
        let squares = self.axes[axis].squares();
        let parts = densities(f_hz, self.rate_hz, self.chain.is_none());
        parts[2] * squares[2] + parts[3] * squares[3]
    }

    /// How strongly a single sample stands out, given all others: the variance of a sample
    /// about what its neighbours say of it, `1 / mean(1 / (S rate))` (Kolmogorov's
    /// interpolation error), over the frequencies that the chain passes.
    pub fn interpolation_variance(&self, axis: usize) -> f64 {
        self.interpolation(axis, self.lost_density(axis)) * self.rate_hz
    }

    /// The same as a two-sided density, where white noise of this density is added.
    fn interpolation(&self, axis: usize, added: f64) -> f64 {
        const POINTS: usize = 2048;
        let mean_inverse: f64 = (0..POINTS)
            .map(|i| 0.5 * self.rate_hz * (i as f64 + 0.5) / POINTS as f64)
            .filter(|&f_hz| self.passes(f_hz))
            .map(|f_hz| 1.0 / (self.density(axis, f_hz) + added))
            .sum::<f64>()
            / POINTS as f64;
        1.0 / mean_inverse
    }

    /// Two-sided density of an axis' noise behind the chain as it counts for whoever looks at what is not missing, per hertz.
    pub fn seen_density(&self, axis: usize, f_hz: f64) -> f64 {
        self.density(axis, f_hz) + self.lost_density(axis)
    }

    /// Two-sided density of the white noise that takes as much from whoever looks as rounding and the samples which are missing at
    /// random.
    pub fn lost_density(&self, axis: usize) -> f64 {
        let rounding = self.rounding_density(axis);
        self.missing_density(axis, rounding) + rounding
    }

    /// Two-sided density of what rounding adds behind the chain: uniform over a code, of which the record of an axis has so many to
    /// a median difference of neighbours.
    fn rounding_density(&self, axis: usize) -> f64 {
        /// Median size of a normal number.
        const MEDIAN: f64 = 0.674_49;
        const POINTS: usize = 2048;
        if self.code == 0.0 {
            return 0.0;
        }
        let parts = (0..POINTS).map(|i| (i as f64 + 0.5) / POINTS as f64);
        let squares = parts.map(|part| {
            let sine = (0.5 * std::f64::consts::PI * part).sin();
            self.density(axis, 0.5 * self.rate_hz * part) * 4.0 * sine * sine
        });
        // The variance of a difference over the rate: the density of as much white noise.
        let differences = squares.sum::<f64>() / POINTS as f64;
        (MEDIAN * self.code).powi(2) / 12.0 * differences
    }

    /// Two-sided density of the white noise that takes as much as what is missing, beside white noise that is added.
    /// A missing sample is one with infinite noise. A medium with the noise `L` in every sample scatters as much as the one with
    /// infinite noise in the share `m` where `L = m / mean(1 / (S + L))` (the coherent potential of P. Soven, Phys. Rev. 156 (1967)
    /// 809). White noise is seen as if it were `1 / (1 - m)` times as dense; of quantisation noise, whose sums tell all that is slow,
    /// gaps take nearly all away: there this leaves half of what is really left, so that what is drawn is found the more easily.
    fn missing_density(&self, axis: usize, added: f64) -> f64 {
        if self.missing == 0.0 {
            return 0.0;
        }
        // By bisection: below the solution the right side is above it.
        let (mut low, mut high) = (0.0, self.interpolation(axis, added));
        while self.missing * self.interpolation(axis, added + high) > high {
            high *= 2.0;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match self.missing * self.interpolation(axis, added + middle) > middle {
                true => low = middle,
                false => high = middle,
            }
        }
        high
    }

    /// Whether the chain leaves enough of this frequency for a real record to hold it. An ideal
    /// detector of ideal numbers would see through a stop band of 140 dB; no converter does.
    pub fn passes(&self, f_hz: f64) -> bool {
        self.chain.power(f_hz, self.rate_hz) > 1e-4
    }
}
