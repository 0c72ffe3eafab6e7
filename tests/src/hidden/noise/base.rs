//! Five-term noise (Pavlov and Petrov eq. 8): what every record holds beside what is hidden.

use std::f64::consts::{LN_2, PI, TAU};

use crate::hidden::draw::Draw;

/// The five coefficients of one axis, in m/s^2 and seconds, and its mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Base {
    /// Rate ramp, m/s^3.
    pub r: f64,
    /// Rate random walk, m/s^2/sqrt(s).
    pub k: f64,
    /// Bias instability, m/s^2.
    pub b: f64,
    /// Velocity random walk, m/s/sqrt(s).
    pub n: f64,
    /// Quantisation, m/s.
    pub q: f64,
    /// Mean level, m/s^2.
    pub mean: f64,
}

/// Centres of the ranges drawn from: (R, K, B, N, Q).
const REGIMES: [[f64; 5]; 3] = [
    // About the published table, whose quantisation rules above 3 Hz.
    [5e-8, 3e-5, 5e-5, 1e-4, 2e-4],
    // About an ADIS16405's accelerometers.
    [2e-7, 3e-4, 3.5e-3, 4e-3, 3e-5],
    // About the white noise in the MMA7331L's data sheet.
    [1e-7, 1e-4, 8e-4, 2.4e-3, 2e-5],
];

impl Base {
    /// One of three regimes, each coefficient within a factor of three of its centre. White
    /// noise is always there; every other term is left out in one record of four, the ramp in
    /// one of two. The mean is 1 g or a zero-g offset.
    pub fn draw(draw: &mut Draw) -> Self {
        let centre = draw.pick(&REGIMES);
        let mut about = |index: usize, present: f64| {
            let value = centre[index] * draw.log_uniform(1.0 / 3.0, 3.0);
            if draw.chance(present) { value } else { 0.0 }
        };
        let (r, k, b, n, q) = (
            about(0, 0.5),
            about(1, 0.75),
            about(2, 0.75),
            about(3, 1.0),
            about(4, 0.75),
        );
        let mean = if draw.chance(0.5) {
            9.8 + 0.02 * draw.normal()
        } else {
            0.3 * draw.normal()
        };
        Self {
            r: r * draw.sign(),
            k,
            b,
            n,
            q,
            mean,
        }
    }

    /// Allan variance in continuous time, without the ramp (eq. 8).
    pub fn allan_variance(&self, tau_s: f64) -> f64 {
        self.k.powi(2) * tau_s / 3.0
            + self.b.powi(2) * 2.0 * LN_2 / PI
            + self.n.powi(2) / tau_s
            + 3.0 * (self.q / tau_s).powi(2)
    }

    /// The squares of K, B, N, Q: factors of [`densities`].
    pub fn squares(&self) -> [f64; 4] {
        [self.k, self.b, self.n, self.q].map(|value| value * value)
    }
}

/// Two-sided densities per unit square of K, B, N, Q at `f_hz`, per hertz.
///
/// `sampled`: those of the discrete processes (walk as a sum, quantisation as a difference of
/// white samples); otherwise those ahead of a chain that keeps what lies above half the rate
/// out. Flicker is B^2/(2 pi f) either way.
pub fn densities(f_hz: f64, rate_hz: f64, sampled: bool) -> [f64; 4] {
    let omega_squared = if sampled {
        (2.0 * rate_hz * (PI * f_hz / rate_hz).sin()).powi(2)
    } else {
        (TAU * f_hz).powi(2)
    };
    [
        1.0 / omega_squared,
        1.0 / (TAU * f_hz),
        1.0,
        omega_squared / rate_hz,
    ]
}
