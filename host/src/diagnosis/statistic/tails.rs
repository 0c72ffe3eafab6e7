//! Tails: how improbable a power is, as a normal number, and how much wider than those the record's own are.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::numeric::order::quantile;

/// Share of the parts of a record that may hold events: a choice.
const WITH_EVENTS: f64 = 0.25;

/// Neighbouring ordinates under Hann's taper are correlated: a sum over many scatters as one of fewer by this
/// factor, `1 + 2 (4/9 + 1/36)`.
const CORRELATED: f64 = 1.944_444;

/// Variance of the cube root of the mean of `count` powers.
pub fn narrow(count: usize) -> f64 {
    let freedom = 2.0 * (count as f64 / CORRELATED).max(1.0);
    2.0 / (9.0 * freedom)
}

/// A mean of powers as a normal number of as small a probability: its cube root is nearly normal (E. B. Wilson and
/// M. M. Hilferty, Proc. Natl. Acad. Sci. 17 (1931) 684).
pub fn normal_of_mean(mean: f64, narrow: f64) -> f64 {
    (mean.cbrt() - (1.0 - narrow)) / narrow.sqrt()
}

/// How much wider than a normal law's the upper tail of some scores is, which `normal` makes normal numbers, in those
/// `parts` of the record where it is narrowest; 1 at least.
pub fn tail(mut parts: Vec<Vec<f64>>, normal: impl Fn(f64) -> f64) -> f64 {
    /// Numbers beyond the place in the tail that is looked at, at least: a choice. Fewer than these would be
    /// events, or chance.
    const BEYOND: f64 = 12.0;
    let highest = |part: &Vec<f64>| part.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    parts.sort_by(|a, b| highest(a).total_cmp(&highest(b)));
    let kept = ((1.0 - WITH_EVENTS) * parts.len() as f64).ceil() as usize;
    let mut values = parts[..kept.max(1)].concat();
    let count = values.len() as f64;
    let shares = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];
    let wider = shares.iter().filter(|share| count * **share >= BEYOND);
    let wider = wider.map(|share| {
        let here = normal(quantile(&mut values, 1.0 - share).unwrap_or(0.0));
        here / Normal::standard().inverse_cdf(1.0 - share)
    });
    wider.fold(1.0, f64::max)
}

/// The normal number that is exceeded with the probability `e^log`.
pub fn normal_of_log(log: f64) -> f64 {
    /// Below it the tail of the normal law is that of its first term, to 2 % of `z`.
    const FAR: f64 = -12.0;
    if log > FAR {
        return -Normal::standard().inverse_cdf(log.exp().min(1.0 - 1e-12));
    }
    let square = -2.0 * log - std::f64::consts::TAU.ln();
    // z^2 + ln z^2 = square, by fixed points.
    let mut z2 = square;
    for _ in 0..4 {
        z2 = square - z2.ln();
    }
    z2.sqrt()
}

/// How slowly rare heights of a record become rarer: those below the highest ones say how far the highest go by chance.
///
/// Half a normal number's square is the nats that its probability falls by, `e^-t`. Noise whose strength wanders falls
/// by `t` over `slower` beyond the height `from`, and so does the chance of what stands out of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rare {
    from: f64,
    slower: f64,
}

impl Rare {
    /// Heights that may be events, and heights below them that the fall is taken from: choices. A hundred and twenty
    /// spacings know it to 9 %.
    const EVENTS: usize = 40;
    const LAST: usize = 160;

    /// Of the heights of places that do not touch; `None` where they are too few.
    pub fn of(mut heights: Vec<f64>) -> Option<Self> {
        heights.sort_by(|a, b| b.total_cmp(a));
        let nats: Vec<f64> = heights
            .get(Self::EVENTS - 1..Self::LAST)?
            .iter()
            .map(|z| 0.5 * z * z)
            .collect();
        // Spacings of an exponential law, each times its rank, are of its scale (A. Renyi, Acta Math. Acad. Sci. Hung.
        // 4 (1953) 191).
        let spacings = nats.windows(2).zip(Self::EVENTS..);
        let sum: f64 = spacings
            .map(|(pair, rank)| rank as f64 * (pair[0] - pair[1]))
            .sum();
        Some(Self {
            from: nats[0],
            slower: (sum / (Self::LAST - Self::EVENTS) as f64).max(1.0),
        })
    }

    /// The normal number of as small a probability as a height's.
    pub fn normal(self, z: f64) -> f64 {
        let beyond = (0.5 * z * z - self.from).max(0.0);
        if z > 0.0 && beyond > 0.0 {
            (2.0 * (self.from + beyond / self.slower)).sqrt()
        } else {
            z
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_far_out_are_normal_numbers() {
        for z in [-1.0, 0.5, 3.0, 4.5, 5.5, 8.0, 20.0, 35.0] {
            let log = Normal::standard().sf(z).ln();
            let back = normal_of_log(log);
            assert!((back - z).abs() < 0.03, "{z}: {back}");
        }
    }

    /// Normal heights are left as they are; those of noise whose strength wanders are no rarer than they come.
    #[test]
    fn what_is_common_is_not_rare() {
        use crate::model::random::{Gaussian, Generator, Seed};
        let normal = |stream: u64| {
            let mut values = vec![0.0; 8000];
            Gaussian::new(Seed { seed: 7, stream }, 1.0).add_to(&mut values);
            values
        };
        let plain = Rare::of(normal(1)).expect("enough");
        // The fall is known to 9 %, its logarithm's share of 6 to 8 deviations to half of that.
        assert!((plain.normal(8.0) / 8.0 - 1.0).abs() < 0.15, "{plain:?}");
        // A product of two normal numbers: e^-z instead of e^(-z^2 / 2).
        let products = normal(2).into_iter().zip(normal(3)).map(|(a, b)| a * b);
        let wild = Rare::of(products.collect()).expect("enough");
        // 12 is as rare as 4.8. The fall flattens on beyond the heights that it is taken from: most of the way.
        let z = wild.normal(12.0);
        assert!((4.8..8.8).contains(&z), "{z} by {wild:?}");
        assert_eq!(wild.normal(1.0), 1.0);
        assert!(Rare::of(vec![5.0; 100]).is_none());
    }
}
