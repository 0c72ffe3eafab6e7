//! A grid that all values lie on.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, DefaultHasher};

/// Distinct values that are counted; with more, the values lie on no coarse grid: a choice, 17
/// binary digits.
const DISTINCT: usize = 1 << 17;

/// Samples that the first look takes: a choice. On a coarse grid they have taken most of its
/// values.
const LOOK: usize = 1 << 20;

/// Step of a grid over the short-term noise, itself included, from which the noise looks stronger where
/// the level lies between two steps than where it lies on one.
const DECIDES: f64 = 2.0;

/// A grid that the values lie on and nobody declared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coarse {
    /// Distance of neighbouring values, in the unit of the signal.
    pub step: f64,
    /// Whether the noise lies on so few steps that where the level is between two of them decides how
    /// strong it looks.
    pub decides: bool,
}

impl Coarse {
    /// A grid of this `step`, if it is coarser than `declared` and not lost in noise of the deviation
    /// `noise`, which as it is has the root mean square `rms`.
    pub fn new(step: f64, declared: Option<f64>, noise: f64, rms: f64) -> Option<Self> {
        /// Least step over that of the codes: a grid of every second code is one.
        const COARSER: f64 = 1.5;
        /// Least step over the noise: below, rounding adds half a percent to it.
        const SEEN: f64 = 0.25;
        let coarser = declared.is_none_or(|declared| step > COARSER * declared.abs());
        (coarser && step > SEEN * noise).then_some(Self {
            step,
            decides: step > DECIDES * rms,
        })
    }
}

/// The grid that all values lie on: its step, where they lie on one that is not finer than 2^-17
/// of their range.
pub fn grid(values: &[f64]) -> Option<f64> {
    type Counts = HashMap<u64, u32, BuildHasherDefault<DefaultHasher>>;
    let mut seen = Counts::default();
    for value in values.iter().filter(|value| value.is_finite()).take(LOOK) {
        *seen.entry(value.to_bits()).or_default() += 1;
        if seen.len() > DISTINCT {
            return None;
        }
    }
    if seen.len() < 2 {
        return None;
    }
    let mut distinct: Vec<f64> = seen.into_keys().map(f64::from_bits).collect();
    distinct.sort_by(f64::total_cmp);
    let range = distinct[distinct.len() - 1] - distinct[0];
    // Rounding of the file's numbers; a true grid's step lies far above.
    let slack = 1e-9 * range.max(distinct[0].abs());
    let mut step = distinct
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|gap| *gap > slack)
        .fold(f64::INFINITY, f64::min);
    // The least distance between neighbours need not be the grid's step itself: take what divides
    // all distances.
    for pair in distinct.windows(2) {
        let mut rest = (pair[1] - pair[0]) % step;
        rest = rest.min(step - rest);
        if rest > 0.02 * step && rest > slack {
            step = rest;
        }
        if step < range / DISTINCT as f64 {
            return None;
        }
    }
    // A few values by themselves lie on no grid.
    let used = distinct.len() as f64;
    let repeated = values.len().min(LOOK) as f64 > 1.5 * used;
    (repeated && step.is_finite()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_is_news_where_it_is_coarser_than_declared_and_shows_in_the_noise() {
        let is_news = |step, declared| Coarse::new(step, declared, 1.0, 1.0).is_some();
        assert!(is_news(1.0, None));
        assert!(is_news(1.0, Some(-0.5)));
        assert!(!is_news(1.0, Some(1.0)));
        assert!(!is_news(0.2, None));
    }

    #[test]
    fn a_few_values_by_themselves_lie_on_no_grid() {
        let few = [0.0, 3.0, 1.0, 7.0, 4.0, 9.0];
        assert_eq!(grid(&few), None);
        assert_eq!(grid(&few.repeat(2)), Some(1.0));
    }
}
