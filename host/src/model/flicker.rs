//! Bias instability: flicker noise, with a spectrum of 1/f.
//!
//! The simulator is a bank of first-order sections driven by one stream of white noise, with
//! poles and zeros alternating at equal distances on the logarithmic frequency axis: between
//! them the spectrum falls by half the slope of one pole. A bank with poles a factor
//! `exp(h)` apart ripples by 2/sinh(pi^2/h) nepers of power, 0.036 dB for h = 1.6. The two
//! sections at the top were placed by minimising the largest deviation up to half the rate.

use std::f64::consts::{LN_2, PI};

use super::kernel::{self, Kernel};
use super::random::{Gaussian, Generator};
use super::{Seed, Term};

/// What it is, in a sentence.
pub const MEANING: &str = "flicker noise (1/f): the floor that longer averaging does not lower, \
                           from traps and charge in the electronics";

/// Flicker noise. Pavlov and Petrov eq. 8, third term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flicker {
    /// B: the two-sided spectral density is `B^2 / (2 pi f)`; unit of the signal.
    pub level: f64,
}

impl Term for Flicker {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        kernel::variance(Kernel::Allan, m, rate_hz, |f| self.spectrum(f, rate_hz))
    }

    fn allan_asymptote(&self, _tau_s: f64) -> f64 {
        self.level.powi(2) * 2.0 * LN_2 / PI
    }

    fn spectrum(&self, f_hz: f64, _rate_hz: f64) -> f64 {
        self.level.powi(2) / (2.0 * PI * f_hz)
    }

    fn spectrum_ahead(&self, f_hz: f64, rate_hz: f64) -> f64 {
        self.spectrum(f_hz, rate_hz)
    }

    fn generator(&self, _rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        // White noise of deviation 1 a sample has the density 1/rate; the bank shapes it to
        // 1/w with w = 2 pi f / rate, so B^2/(2 pi f) = B^2 / (w rate).
        Box::new(Bank::new(Gaussian::new(seed, self.level)))
    }
}

/// Sections of the bank; the lowest pole lies at 4e-13 of the rate, so that 1/f holds over
/// eleven decades below half the rate.
const SECTIONS: usize = 20;

/// Logarithm of the distance between neighbouring poles.
const SPACING: f64 = 1.6;

/// Highest pole of the regular bank, radians a sample, and the two sections above it as pole
/// and zero in the z plane. Minimax over 3e-4 to pi radians a sample: 0.038 dB.
const TOP: f64 = 0.318_45;
const ABOVE: [(f64, f64); 2] = [(0.182_19, -0.060_704), (-0.701_49, -0.722_12)];

/// Poles and zeros as their distances from 1 in the z plane.
fn sections() -> [(f64, f64); SECTIONS] {
    std::array::from_fn(|k| match ABOVE.get(k) {
        Some((pole, zero)) => (1.0 - pole, 1.0 - zero),
        None => {
            let pole = TOP * (-SPACING * (k - ABOVE.len()) as f64).exp();
            let zero = pole * (0.5 * SPACING).exp();
            // 1 - exp(-x) without cancellation.
            (-(-pole).exp_m1(), -(-zero).exp_m1())
        }
    })
}

/// The bank in parallel form: every section sees the same noise.
struct Bank {
    noise: Gaussian,
    decay: [f64; SECTIONS],
    weight: [f64; SECTIONS],
    direct: f64,
    state: [f64; SECTIONS],
}

impl Bank {
    fn new(mut noise: Gaussian) -> Self {
        let sections = sections();
        let gain = gain(&sections);
        // Partial fractions of prod (1 - b/z) / (1 - a/z), in the distances from 1.
        let weight = std::array::from_fn(|k| {
            let (pole_k, zero_k) = sections[k];
            let at = 1.0 - pole_k;
            let others = sections.iter().enumerate().filter(|&(j, _)| j != k);
            gain * (zero_k - pole_k) / at
                * others
                    .map(|(_, &(pole, zero))| (zero - pole_k) / (pole - pole_k))
                    .product::<f64>()
        });
        let direct = gain
            * sections
                .iter()
                .map(|&(pole, zero)| (1.0 - zero) / (1.0 - pole))
                .product::<f64>();
        let decay = sections.map(|(pole, _)| pole);
        let state = stationary(&decay, &mut noise);
        Self {
            noise,
            decay,
            weight,
            direct,
            state,
        }
    }
}

impl Generator for Bank {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            let white = self.noise.draw();
            let mut sum = self.direct * white;
            for k in 0..SECTIONS {
                // Written with 1 - a, which keeps its digits for slow sections.
                let next = self.state[k] - self.decay[k] * self.state[k] + white;
                self.state[k] = next;
                sum += self.weight[k] * next;
            }
            *sample += sum;
        }
    }
}

/// Factor that centres the bank's spectrum on 1/w.
fn gain(sections: &[(f64, f64); SECTIONS]) -> f64 {
    let levels = (0..=400).map(|step| {
        let w = PI * 10_f64.powf(-f64::from(step) / 100.0);
        (power(sections, w) * w).ln()
    });
    let (low, high) = levels.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), level| {
        (low.min(level), high.max(level))
    });
    (-0.25 * (low + high)).exp()
}

/// Power of the sections in series at `w` radians a sample.
fn power(sections: &[(f64, f64); SECTIONS], w: f64) -> f64 {
    // |1 - a exp(-iw)|^2 = (1 - a)^2 + 4 a sin^2(w/2)
    let factor =
        |distance: f64| distance * distance + 4.0 * (1.0 - distance) * (0.5 * w).sin().powi(2);
    sections
        .iter()
        .map(|&(pole, zero)| factor(zero) / factor(pole))
        .product()
}

/// States after an infinite past: Gaussian with the covariance `1 / (1 - a_i a_j)` of sections
/// that share their noise, drawn through its Cholesky factor.
fn stationary(decay: &[f64; SECTIONS], noise: &mut Gaussian) -> [f64; SECTIONS] {
    let mut factor = [[0.0; SECTIONS]; SECTIONS];
    let white: [f64; SECTIONS] = std::array::from_fn(|_| noise.draw());
    let mut state = [0.0; SECTIONS];
    for i in 0..SECTIONS {
        for j in 0..=i {
            let covariance = 1.0 / (decay[i] + decay[j] - decay[i] * decay[j]);
            let rest = covariance - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
            factor[i][j] = if i == j {
                rest.max(0.0).sqrt()
            } else {
                rest / factor[j][j]
            };
        }
        state[i] = (0..=i).map(|k| factor[i][k] * white[k]).sum();
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bank_is_within_a_tenth_of_a_decibel_of_one_over_f() {
        let sections = sections();
        let gain = gain(&sections);
        // Half the rate down to eleven decades below it.
        for step in 0..=1100 {
            let w = PI * 10_f64.powf(-f64::from(step) / 100.0);
            let decibels = 10.0 * (gain * gain * power(&sections, w) * w).log10();
            assert!(
                decibels.abs() < 0.1,
                "{decibels} dB at {w:e} radians a sample"
            );
        }
    }

    #[test]
    fn parallel_form_equals_the_sections_in_series() {
        let bank = Bank::new(Gaussian::new(Seed { seed: 1, stream: 0 }, 1.0));
        for w in [1e-9, 1e-6, 1e-3, 0.1, 1.0, PI] {
            let (mut re, mut im) = (bank.direct, 0.0);
            for k in 0..SECTIONS {
                // 1 - a exp(-iw) with a = 1 - decay
                let a = 1.0 - bank.decay[k];
                let (x, y) = (
                    bank.decay[k] + a * 2.0 * (0.5 * w).sin().powi(2),
                    a * w.sin(),
                );
                let norm = x * x + y * y;
                re += bank.weight[k] * x / norm;
                im -= bank.weight[k] * y / norm;
            }
            let decibels = 10.0 * ((re * re + im * im) * w).log10();
            assert!(decibels.abs() < 0.1, "{decibels} dB at {w:e}");
        }
    }

    #[test]
    fn allan_variance_tends_to_the_asymptote() {
        let flicker = Flicker { level: 2.0 };
        let ratio = |m| flicker.allan_variance(m, 100.0) / flicker.allan_asymptote(1.0);
        assert!((ratio(100_000) - 1.0).abs() < 1e-6, "{}", ratio(100_000));
        // At m = 1 the kernel is 2 sin^2, and the integral (2/pi) B^2 Cin(pi)/2.
        let cin_pi = 1.648_277_638_8;
        assert!(
            (ratio(1) / (cin_pi / (2.0 * LN_2)) - 1.0).abs() < 1e-6,
            "{}",
            ratio(1)
        );
    }
}
