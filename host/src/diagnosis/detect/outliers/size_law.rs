//! How many outliers there are, and how large, those too small to be seen included.

use statrs::distribution::{Continuous, ContinuousCDF, Normal};

use crate::diagnosis::record::wave::Outlier;

/// Outliers from which their law is looked for: a choice. The logarithm of the mean square of five
/// scatters by 63 %.
const LEAST_OUTLIERS: usize = 5;

/// Law of all outliers, those too small to be seen included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SizeLaw {
    /// How many outliers there are in the record.
    pub count: f64,
    /// Standard deviation of the logarithm of their number.
    pub count_log_sd: f64,
    /// Root mean square of their sizes.
    pub size: f64,
    /// Standard deviation of its logarithm.
    pub size_log_sd: f64,
}

/// Normal sizes, seen from `threshold` up: the mean square of those seen gives the law's variance,
/// and that the share which is seen (A. C. Cohen, *Truncated and Censored Samples*, 1991, ch. 2).
pub fn law_of(seen: &[Outlier], threshold: f64) -> SizeLaw {
    let normal = Normal::standard();
    let count = seen.len() as f64;
    let square = seen.iter().map(|one| one.size * one.size).sum::<f64>() / count;
    let own = seen
        .iter()
        .map(|one| one.size_sd * one.size_sd)
        .sum::<f64>()
        / count;
    // Too few to say how many more there are below the threshold.
    if seen.len() < LEAST_OUTLIERS {
        return SizeLaw {
            count,
            count_log_sd: count.sqrt().recip(),
            size: square.sqrt(),
            size_log_sd: (2.0 * count).sqrt().recip(),
        };
    }
    // Mean square beyond the threshold for a variance.
    let beyond = |variance: f64| {
        let t = threshold / variance.sqrt();
        variance * (1.0 + t * normal.pdf(t) / normal.sf(t).max(f64::MIN_POSITIVE))
    };
    let (mut low, mut high) = ((0.1 * threshold).powi(2), square);
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
    SizeLaw {
        count: count / share(variance),
        count_log_sd: count.sqrt().recip().hypot(share_slope * variance_log_sd),
        size: (variance - own).max(0.01 * variance).sqrt(),
        size_log_sd: 0.5 * variance_log_sd,
    }
}
