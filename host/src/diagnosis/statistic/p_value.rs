//! Probabilities beyond a statistic under the laws that the tests follow, and what a search over many places makes
//! of them.

use statrs::distribution::{
    ChiSquared, ContinuousCDF, Discrete, DiscreteCDF, Gamma, Hypergeometric, NegativeBinomial,
    Normal, Poisson,
};

use crate::numeric::bisect::bisect;

/// Probability of a standard normal beyond `z` on either side.
pub fn two_sided(z: f64) -> f64 {
    2.0 * Normal::standard().sf(z.abs())
}

/// Probability of chi-squared with `freedom` degrees beyond `value`.
pub fn chi_squared(value: f64, freedom: f64) -> f64 {
    ChiSquared::new(freedom).map_or(1.0, |law| law.sf(value.max(0.0)))
}

/// Probability that a mean square of `freedom` degrees departs from 1 as far as `ratio`, on
/// either side.
pub fn mean_square(ratio: f64, freedom: f64) -> f64 {
    Gamma::new(0.5 * freedom, 0.5 * freedom).map_or(1.0, |law| {
        let one = if ratio > 1.0 {
            law.sf(ratio)
        } else {
            law.cdf(ratio.max(0.0))
        };
        (2.0 * one).min(1.0)
    })
}

/// Probability that a Poisson number of mean `mean` reaches `count`.
pub fn poisson(count: u64, mean: f64) -> f64 {
    let Ok(law) = Poisson::new(mean) else {
        return if count == 0 { 1.0 } else { 0.0 };
    };
    match count {
        0 => 1.0,
        _ => law.sf(count - 1).max(law.pmf(count)),
    }
}

/// Probability that a Poisson number reaches `count` whose mean is known by an estimate with some
/// `variance`: a mean of a gamma law makes it negative binomial.
pub fn counted(count: u64, mean: f64, variance: f64) -> f64 {
    if variance <= 0.0 {
        return poisson(count, mean);
    }
    let shape = mean * mean / variance;
    NegativeBinomial::new(shape, shape / (shape + mean)).map_or(1.0, |law| match count {
        0 => 1.0,
        _ => law.sf(count - 1),
    })
}

/// Probability that `count` or more of `trials` fall to one of two equal sides.
pub fn binomial_half(count: u64, trials: u64) -> f64 {
    statrs::distribution::Binomial::new(0.5, trials).map_or(1.0, |law| match count {
        0 => 1.0,
        _ => law.sf(count - 1),
    })
}

/// Probability that of `tries` drawn from `all`, of which some are `marked`, as many as `hits` are, or a number further from
/// what chance has, on either side: hypergeometric.
pub fn drawn(hits: usize, tries: usize, marked: usize, all: usize) -> f64 {
    let Ok(law) = Hypergeometric::new(all as u64, marked as u64, tries as u64) else {
        return 1.0;
    };
    let (share, tries, all) = (marked as f64 / all as f64, tries as f64, all as f64);
    let mean = tries * share;
    let variance = mean * (1.0 - share) * (all - tries) / (all - 1.0);
    if variance > NORMAL {
        return two_sided((hits as f64 - mean) / variance.sqrt());
    }
    let hits = hits as u64;
    let as_many = match hits {
        0 => 1.0,
        _ => law.sf(hits - 1),
    };
    (2.0 * as_many.min(law.cdf(hits))).min(1.0)
}

/// Variance from which a number is as good as normal: its skewness is below 0.03.
const NORMAL: f64 = 1000.0;

/// Probability that the best of `trials` chances falls below `p`, each of them doing so with
/// probability `p`: Bonferroni's bound.
pub fn searched(p: f64, trials: f64) -> f64 {
    (p * trials.max(1.0)).min(1.0)
}

/// Probability that a stationary Gaussian series of `len` samples exceeds `z` in size anywhere:
/// the smaller of the bound by samples and, for smooth series with `crossings` zero crossings in
/// one direction a sample, the one by S. O. Rice, Bell Syst. Tech. J. 24 (1945), eq. 3.3-14.
pub fn highest(z: f64, len: usize, crossings: f64) -> f64 {
    let one = two_sided(z);
    let by_sample = len as f64 * one;
    let by_crossing = one + 2.0 * len as f64 * crossings * (-0.5 * z * z).exp();
    by_sample.min(by_crossing).min(1.0)
}

/// Probability that the log-likelihood gains `nats` from a component of some size at the best of
/// the shapes on a path of `length` radians: R. B. Davies, Biometrika 74 (1987), eq. 3.1 for a size
/// that cannot be negative.
pub fn highest_on_path(nats: f64, length: f64) -> f64 {
    let nats = nats.max(0.0);
    let at_one_end = Normal::standard().sf((2.0 * nats).sqrt());
    (at_one_end + length / std::f64::consts::TAU * (-nats).exp()).min(1.0)
}

/// Gain that [`highest_on_path`] reaches with probability `level`, nats.
pub fn nats_on_path(level: f64, length: f64) -> f64 {
    bisect(0.0, 1000.0, 60, |nats| {
        highest_on_path(nats, length) > level
    })
}

/// Size that [`highest`] reaches with probability `level`.
pub fn threshold(level: f64, len: usize, crossings: f64) -> f64 {
    bisect(0.0, 40.0, 60, |z| highest(z, len, crossings) > level)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_quantiles() {
        // M. Abramowitz and I. Stegun, tables 26.1 and 26.8.
        assert!((two_sided(1.959_964) - 0.05).abs() < 1e-7);
        assert!((chi_squared(6.634_897, 1.0) - 0.01).abs() < 1e-7);
        assert!((poisson(3, 1.0) - 0.080_301_4).abs() < 1e-7);
        assert!((binomial_half(8, 10) - 56.0 / 1024.0).abs() < 1e-9);
    }

    #[test]
    fn the_threshold_has_its_level() {
        let z = threshold(1e-3, 1 << 20, 0.29);
        assert!((highest(z, 1 << 20, 0.29) / 1e-3 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_gain_that_a_name_needs_has_its_level() {
        for (level, length) in [(1e-4, 0.0), (1e-4, 12.0), (1e-9, 3.0)] {
            let found = highest_on_path(nats_on_path(level, length), length);
            assert!((found / level - 1.0).abs() < 1e-6, "{level} {length}");
        }
    }

    #[test]
    fn the_best_on_a_path_is_as_rare_as_it_says() {
        use crate::model::random::Gaussian;
        use crate::model::random::Seed;
        // The largest of a cos t + b sin t, 0 < t < length, for standard normal a and b, at a height
        // that few reach: the bound is within some percent there, 40 000 draws determine it to 5 %.
        let (length, nats, draws) = (1.5_f64, 4.0_f64, 40_000);
        let mut normal = Gaussian::new(Seed { seed: 5, stream: 0 }, 1.0);
        let mut higher = 0;
        for _ in 0..draws {
            let (a, b) = (normal.draw(), normal.draw());
            let top = b.atan2(a).clamp(0.0, length);
            let ends = f64::max(a, a * length.cos() + b * length.sin());
            let highest = ends.max(a * top.cos() + b * top.sin());
            higher += u32::from(highest > (2.0 * nats).sqrt());
        }
        let expected = highest_on_path(nats, length) * f64::from(draws);
        let sigma = expected.sqrt();
        assert!(
            (f64::from(higher) - expected).abs() < 4.0 * sigma,
            "{higher} of {expected} +- {sigma}, seed 5"
        );
    }
}
