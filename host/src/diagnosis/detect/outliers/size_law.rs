//! How many outliers there are, and how large, those too small to be seen included.

use statrs::distribution::{Continuous, ContinuousCDF, Normal};

use crate::diagnosis::record::wave::Outlier;

/// Outliers from which their law is looked for: a choice. The logarithm of the mean square of five
/// scatters by 63 %.
const LEAST_OUTLIERS: usize = 5;

/// Law of all outliers among the samples that were looked at, those too small to be seen included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SizeLaw {
    /// How many outliers there are.
    pub count: f64,
    /// Standard deviation of the logarithm of their number.
    pub count_log_sd: f64,
    /// Root mean square of their sizes.
    pub size: f64,
    /// Standard deviation of its logarithm.
    pub size_log_sd: f64,
}

/// Normal sizes, seen from `threshold` up: the mean square of those seen gives the law's variance,
/// and that the share which is seen (A. C. Cohen, *Truncated and Censored Samples*, 1991, ch. 2). There are no more
/// than the `samples` that were looked at. `None` of too few to say how many more there are below the threshold.
pub fn law_of(seen: &[Outlier], threshold: f64, samples: usize) -> Option<SizeLaw> {
    if seen.len() < LEAST_OUTLIERS {
        return None;
    }
    let normal = Normal::standard();
    let count = seen.len() as f64;
    let square = seen.iter().map(|one| one.size * one.size).sum::<f64>() / count;
    let own = seen
        .iter()
        .map(|one| one.size_sd * one.size_sd)
        .sum::<f64>()
        / count;
    // Mean square beyond the threshold for a variance.
    let beyond = |variance: f64| {
        let t = threshold / variance.sqrt();
        variance * (1.0 + t * normal.pdf(t) / normal.sf(t).max(f64::MIN_POSITIVE))
    };
    // All samples would be outliers if so many deviations were the threshold.
    let most = -normal.inverse_cdf(0.5 * count / samples as f64);
    let (mut low, mut high) = ((threshold / most).powi(2).min(square), square);
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        if beyond(middle) > square {
            high = middle;
        } else {
            low = middle;
        }
    }
    let variance = (low * high).sqrt();
    let share = |variance: f64| 2.0 * normal.sf(threshold / variance.sqrt());
    let step = 1.01_f64;
    let slope = (beyond(variance * step) / beyond(variance / step)).ln() / (2.0 * step.ln());
    let fourth = seen.iter().map(|one| one.size.powi(4)).sum::<f64>() / count;
    let square_log_sd = ((fourth / (square * square) - 1.0).max(0.1) / count).sqrt();
    let variance_log_sd = square_log_sd / slope.max(0.05);
    let share_slope = (share(variance * step) / share(variance / step)).ln() / (2.0 * step.ln());
    Some(SizeLaw {
        count: count / share(variance),
        count_log_sd: count.sqrt().recip().hypot(share_slope * variance_log_sd),
        size: (variance - own).max(0.01 * variance).sqrt(),
        size_log_sd: 0.5 * variance_log_sd,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_no_more_of_them_than_samples() {
        // All of one size, just beyond the threshold: no normal law is so steep.
        let seen: Vec<Outlier> = (0..14)
            .map(|index| Outlier {
                index,
                size: 5.01,
                size_sd: 0.1,
            })
            .collect();
        for samples in [9263, 1 << 20] {
            let law = law_of(&seen, 5.0, samples).expect("fourteen are enough");
            assert!(law.count <= 1.001 * samples as f64, "{law:?} of {samples}");
            assert!(law.count > 100.0 && law.size < 5.0, "{law:?} of {samples}");
        }
    }

    #[test]
    fn of_fewer_than_five_no_law_is_told() {
        let seen = [8.0, -9.0, 7.0, 6.0, -10.0].map(|size| Outlier {
            index: 0,
            size,
            size_sd: 0.1,
        });
        assert!(law_of(&seen, 5.0, 10_000).is_some());
        assert_eq!(law_of(&seen[1..], 5.0, 10_000), None);
    }
}
