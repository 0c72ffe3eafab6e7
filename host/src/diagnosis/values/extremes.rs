//! Samples that pile up at an extreme value.

use super::repeats::Repeats;
use crate::diagnosis::statistic::p_value;

/// Probability that the next value equals the extreme, where no grid is coarse enough to be seen: the
/// two largest of a million normal numbers differ by a fifth of a deviation, and more distinct values
/// than are counted lie closer than a ten-thousandth.
const SHARED: f64 = 1.0 / 2048.0;

/// Samples piled up at one extreme value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clipping {
    /// The extreme value, in the unit of the signal.
    pub level: f64,
    /// Which extreme it is: 1 for the upper, -1 for the lower.
    pub side: f64,
    /// How many samples pile up there.
    pub count: u64,
    /// Probability of the pile-up by chance.
    pub p_value: f64,
}

/// Pile-up at the largest and at the smallest value.
///
/// Toward an extreme the counts of any smooth law fall off, so at most half of the samples in the
/// last two cells lie in the last; without a grid the last cell is the value itself. Samples that come one behind the
/// other there are as likely as repeats are in the rest of the record.
pub fn clipping(values: &[f64], grid: Option<f64>, level: f64) -> Vec<Clipping> {
    let side = |side: f64| {
        let extreme = values
            .iter()
            .filter(|value| value.is_finite())
            .fold(f64::NEG_INFINITY, |best, value| best.max(side * value));
        let (one_side, last) = match grid {
            Some(grid) => {
                let at = |steps: f64| {
                    let place =
                        |value: &&f64| ((extreme - side * **value) / grid - steps).abs() < 0.5;
                    values.iter().filter(place).count() as u64
                };
                let (last, before) = (at(0.0), at(1.0));
                (p_value::binomial_half(last, last + before), last)
            }
            None => {
                let is_there = |value: &f64| side * value == extreme;
                let last = values.iter().filter(|value| is_there(value)).count();
                let behind = |pair: &&[f64]| is_there(&pair[0]) && is_there(&pair[1]);
                let behind = values.windows(2).filter(behind).count();
                let apart = SHARED.powi((last - behind).saturating_sub(1).min(64) as i32);
                let repeats = again(values, side * extreme);
                (
                    apart * repeats.powi(behind.min(1 << 20) as i32),
                    last as u64,
                )
            }
        };
        let p_value = p_value::searched(one_side, 2.0);
        (p_value < level).then_some(Clipping {
            level: side * extreme,
            side,
            count: last,
            p_value,
        })
    };
    [side(1.0), side(-1.0)].into_iter().flatten().collect()
}

/// Chance that a sample repeats the one before, where that was at another value than `extreme` and may be a repeat itself.
fn again(values: &[f64], extreme: f64) -> f64 {
    let places: Vec<usize> = (1..values.len())
        .filter(|&n| values[n] == values[n - 1] && values[n] != extreme)
        .collect();
    let repeats = Repeats::new(values, &places);
    let share = |part: usize, of: usize| part as f64 / (of + 1) as f64;
    share(repeats.count, repeats.pairs)
        .max(share(repeats.by_another, repeats.followed))
        .max(SHARED)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Seed;
    use crate::model::random::Gaussian;

    /// A record whose largest value comes so many times one behind the other, as another of its values does.
    fn runs(at_extreme: usize, elsewhere: usize) -> Vec<f64> {
        let mut normal = Gaussian::new(Seed { seed: 6, stream: 0 }, 1.0);
        let mut values: Vec<f64> = (0..10_000).map(|_| normal.draw()).collect();
        values[5000..5000 + at_extreme].fill(9.0);
        values[2000..2000 + elsewhere].fill(1.0);
        values
    }

    #[test]
    fn a_run_of_repeats_at_an_extreme_is_no_limit() {
        assert_eq!(clipping(&runs(10, 0), None, 1e-4).len(), 1, "seed 6");
        assert!(clipping(&runs(10, 12), None, 1e-4).is_empty(), "seed 6");
    }

    #[test]
    fn what_comes_back_to_it_is_one_beside_repeats() {
        let mut values = runs(2, 12);
        for n in (100..900).step_by(100) {
            values[n] = 9.0;
        }
        let found = clipping(&values, None, 1e-4);
        assert_eq!(found.len(), 1, "seed 6");
        assert_eq!(found[0].count, 10, "seed 6");
    }
}
