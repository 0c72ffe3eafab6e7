//! Generalised covariances of discrete noises, summed once and twice, and of their differences.

use super::Noise;
use crate::Statistic;

/// Covariance of two differences `lag` samples apart, up to a factor that depends on `m` alone.
pub(super) fn covariance(statistic: Statistic, noise: Noise, m: u64, lag: u64) -> f64 {
    let (m_float, t) = (m as f64, lag as f64 / m as f64);
    let discrete = 1.0 / (m_float * m_float);
    match (statistic, noise) {
        (Statistic::Modified, _) => central_difference(3, t, |t| summed_twice(noise, t, discrete)),
        (Statistic::Allan, _) => central_difference(2, t, |t| summed(noise, t, discrete)),
        (Statistic::Hadamard, _) => central_difference(3, t, |t| summed(noise, t, discrete)),
    }
}

/// The central difference of order `2 * order` of an even function with unit step, times
/// `(-1)^order`: the covariance of differences of that order from a generalised covariance.
fn central_difference(order: u8, t: f64, f: impl Fn(f64) -> f64) -> f64 {
    let pair = |shift: f64| f((t - shift).abs()) + f((t + shift).abs());
    match order {
        2 => 6.0 * f(t.abs()) - 4.0 * pair(1.0) + pair(2.0),
        _ => 20.0 * f(t.abs()) - 15.0 * pair(1.0) + 6.0 * pair(2.0) - pair(3.0),
    }
}

/// Generalised covariance of the sum `S` at distance `t >= 0` averaging times;
/// `discrete` is `1 / m^2`.
fn summed(noise: Noise, t: f64, discrete: f64) -> f64 {
    match noise {
        // White: 1 at distance zero. Distances that differ from zero differ by 1/m at least.
        Noise::Quantisation => f64::from(t * t < 0.25 * discrete),
        // One-fold sum of white noise.
        Noise::White => -t,
        Noise::Flicker => flicker_summed(t, discrete),
        // Two-fold sum: (k^3 - k) / 6 for whole k.
        Noise::Walk => t * t * t - t * discrete,
    }
}

/// Generalised covariance of `W`, the sum of `S`.
fn summed_twice(noise: Noise, t: f64, discrete: f64) -> f64 {
    match noise {
        Noise::Quantisation => -t,
        Noise::White => t * t * t - t * discrete,
        Noise::Flicker => flicker_summed_twice(t, discrete),
        // Three-fold sum: -(k^5 - 5 k^3 + 4 k) / 120 for whole k.
        Noise::Walk => {
            let square = t * t;
            -t * (square * square - discrete * (5.0 * square - 4.0 * discrete))
        }
    }
}

/// Covariance of the sum of discrete flicker noise.
///
/// The noise's own is `-2 sum_{i<=k} 2/(2i-1)`, up to a factor and a constant. Its second sum is
/// `(k^2 - 1/4) ln k - 17/(960 k^2) + O(k^-4)`, and a number at `k = 0` that we computed from the
/// recurrence to 16 digits. In units of `m`, the part `(k^2 - 1/4) ln m` is an even polynomial that
/// the differences annihilate; where `ln k` is absent, at 0, it stays.
fn flicker_summed(t: f64, discrete: f64) -> f64 {
    const AT_ZERO: f64 = 0.449_210_839_838_689_2;
    if t * t < 0.25 * discrete {
        // ln m = -ln(discrete) / 2.
        return discrete * (AT_ZERO - 0.125 * libm::log(discrete));
    }
    let square = t * t;
    (square - 0.25 * discrete) * libm::log(t) - 17.0 / 960.0 * discrete * discrete / square
}

/// Covariance of the twofold sum of discrete flicker noise: minus the second sum of
/// [`flicker_summed`], `(k^4/12 - 5 k^2/24 + 3/64) ln k + O(k^-2)`, treated likewise.
fn flicker_summed_twice(t: f64, discrete: f64) -> f64 {
    const AT_ZERO: f64 = -0.082_751_338_025_431_89;
    const INVERSE_SQUARE: f64 = 0.003_792_565_412;
    if t * t < 0.25 * discrete {
        return -discrete * discrete * (AT_ZERO + 1.5 / 64.0 * libm::log(discrete));
    }
    let square = t * t;
    let polynomial =
        square * (square / 12.0 - 5.0 / 24.0 * discrete) + 3.0 / 64.0 * discrete * discrete;
    -polynomial * libm::log(t) - INVERSE_SQUARE * discrete * discrete * discrete / square
}
