//! Roots of unity of a long transform, from two short tables.

use realfft::num_complex::Complex64;

/// `e^{-2 pi i k / N}` for every `k`, to some units in the last place.
pub struct Turns {
    coarse: Vec<Complex64>,
    fine: Vec<Complex64>,
}

impl Turns {
    /// Binary digits of `k` that the fine table stands for.
    const FINE: u32 = 11;

    /// Those of a transform of `len` samples.
    pub fn new(len: usize) -> Self {
        let turn =
            |k: usize| Complex64::from_polar(1.0, -std::f64::consts::TAU * k as f64 / len as f64);
        Self {
            coarse: (0..=len >> Self::FINE)
                .map(|k| turn(k << Self::FINE))
                .collect(),
            fine: (0..1 << Self::FINE).map(turn).collect(),
        }
    }

    /// Number `k`, at most `N`.
    pub fn at(&self, k: usize) -> Complex64 {
        self.coarse[k >> Self::FINE] * self.fine[k & ((1 << Self::FINE) - 1)]
    }
}
