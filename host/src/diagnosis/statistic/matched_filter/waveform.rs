//! Waveforms that are looked for, as their transforms.

use realfft::num_complex::Complex64;

/// Transform of a waveform that begins at moment zero, as the filters need it.
pub trait Waveform {
    /// Its transform where one sample later is a factor of `turn = e^{-2 pi i f / rate}`.
    fn at(&self, turn: Complex64) -> Complex64;
}

/// A single sample of size 1.
pub struct Impulse;

impl Waveform for Impulse {
    fn at(&self, _turn: Complex64) -> Complex64 {
        Complex64::ONE
    }
}

/// A jump by 1 that stays.
pub struct Step;

impl Waveform for Step {
    fn at(&self, turn: Complex64) -> Complex64 {
        // On the ring, where the mean is not seen.
        (Complex64::ONE - turn).inv()
    }
}

/// Exponential settling, sampled half a sample after it began.
pub struct Settling {
    /// Share that is left a sample later.
    kept: f64,
    /// Size of the first sample, less what goes on round the ring.
    size: f64,
}

impl Settling {
    /// With a time constant of so many `samples`, on a ring of `len` at whose end it breaks off.
    pub fn new(samples: f64, len: usize) -> Self {
        let kept = (-1.0 / samples).exp();
        Self {
            kept,
            size: kept.sqrt() * -(-(len as f64) / samples).exp_m1(),
        }
    }
}

impl Waveform for Settling {
    fn at(&self, turn: Complex64) -> Complex64 {
        self.size * (Complex64::ONE - self.kept * turn).inv()
    }
}
