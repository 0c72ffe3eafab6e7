//! Equivalent degrees of freedom of an Allan, modified Allan or Hadamard variance.
//!
//! An estimate `v` that averages `M` squared, correlated Gaussian differences is distributed
//! nearly as `chi^2(edf) * E[v] / edf` with `edf = 2 E[v]^2 / Var[v]`, and for Gaussian differences
//! whose autocorrelation at distance `k` samples is `rho(k)`
//!
//! ```text
//! M / edf = 1 + 2 sum_{j=1}^{M-1} (1 - j/M) rho(j * stride)^2
//! ```
//!
//! (C. A. Greenhall and W. J. Riley, "Uncertainty of stability variances based on finite
//! differences", PTTI 2003, eq. 11 to 14.) `rho` follows from a generalised covariance of the
//! summed signal: a function that differs from the covariance by an even polynomial which the
//! differences annihilate. Greenhall and Riley take the noise as continuous in time and average
//! it; the samples here are what defines the noise, so the covariances below are those of the
//! discrete processes, exact for quantisation, white and walk noise at every `m` and `stride`.
//! Flicker noise is white noise integrated fractionally, of order 1/2 (N. J. Kasdin, Proc. IEEE 83
//! (1995) 802); its covariance has an expansion that is within 0.4 % of exact at `m = 1` and
//! converges fast above, where it tends to Greenhall and Riley's `t^2 ln|t|`.

mod covariance;

use crate::Statistic;
use covariance::covariance;

/// A power-law noise of the signal, by the slope of its spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Noise {
    /// Differenced white noise, as quantisation of the integral gives; the summed signal is white.
    Quantisation,
    /// White noise of the signal (velocity random walk in an accelerometer).
    White,
    /// 1/f noise of the signal (bias instability).
    Flicker,
    /// Random walk of the signal (rate random walk).
    Walk,
}

impl Noise {
    /// All noise types, in the order of falling `alpha`.
    pub const ALL: [Self; 4] = [Self::Quantisation, Self::White, Self::Flicker, Self::Walk];

    /// The exponent of frequency in the signal's spectrum: +2, 0, -1, -2.
    #[must_use]
    pub fn alpha(self) -> i32 {
        match self {
            Self::Quantisation => 2,
            Self::White => 0,
            Self::Flicker => -1,
            Self::Walk => -2,
        }
    }
}

/// Steps an averaging time into which long sums over smooth autocorrelations are thinned.
const STEPS_PER_TAU: u64 = 128;

/// Averaging times after which the autocorrelation's square is neglected. Only flicker noise
/// reaches that far: there `rho^2` falls at least as fast as `(tau/t)^4` and is below 1e-4 at 6.
const REACH_TAUS: u64 = 8;

/// Equivalent degrees of freedom of an estimate from `terms` differences `stride` samples apart
/// in one run of samples, at averaging factor `m`.
///
/// Exact for quantisation, white and walk noise while `m / stride` is at most 128; beyond, the sum
/// is thinned to 128 steps an averaging time, within 2e-4 of exact. For flicker noise the
/// neglected tail adds at most 1e-3. `terms` differences spread over several runs between gaps
/// have slightly more degrees of freedom than reported, since they overlap less.
///
/// Returns 0 if `m`, `stride` or `terms` is 0.
#[must_use]
pub fn edf(statistic: Statistic, noise: Noise, m: u64, stride: u64, terms: u64) -> f64 {
    if m == 0 || stride == 0 || terms == 0 {
        return 0.0;
    }
    let at_zero = covariance(statistic, noise, m, 0);
    let squared = |lag: u64| {
        let rho = covariance(statistic, noise, m, lag) / at_zero;
        rho * rho
    };
    // Unsummed quantisation noise is correlated at whole multiples of m only, where thinning
    // would weigh it wrongly: add those lags one by one.
    if noise == Noise::Quantisation && statistic != Statistic::Modified {
        let sum: f64 = (1..=3)
            .map(|i| i * m)
            .filter(|lag| lag.is_multiple_of(stride) && lag / stride < terms)
            .map(|lag| (1.0 - (lag / stride) as f64 / terms as f64) * squared(lag))
            .sum();
        return terms as f64 / (1.0 + 2.0 * sum);
    }
    // Thinning by a whole factor keeps the sum's reach and treats it as an integral.
    let thin = (m / (stride.saturating_mul(STEPS_PER_TAU))).max(1);
    let terms = terms as f64 / thin as f64;
    let step = stride.saturating_mul(thin);
    let furthest = REACH_TAUS.saturating_mul(m) / step;
    let mut sum = 0.0;
    for j in 1..=furthest {
        let weight = 1.0 - j as f64 / terms;
        if weight <= 0.0 {
            break;
        }
        sum += weight * squared(j * step);
    }
    terms / (1.0 + 2.0 * sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    const STATISTICS: [Statistic; 3] = [Statistic::Allan, Statistic::Modified, Statistic::Hadamard];

    /// Weights of a difference on the white noise that drives the signal, most recent first,
    /// with the `history` samples before the difference included.
    fn impulse_response(statistic: Statistic, noise: Noise, m: usize, history: usize) -> Vec<f64> {
        // The difference as weights on the samples y.
        let block = |weights: &[f64]| -> Vec<f64> {
            weights
                .iter()
                .flat_map(|&w| std::iter::repeat_n(w, m))
                .collect()
        };
        let on_samples = match statistic {
            Statistic::Allan => block(&[1.0, -1.0]),
            Statistic::Hadamard => block(&[1.0, -2.0, 1.0]),
            Statistic::Modified => {
                let second = block(&[1.0, -1.0]);
                let mut sum = vec![0.0; 3 * m - 1];
                for shift in 0..m {
                    second
                        .iter()
                        .enumerate()
                        .for_each(|(i, w)| sum[i + shift] += w);
                }
                sum
            }
        };
        // The signal as weights on white noise; flicker by fractional integration of order 1/2
        // (N. J. Kasdin, Proc. IEEE 83 (1995) 802).
        let len = on_samples.len() + history;
        let shaping: Vec<f64> = match noise {
            Noise::Quantisation => vec![1.0, -1.0],
            Noise::White => vec![1.0],
            Noise::Walk => vec![1.0; len + 1],
            Noise::Flicker => {
                let mut h = vec![1.0];
                for k in 1..=len {
                    h.push(h[k - 1] * (k as f64 - 0.5) / k as f64);
                }
                h
            }
        };
        let mut response = vec![0.0; len + 1];
        for (i, w) in on_samples.iter().enumerate() {
            for (k, h) in shaping.iter().enumerate().take(len + 1 - i) {
                response[i + k] += w * h;
            }
        }
        response
    }

    /// `2 E^2 / Var` from the covariances of every pair of differences.
    fn direct(
        statistic: Statistic,
        noise: Noise,
        m: usize,
        stride: usize,
        terms: usize,
        history: usize,
    ) -> f64 {
        let response = impulse_response(statistic, noise, m, history);
        let covariance = |lag: usize| -> f64 {
            (lag..response.len())
                .map(|i| response[i] * response[i - lag])
                .sum()
        };
        let table: Vec<f64> = (0..terms).map(|j| covariance(j * stride)).collect();
        let mut variance = 0.0;
        for i in 0..terms {
            for j in 0..terms {
                variance += 2.0 * table[i.abs_diff(j)].powi(2);
            }
        }
        let mean = terms as f64 * table[0];
        2.0 * mean * mean / variance
    }

    #[test]
    #[cfg_attr(miri, ignore = "long sums of plain floating-point numbers")]
    fn equals_the_sum_over_all_pairs() {
        for statistic in STATISTICS {
            for noise in [Noise::Quantisation, Noise::White, Noise::Walk] {
                for (m, stride, terms) in [
                    (1, 1, 1),
                    (1, 1, 9),
                    (2, 1, 30),
                    (3, 1, 7),
                    (8, 2, 40),
                    (8, 8, 5),
                    (40, 1, 60),
                ] {
                    let expected = direct(statistic, noise, m, stride, terms, 0);
                    let value = edf(statistic, noise, m as u64, stride as u64, terms as u64);
                    let relative = value / expected - 1.0;
                    assert!(
                        relative.abs() < 1e-9,
                        "{statistic:?} {noise:?} m={m} stride={stride} terms={terms}: \
                         {value} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "long sums of plain floating-point numbers")]
    fn flicker_is_fractionally_integrated_noise() {
        // The sum over pairs truncates the noise's memory, which costs the last digits.
        for statistic in STATISTICS {
            for (m, stride, terms, tolerance) in [
                (1, 1, 50, 0.05),
                (4, 1, 50, 0.01),
                (16, 1, 100, 0.003),
                (40, 2, 60, 0.003),
            ] {
                let expected = direct(statistic, Noise::Flicker, m, stride, terms, 400 * m);
                let value = edf(
                    statistic,
                    Noise::Flicker,
                    m as u64,
                    stride as u64,
                    terms as u64,
                );
                let relative = value / expected - 1.0;
                assert!(
                    relative.abs() < tolerance,
                    "{statistic:?} m={m} stride={stride} terms={terms}: {value} {expected}"
                );
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "long sums of plain floating-point numbers")]
    fn thinning_does_not_show() {
        for statistic in STATISTICS {
            for noise in Noise::ALL {
                // The same record in units of tau, with and without thinning.
                for (fine, coarse) in [(1 << 20, 1 << 7), (1 << 10, (1 << 8) - 1)] {
                    let at = |m: u64| edf(statistic, noise, m, 1, 6 * m) / 6.0;
                    let (fine_edf, coarse_edf) = (at(fine), at(coarse));
                    if noise == Noise::Quantisation && statistic != Statistic::Modified {
                        let ratio = fine_edf / coarse_edf / (fine as f64 / coarse as f64);
                        assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
                        continue;
                    }
                    let relative = fine_edf / coarse_edf - 1.0;
                    assert!(
                        relative.abs() < 1e-3,
                        "{statistic:?} {noise:?} {fine}: {fine_edf} {coarse_edf}"
                    );
                }
            }
        }
    }

    #[test]
    fn one_difference_has_one_degree_of_freedom() {
        for statistic in STATISTICS {
            for noise in Noise::ALL {
                for m in [1, 40, 1 << 30] {
                    let value = edf(statistic, noise, m, m / 8 + 1, 1);
                    assert!(
                        (value - 1.0).abs() < 1e-12,
                        "{statistic:?} {noise:?} {m} {value}"
                    );
                }
            }
        }
        assert_eq!(edf(Statistic::Allan, Noise::White, 1, 1, 0), 0.0);
    }
}
