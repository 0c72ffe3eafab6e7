//! Samples that pile up at an extreme value.

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
/// last two cells lie in the last; without a grid the last cell is the value itself.
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
                let place = |value: &&f64| side * **value == extreme;
                let last = values.iter().filter(place).count() as u64;
                (SHARED.powi(last.saturating_sub(1).min(64) as i32), last)
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
