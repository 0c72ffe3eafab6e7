//! Random numbers by seed and stream, and what makes data of them.

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Names one stream of random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seed {
    /// What the user chose.
    pub seed: u64,
    /// Which stream of it: axes and terms have one each.
    pub stream: u64,
}

/// Makes one term's part of a record, block after block.
pub trait Generator: Send {
    /// Adds the next samples to `samples`.
    fn add_to(&mut self, samples: &mut [f64]);
}

/// The random numbers of one stream.
pub fn random(seed: Seed) -> Pcg64 {
    // The generator is distinguished by its stream constant; any seed is as good as another.
    let state = 0x9e37_79b9_7f4a_7c15_u128 << 64 | u128::from(seed.seed);
    Pcg64::new(state, u128::from(seed.stream))
}

/// A seeded stream of Gaussian numbers with mean zero.
pub struct Gaussian {
    random: Pcg64,
    deviation: f64,
}

impl Gaussian {
    /// A stream with the standard deviation `deviation`.
    pub fn new(seed: Seed, deviation: f64) -> Self {
        Self::of(random(seed), deviation)
    }

    /// What comes next of `random`, with the standard deviation `deviation`.
    pub const fn of(random: Pcg64, deviation: f64) -> Self {
        Self { random, deviation }
    }

    /// Draws the next number.
    pub fn draw(&mut self) -> f64 {
        let standard: f64 = StandardNormal.sample(&mut self.random);
        self.deviation * standard
    }
}

impl Generator for Gaussian {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            *sample += self.draw();
        }
    }
}
