//! A low-order filter that makes white noise into noise of a given spectrum.
//!
//! The spectrum's minimum-phase factor is found through its cepstrum (A. Oppenheim and
//! R. Schafer, *Discrete-Time Signal Processing*, ch. 13); its impulse response becomes a system
//! of low order by balanced truncation of its Hankel matrix (S. Kung 1978).

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::state_space::StateSpace;

/// Points of the transform.
const GRID: usize = 1 << 14;

/// Rows of the Hankel matrix; the impulse response may be twice as long.
const HANKEL: usize = 128;

/// Spectrum that is taken for zero, as a part of its peak: the logarithm needs a floor. It lies
/// in a converter's stop band.
const FLOOR: f64 = 1e-9;

/// An impulse response and the singular values and vectors of its Hankel matrix.
pub struct Factor {
    shifted: DMatrix<f64>,
    left: DMatrix<f64>,
    right: DMatrix<f64>,
    values: DVector<f64>,
}

impl Factor {
    /// The factor of the two-sided density `spectrum` of samples at `rate_hz`, without what the
    /// `sections` do ([`StateSpace::cascade`]): their memory may be long, that of the rest is short.
    pub fn new(spectrum: impl Fn(f64) -> f64, sections: &[f64], rate_hz: f64) -> Self {
        let rest = |f_hz: f64| {
            let sine = (0.5 * TAU * f_hz / rate_hz).sin();
            let passed: f64 = sections
                .iter()
                .map(|c| c * c / (c * c + 4.0 * (1.0 - c) * sine * sine))
                .product();
            rate_hz * spectrum(f_hz) / passed
        };
        let response = minimum_phase(rest, rate_hz);
        let hankel =
            |shift: usize| DMatrix::from_fn(HANKEL, HANKEL, |i, j| response[i + j + shift]);
        let parts = hankel(0).svd(true, true);
        Self {
            shifted: hankel(1),
            left: parts.u.unwrap_or_default(),
            right: parts.v_t.unwrap_or_default(),
            values: parts.singular_values,
        }
    }

    /// Most states that make sense.
    pub const MOST: usize = 40;

    /// The system of `order` states; `None` if truncation made it unstable.
    pub fn truncated(&self, order: usize, name: &str) -> Option<StateSpace> {
        let root = |k: usize| self.values[k].sqrt();
        let left = self.left.columns(0, order);
        let right = self.right.rows(0, order);
        let mut f = left.transpose() * &self.shifted * right.transpose();
        for i in 0..order {
            for j in 0..order {
                f[(i, j)] /= root(i) * root(j);
            }
        }
        let stable = f.complex_eigenvalues().iter().all(|one| one.norm() < 1.0);
        let system = StateSpace {
            f,
            g: DMatrix::from_fn(order, 1, |i, _| root(i) * right[(i, 0)]),
            h: DVector::from_fn(order, |j, _| root(j) * left[(0, j)]),
            q: DVector::from_element(1, 1.0),
            x0: DVector::zeros(order),
            p0: DMatrix::zeros(order, order),
            names: (1..=order).map(|k| format!("{name} {k}")).collect(),
        };
        stable.then(|| system.settled())
    }
}

/// Impulse response of the minimum-phase filter with the power `power` at `rate_hz`.
fn minimum_phase(power: impl Fn(f64) -> f64, rate_hz: f64) -> Vec<f64> {
    let at = |bin: usize| {
        // Nothing is asked at zero itself, where a spectrum may be zero or infinite.
        let bin = (bin.min(GRID - bin) as f64).max(0.5);
        power(bin / GRID as f64 * rate_hz)
    };
    let powers: Vec<f64> = (0..GRID).map(at).collect();
    let floor = FLOOR * powers.iter().copied().fold(0.0, f64::max);
    let mut cepstrum: Vec<Complex<f64>> = powers
        .iter()
        .map(|power| Complex::from(0.5 * power.max(floor).ln()))
        .collect();
    let mut planner = FftPlanner::new();
    let (forward, inverse) = (
        planner.plan_fft_forward(GRID),
        planner.plan_fft_inverse(GRID),
    );
    inverse.process(&mut cepstrum);
    // The even cepstrum folded onto times above zero has the same real transform.
    for (time, value) in cepstrum.iter_mut().enumerate() {
        let weight = match time {
            0 => 1.0,
            _ if time == GRID / 2 => 1.0,
            _ if time < GRID / 2 => 2.0,
            _ => 0.0,
        };
        *value *= weight / GRID as f64;
    }
    forward.process(&mut cepstrum);
    for value in &mut cepstrum {
        *value = value.exp() / GRID as f64;
    }
    inverse.process(&mut cepstrum);
    cepstrum.iter().map(|value| value.re).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rational_spectrum_is_found_exactly() {
        // (1 - 0.9/z) / (1 - 0.5/z), minimum phase, at one sample a second.
        let power = |f: f64| {
            let turn = Complex::from_polar(1.0, -TAU * f);
            ((1.0 - turn * 0.9) / (1.0 - turn * 0.5)).norm_sqr()
        };
        let factor = Factor::new(power, &[], 1.0);
        let system = factor.truncated(2, "x").expect("a stable system");
        let mut state = system.g.column(0).into_owned();
        for expected in [1.0, -0.4, -0.2, -0.1, -0.05] {
            let found = system.h.dot(&state);
            assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
            state = &system.f * state;
        }
    }
}
