//! Whether noise is as often large on one side as on the other.
//!
//! The whitened record `z` of Gaussian noise is independent standard normal. The score
//!
//! ```text
//! s = sin(t z) - t e^(-t^2 / 2) z,    var s = (1 - e^(-2 t^2)) / 2 - t^2 e^(-t^2)
//! ```
//!
//! has mean zero for every symmetric law and is orthogonal to the level; it is bounded, so that
//! single outliers do not decide (after T. W. Epps and L. B. Pulley, Biometrika 70 (1983)). At
//! `t` = 1.2 it keeps 90 % of the efficiency of the third moment.

use realfft::num_complex::Complex64;

use super::axis::AxisState;
use super::tail;

/// Argument of the sine.
const T: f64 = 1.2;

/// How lopsided the noise of an axis is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lopsided {
    /// Skewness that would make as large a score, for a small one.
    pub skewness: f64,
    /// Probability of as large a score in symmetric noise.
    pub p_value: f64,
}

/// Of what is left of an axis.
pub fn lopsided(axis: &AxisState) -> Lopsided {
    let seen = axis.whole();
    let white = seen
        .whole
        .filtered(|k| Complex64::new(seen.density[k].sqrt().recip(), 0.0));
    let counted = || {
        (0..white.len())
            .filter(|&n| axis.usable(n))
            .map(|n| white[n])
    };
    let count = counted().count() as f64;
    let deviation = (counted().map(|z| z * z).sum::<f64>() / count.max(1.0)).sqrt();
    let square = T * T;
    let linear = T * (-0.5 * square).exp();
    let score = |z: f64| (T * z).sin() - linear * z;
    let mean = counted().map(|z| score(z / deviation)).sum::<f64>() / count.max(1.0);
    let variance = 0.5 * (1.0 - (-2.0 * square).exp()) - square * (-square).exp();
    Lopsided {
        // To first order in the skewness the mean of sin(t z) is -t^3 e^(-t^2 / 2) skewness / 6.
        skewness: -6.0 * mean / (square * linear),
        p_value: tail::two_sided(mean * (count / variance).sqrt()),
    }
}
