//! How often chance repeats a sample.
//!
//! It is read off the increments next to zero. On a coarse grid, of which the
//! noise spans a few steps, those of one step and more determine it: for normal increments `ln p(k)` is a
//! parabola in `k`, whose top is `ln p(0)`. What they scatter by about it beyond chance, an error of the grid, say, the
//! repeats may scatter by too. On a fine one the density of increments is even
//! there: with `c` of them within `m` steps on either side, zero itself has `c / 2m`. A long record of
//! fine codes repeats itself a few times an hour.

use crate::diagnosis::statistic::p_value;

/// Increments next to zero from which the density there is estimated, at least: it is then known to
/// an eighth.
const LEAST_INCREMENTS: usize = 64;

/// Numbers of steps that the smallest increment may be, where nobody declared the step: a choice.
const SMALLEST: u32 = 8;

/// How far from a whole number of steps an increment may be: by the rounding of a file's numbers.
const WHOLE: f64 = 0.01;

/// Repeats that are no sign of anything, on values of no grid: the least there is to divide by.
pub(super) const NEVER: f64 = 1e-3;

/// Steps from zero up to which increments are counted: half a deviation, where the law of any smooth noise is a
/// parabola as good as counts know it, within what leaves numbers to fit, and what is near on a grid as fine as hundreds of
/// steps. Choices.
const NEAREST: usize = 4;
const FARTHEST: usize = 16;

/// Scatter of counts of increments about their law, as a share of them, from which they have none: a choice. It is below a
/// hundredth for noise on a grid, a fifth where steps are rounded anew by a logger, and a half and more for
/// pulse counters.
const UNEVEN: f64 = 0.25;

/// Repeats from which their number is as good as normal: its skewness is 0.03.
const MANY: f64 = 1000.0;

/// Repeats that chance has in a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chance {
    /// Expected number of repeats.
    pub count: f64,
    /// Variance of this expectation, for what it is read off is a count itself.
    pub variance: f64,
}

impl Chance {
    /// Of values on a `grid` whose steps the `noise`, the deviation of one increment over the root of two, spans by a few;
    /// `increments` are all that there are. `None` where increments next to zero follow no smooth law: of a counter whose
    /// values are few, or far from evenly frequent, nobody knows how often it repeats itself.
    pub fn on_grid(increments: &[f64], grid: f64, noise: f64) -> Option<Self> {
        let steps = ((0.5 * noise / grid) as usize).clamp(NEAREST, FARTHEST);
        let mut counts = vec![0.0; steps];
        for step in increments {
            let place = (step.abs() / grid).round() as usize;
            if let Some(count) = place.checked_sub(1).and_then(|near| counts.get_mut(near)) {
                *count += 1.0;
            }
        }
        let law = Parabola::of(&counts)?;
        let seen = counts.iter().sum::<f64>() / steps as f64;
        // What counts scatter by beyond chance, as a share of them.
        if law.scatter - 1.0 > UNEVEN * UNEVEN * seen {
            return None;
        }
        // Increments of either sign have one zero.
        let count = 0.5 * law.top.exp();
        Some(Self {
            count,
            variance: law.scatter * law.variance * count * count + (law.scatter - 1.0) * count,
        })
    }

    /// Of values that lie closer than can be counted; `noise` is the deviation of one increment over
    /// the root of two, `step` that of the codes, where it is declared.
    pub fn between(increments: &[f64], noise: f64, step: Option<f64>) -> Self {
        let never = Self {
            count: NEVER,
            variance: 0.0,
        };
        let mut reach = noise * LEAST_INCREMENTS as f64 / increments.len().max(1) as f64;
        let mut near: Vec<f64>;
        loop {
            let sizes = increments.iter().map(|step| step.abs());
            near = sizes.filter(|&size| size > 0.0 && size <= reach).collect();
            if near.len() >= LEAST_INCREMENTS {
                break;
            }
            // Also where there is no noise to measure by.
            if reach.is_nan() || reach <= 0.0 || reach > noise {
                return never;
            }
            reach *= 2.0;
        }
        let Some(step) = step.or_else(|| common_step(&near)) else {
            return never;
        };
        let steps = (reach / step + WHOLE).floor();
        if steps < 1.0 {
            return never;
        }
        let count = near.len() as f64 / (2.0 * steps);
        Self {
            count,
            variance: count * count / near.len() as f64,
        }
    }

    /// Probability of so many repeats or more.
    pub(super) fn exceeded(&self, repeats: f64) -> f64 {
        if repeats + self.count > MANY {
            let beyond = (repeats - self.count) / (self.count + self.variance).sqrt();
            return 0.5 * p_value::two_sided(beyond.max(0.0));
        }
        p_value::counted(repeats as u64, self.count, self.variance)
    }
}

/// Logarithms of counts as a parabola in the number of steps from zero.
struct Parabola {
    /// Its value at zero.
    top: f64,
    /// Variance of that, for counts of Poisson's law.
    variance: f64,
    /// Mean square of what counts are off by, in what Poisson's law has; one or more.
    scatter: f64,
}

impl Parabola {
    /// Of the counts from one step on, weighed by themselves; `None` where there are none.
    fn of(counts: &[f64]) -> Option<Self> {
        let all = || (1_u32..).map(|k| f64::from(k * k)).zip(counts);
        // Half a count more makes the logarithm of a count that of its mean.
        let height = |count: f64| (count + 0.5).ln();
        let (mut weight, mut first, mut second) = (0.0, 0.0, 0.0);
        let (mut sum, mut moment) = (0.0, 0.0);
        for (square, &count) in all() {
            weight += count;
            first += count * square;
            second += count * square * square;
            sum += count * height(count);
            moment += count * square * height(count);
        }
        let determinant = weight * second - first * first;
        if determinant <= 0.0 {
            return None;
        }
        let top = (second * sum - first * moment) / determinant;
        let bend = (weight * moment - first * sum) / determinant;
        // By the law's own counts, so that one which has none where it should counts too.
        let off = |(square, &count): (f64, &f64)| {
            let expected = (top + bend * square).exp().max(f64::MIN_POSITIVE);
            (count - expected).powi(2) / expected
        };
        let freedom = counts.len() as f64 - 2.0;
        Some(Self {
            top,
            variance: second / determinant,
            scatter: (all().map(off).sum::<f64>() / freedom).max(1.0),
        })
    }
}

/// The step that all of these sizes are multiples of, where the smallest is but a few of it.
fn common_step(sizes: &[f64]) -> Option<f64> {
    let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let parts = (1..=SMALLEST).map(|number| smallest / f64::from(number));
    let fits = |step: &f64| {
        let whole = |size: &f64| ((size / step).round() - size / step).abs() < WHOLE;
        sizes.iter().all(whole)
    };
    parts.into_iter().find(fits)
}
