//! What an integrated error takes from every frequency of the noise.
//!
//! The bias is the mean over `c` samples before the start; it is taken out, and the rest is summed
//! over `n` samples. In units of samples,
//!
//! ```text
//! velocity:  v = sum_{k=0}^{n-1} y_k            -  n       mean(y_-c .. y_-1)
//! position:  p = sum_{k=0}^{n-1} (n-k-1/2) y_k  -  n^2 / 2 mean(y_-c .. y_-1)
//! ```
//!
//! and the variance of either is the integral of the density times the square of the weights'
//! transform.

use std::f64::consts::PI;

use rustfft::num_complex::Complex;

/// Which integral of the signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integral {
    /// The first: velocity of an accelerometer, angle of a gyroscope.
    Velocity,
    /// The second: position of an accelerometer.
    #[allow(
        dead_code,
        reason = "docs/explanation/noise-model.md gives its law; no report shows it yet"
    )]
    Position,
}

/// Weights of the samples in an integrated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// Which integral.
    pub integral: Integral,
    /// Samples of the bias.
    pub c: f64,
    /// Samples integrated.
    pub n: f64,
}

/// Half turns over the whole sum below which the odd sum is taken from its series, relative
/// error 1e-7.
const SMALL: f64 = 1e-3;

impl Weights {
    /// Square of the transform of the weights at `x = pi f / rate`.
    pub fn power(&self, x: f64) -> f64 {
        let turn = |samples: f64| Complex::from_polar(1.0, -2.0 * x * samples);
        let even = |count: f64| (count * x).sin() / x.sin();
        // Centred sums, then moved to where they are.
        let bias = turn(-0.5 * (self.c + 1.0)) * (even(self.c) / self.c);
        let centre = turn(0.5 * (self.n - 1.0));
        let weights = match self.integral {
            Integral::Velocity => centre * even(self.n) - bias * self.n,
            Integral::Position => {
                let sum = Complex::new(0.5 * self.n * even(self.n), odd(self.n, x));
                centre * sum - bias * (0.5 * self.n * self.n)
            }
        };
        weights.norm_sqr()
    }

    /// The same averaged over its oscillation: what remains are the jumps of the weights, at the
    /// start of the bias, where it ends and the integral begins, and at the end.
    pub fn mean_power(&self, x: f64) -> f64 {
        let (first, last, bias) = match self.integral {
            Integral::Velocity => (1.0, 1.0, self.n / self.c),
            Integral::Position => (self.n, 0.0, 0.5 * self.n * self.n / self.c),
        };
        let jumps = bias * bias + (bias + first).powi(2) + last * last;
        jumps / (4.0 * x.sin().powi(2))
    }
}

/// `sum j sin(2 x j)` over `count` numbers `j` one apart about zero.
fn odd(count: f64, x: f64) -> f64 {
    if count * x < SMALL {
        return count * (count * count - 1.0) / 6.0 * x;
    }
    let (sine, cosine) = x.sin_cos();
    let (sine_n, cosine_n) = (count * x).sin_cos();
    0.5 * (sine_n * cosine - count * cosine_n * sine) / (sine * sine)
}

/// Frequency in the middle of panels is below half the rate, where the sine is not zero.
pub(super) fn x(f_hz: f64, rate_hz: f64) -> f64 {
    PI * f_hz / rate_hz
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_are_those_of_the_weights_one_by_one() {
        for integral in [Integral::Velocity, Integral::Position] {
            for (c, n) in [(3, 7), (20, 5), (1, 1)] {
                let weights = Weights {
                    integral,
                    c: f64::from(c),
                    n: f64::from(n),
                };
                let (n, c) = (f64::from(n), f64::from(c));
                for x in [1e-5, 1e-3, 0.02, 0.3, 1.5] {
                    let turn = |k: f64| Complex::from_polar(1.0, -2.0 * x * k);
                    let mut sum = Complex::from(0.0);
                    for k in 0..n as i32 {
                        let k = f64::from(k);
                        sum += turn(k)
                            * match integral {
                                Integral::Velocity => 1.0,
                                Integral::Position => n - k - 0.5,
                            };
                    }
                    let bias = match integral {
                        Integral::Velocity => n,
                        Integral::Position => 0.5 * n * n,
                    };
                    for k in 1..=c as i32 {
                        sum -= turn(-f64::from(k)) * bias / c;
                    }
                    let (found, expected) = (weights.power(x), sum.norm_sqr());
                    assert!(
                        (found - expected).abs() < 1e-9 * expected.max(1e-9),
                        "{weights:?} at {x}: {found} for {expected}"
                    );
                }
            }
        }
    }
}
