//! The likelihood ratio's reach: from non-centrality to the probability of success.

use statrs::distribution::{ChiSquared, ContinuousCDF as _, Discrete as _, Normal, Poisson};

/// False alarms of a whole diagnosis on a clean record.
pub const FAMILY_LEVEL: f64 = 0.005;

/// What is asked of the ideal detector at the smallest strength drawn.
pub const POWER: f64 = 0.99;

/// How often the likelihood ratio may prefer the nearest rival there.
pub const RIVAL_ERROR: f64 = 0.01;

/// What an ideal detector achieves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Probability that it sees the effect at [`FAMILY_LEVEL`].
    pub power: f64,
    /// Probability that the likelihood ratio prefers the nearest rival.
    pub rival_error: f64,
}

impl Evidence {
    /// Seen with this probability, and no rival considered.
    pub fn power(power: f64) -> Self {
        Self {
            power,
            rival_error: 0.0,
        }
    }

    /// Together with what another requirement says: the worse of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            power: self.power.min(other.power),
            rival_error: self.rival_error.max(other.rival_error),
        }
    }

    /// Strong enough to be drawn.
    pub fn suffices(self) -> bool {
        self.power >= POWER && self.rival_error <= RIVAL_ERROR
    }
}

/// Mean and variance of twice a log-likelihood ratio under the truth. A shift of the mean of
/// Gaussian data by a non-centrality `l` has mean `l` and variance `4 l`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contrast {
    /// Twice the divergence.
    pub mean: f64,
    /// Variance.
    pub variance: f64,
}

impl Contrast {
    /// Of a known shape of this non-centrality.
    pub fn shift(non_centrality: f64) -> Self {
        Self {
            mean: non_centrality,
            variance: 4.0 * non_centrality,
        }
    }

    /// Probability that the ratio exceeds the threshold of a search over `parameters` fitted
    /// parameters and `trials` independent places, at the family level. Normal approximation.
    pub fn power(self, parameters: f64, trials: f64) -> f64 {
        let threshold = threshold(parameters, trials);
        let deviation = (2.0 * parameters + self.variance).sqrt();
        normal((self.mean + parameters - threshold) / deviation)
    }

    /// Probability that the ratio prefers the rival. Normal approximation.
    pub fn error(self) -> f64 {
        if self.mean <= 0.0 {
            return 1.0;
        }
        normal(-self.mean / self.variance.sqrt())
    }
}

/// Probability that a chi-squared statistic with `parameters` degrees of freedom and this
/// non-centrality exceeds the threshold of a search over `trials` independent places: a sum
/// over Poisson weights (Johnson, Kotz and Balakrishnan 1995, eq. 29.2).
pub fn power(non_centrality: f64, parameters: f64, trials: f64) -> f64 {
    if non_centrality > 2000.0 {
        return 1.0;
    }
    let threshold = threshold(parameters, trials);
    if non_centrality <= 0.0 {
        return tail(parameters, threshold);
    }
    let half = 0.5 * non_centrality;
    let Ok(weights) = Poisson::new(half) else {
        return 0.0;
    };
    let reach = 8.0 * half.sqrt() + 20.0;
    let from = (half - reach).max(0.0) as u64;
    (from..=(half + reach) as u64)
        .map(|j| weights.pmf(j) * tail(parameters + 2.0 * j as f64, threshold))
        .sum()
}

/// Probability that a Poisson count of this mean is at least `least`.
pub fn at_least(least: u64, mean: f64) -> f64 {
    let Ok(count) = Poisson::new(mean.max(1e-12)) else {
        return 0.0;
    };
    1.0 - (0..least).map(|k| count.pmf(k)).sum::<f64>()
}

/// What chi-squared with `parameters` degrees of freedom exceeds with [`FAMILY_LEVEL`] over
/// `trials`.
pub fn threshold(parameters: f64, trials: f64) -> f64 {
    let level = FAMILY_LEVEL / trials.max(1.0);
    let (mut lo, mut hi) = (0.0, 1000.0);
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if tail(parameters, middle) > level {
            lo = middle;
        } else {
            hi = middle;
        }
    }
    hi
}

fn tail(parameters: f64, at: f64) -> f64 {
    ChiSquared::new(parameters).map_or(1.0, |law| law.sf(at))
}

fn normal(at: f64) -> f64 {
    Normal::standard().cdf(at)
}
