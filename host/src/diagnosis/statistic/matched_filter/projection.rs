//! A record projected on one waveform, and on unseen ordinates.
//!
//! Ordinates with even and with odd numbers are independent of one another and see the same hours:
//! what a waveform is worth on unseen data is measured by fitting it to the one half and judging the
//! other.

use super::transform::Transform;
use crate::diagnosis::statistic::sums::sums;

/// Which ordinates a statistic looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Half {
    /// All ordinates.
    Both,
    /// The ordinates with even numbers.
    Even,
    /// The ordinates with odd numbers.
    Odd,
}

impl Half {
    /// Whether it has ordinate `k`.
    pub const fn has(self, k: usize) -> bool {
        match self {
            Self::Both => true,
            Self::Even => k.is_multiple_of(2),
            Self::Odd => !k.is_multiple_of(2),
        }
    }
}

/// `<x, g>` and `<g, g>` of a record and one waveform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// `<x, g>`.
    pub product: f64,
    /// `<g, g>`.
    pub power: f64,
}

impl Projection {
    /// Of `record` on `wave`, both transforms of the same length.
    pub fn new(record: &Transform, density: &[f64], wave: &Transform, half: Half) -> Self {
        let [product, power] = sums(1..record.ordinates.len(), |k| {
            if !half.has(k) {
                return [0.0; 2];
            }
            let (x, g) = (record.ordinates[k], wave.ordinates[k]);
            [(x * g.conj()).re, g.norm_sqr()].map(|term| term / density[k])
        });
        // The sums run over half of the ring.
        let norm = 0.5 * record.len as f64 * record.rate_hz;
        Self {
            product: product / norm,
            power: power / norm,
        }
    }

    /// Size of the waveform, in standard deviations of that size.
    pub fn z(self) -> f64 {
        self.product / self.power.sqrt()
    }

    /// Size of the waveform.
    pub fn size(self) -> f64 {
        self.product / self.power
    }

    /// Standard deviation of the size.
    pub fn size_sd(self) -> f64 {
        self.power.sqrt().recip()
    }

    /// Gain in log-likelihood if the waveform has the size `size`, fitted elsewhere.
    pub fn gain(self, size: f64) -> f64 {
        size * self.product - 0.5 * size * size * self.power
    }
}

/// Gain of a waveform in log-likelihood on the odd ordinates, its size fitted to the even ones.
pub fn held_out_gain(record: &Transform, density: &[f64], wave: &Transform) -> f64 {
    let seen = Projection::new(record, density, wave, Half::Even);
    Projection::new(record, density, wave, Half::Odd).gain(seen.size())
}
