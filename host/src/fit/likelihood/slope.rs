//! The slope of a record under coloured noise, by generalised least squares.
//!
//! The slow form of the record ([`Cascade::slow`]) is averaged into some dozens of blocks, whose
//! means have known covariances under every term: with `F` the second integral of the covariance
//! function, `cov(i, j) = [F(b_i - a_j) - F(a_i - a_j) - F(b_i - b_j) + F(a_i - b_j)] / (h_i h_j)`
//! for blocks from `a` to `b` of length `h`. For a walk and for flicker noise, whose level is not
//! stationary, the functions are generalised covariances, `-K^2 |t| / 2` and `-(B^2 / pi) ln |t|`:
//! right for every combination whose weights add up to zero, as those of a slope do (G. Matheron,
//! *The intrinsic random functions and their applications*, Adv. Appl. Prob. 5, 1973).

use nalgebra::{DMatrix, DVector};

use super::components::SEEN;
use crate::model::Coefficient;
use crate::spectrum::Cascade;

/// Blocks that the record is averaged into, about; the ends of the outermost, where a walk keeps
/// what it shows of a slope, are then a hundredth of the record away.
const BLOCKS: u64 = 64;

/// Most blocks, where gaps make many short ones.
const MOST_BLOCKS: usize = 192;

/// Mean over a stretch of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Its start, seconds.
    pub from_s: f64,
    /// Its end, seconds.
    pub to_s: f64,
    /// The mean, unit of the signal.
    pub mean: f64,
}

/// Block means of a record of samples in counts of `units_per_count`; empty where gaps leave none.
pub fn blocks(cascade: &Cascade, rate_hz: f64, units_per_count: f64) -> Vec<Block> {
    let Some((slower, runs)) = cascade.slow() else {
        return Vec::new();
    };
    let period_s = slower as f64 / rate_hz;
    let span = match (runs.first(), runs.last()) {
        (Some(first), Some(last)) => last.first + last.samples.len() as u64 - first.first,
        _ => 0,
    };
    let long = span.div_ceil(BLOCKS).max(1) as usize;
    let mut blocks: Vec<Block> = Vec::new();
    for run in runs {
        for (number, part) in run.samples.chunks(long).enumerate() {
            let from_s = (run.first + (number * long) as u64) as f64 * period_s;
            blocks.push(Block {
                from_s,
                to_s: from_s + part.len() as f64 * period_s,
                mean: units_per_count * part.iter().sum::<f64>() / part.len() as f64,
            });
        }
    }
    // The longest show most.
    let length = |block: &Block| block.to_s - block.from_s;
    blocks.sort_by(|one, other| length(other).total_cmp(&length(one)));
    blocks.truncate(MOST_BLOCKS);
    blocks.sort_by(|one, other| one.from_s.total_cmp(&other.from_s));
    blocks
}

/// Equal blocks over `duration_s` without anything in them: to plan with.
pub fn empty_blocks(duration_s: f64) -> Vec<Block> {
    let length_s = duration_s / BLOCKS as f64;
    (0..BLOCKS)
        .map(|number| Block {
            from_s: number as f64 * length_s,
            to_s: (number + 1) as f64 * length_s,
            mean: 0.0,
        })
        .collect()
}

/// A slope with what each term adds to its variance.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// The estimate, unit of the signal per second.
    pub per_s: f64,
    /// Variance of the estimate for squared coefficients of 1, in the order of [`SEEN`], and of what
    /// was added to them.
    pub unit_variances: Vec<f64>,
}

impl Slope {
    /// The best slope of `blocks` if the noise has the squared coefficients `squared`, in the order
    /// of [`SEEN`].
    ///
    /// `None` for fewer than three blocks, or without noise to weigh them by.
    pub fn new(blocks: &[Block], squared: &[f64]) -> Option<Self> {
        let size = blocks.len();
        if size < 3 {
            return None;
        }
        let units: Vec<DMatrix<f64>> = SEEN
            .iter()
            .map(|&one| DMatrix::from_fn(size, size, |i, j| unit_covariance(one, blocks, i, j)))
            .collect();
        let mut total = DMatrix::zeros(size, size);
        for (unit, squared) in units.iter().zip(squared) {
            total += unit * *squared;
        }
        let largest = total.amax();
        if !(largest > 0.0 && largest.is_finite()) {
            return None;
        }
        // Any constant may be added to a generalised covariance; enough of it makes it positive.
        let total = (total / largest).add_scalar(4.0);
        let factor = total.cholesky()?;
        // Time in units of the record, from its middle.
        let (start_s, end_s) = (blocks[0].from_s, blocks[size - 1].to_s);
        let time =
            |block: &Block| (0.5 * (block.from_s + block.to_s) - start_s) / (end_s - start_s) - 0.5;
        let regressors =
            DMatrix::from_fn(
                size,
                2,
                |i, column| {
                    if column == 0 { 1.0 } else { time(&blocks[i]) }
                },
            );
        let weighed = factor.solve(&regressors);
        let normal = (regressors.transpose() * &weighed).try_inverse()?;
        let weights = weighed * normal.column(1) / (end_s - start_s);
        let means = DVector::from_fn(size, |i, _| blocks[i].mean - blocks[0].mean);
        let variance = |unit: &DMatrix<f64>| (weights.transpose() * unit * &weights)[(0, 0)];
        Some(Self {
            per_s: weights.dot(&means),
            unit_variances: units.iter().map(|unit| variance(unit).max(0.0)).collect(),
        })
    }

    /// Adds a component that is as good as white over the length of the record, of this two-sided
    /// density for a square of 1.
    pub fn beside(&mut self, density: f64) {
        let white = SEEN.iter().position(|&one| one == Coefficient::N);
        let unit = white.map_or(0.0, |place| self.unit_variances[place]);
        self.unit_variances.push(density * unit);
    }

    /// Variance of the estimate for the squared coefficients `squared`.
    pub fn variance(&self, squared: &[f64]) -> f64 {
        let parts = self.unit_variances.iter().zip(squared);
        parts.map(|(unit, squared)| unit * squared).sum()
    }
}

/// Covariance of two block means for coefficient 1, up to a constant.
fn unit_covariance(coefficient: Coefficient, blocks: &[Block], i: usize, j: usize) -> f64 {
    let (one, other) = (&blocks[i], &blocks[j]);
    let f = |t: f64| second_integral(coefficient, t);
    let sum = f(one.to_s - other.from_s) - f(one.from_s - other.from_s) - f(one.to_s - other.to_s)
        + f(one.from_s - other.to_s);
    sum / ((one.to_s - one.from_s) * (other.to_s - other.from_s))
}

/// Second integral over time of the (generalised) covariance function for coefficient 1.
fn second_integral(coefficient: Coefficient, t_s: f64) -> f64 {
    let t_s = t_s.abs();
    match coefficient {
        Coefficient::K => -t_s.powi(3) / 12.0,
        Coefficient::B if t_s > 0.0 => -t_s * t_s * (t_s.ln() - 1.5) / (2.0 * std::f64::consts::PI),
        Coefficient::N => 0.5 * t_s,
        // Means of a difference are differences of what lies at the ends. Ends that coincide are
        // sums of the same sample periods: they differ by rounding only.
        Coefficient::Q if t_s < 1e-9 => -1.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variances_are_those_known_in_closed_form() {
        let duration_s = 5000.0;
        let blocks = empty_blocks(duration_s);
        let alone = |index: usize| {
            let mut squared = [0.0; 4];
            squared[index] = 1.0;
            Slope::new(&blocks, &squared)
                .expect("blocks")
                .variance(&squared)
        };
        // A walk shows a slope by its two ends only; blocks blunt them by a sixty-fourth.
        let walk = alone(0) * duration_s;
        assert!((1.0..1.02).contains(&walk), "{walk}");
        // White noise: 12 N^2 / T^3, less what means of blocks lose, a part in 64^2.
        let white = alone(2) * duration_s.powi(3) / 12.0;
        assert!((white - 1.0).abs() < 1e-3, "{white}");
    }

    /// Means of blocks of a walk, drawn: the estimate has the variance that is claimed, and finds a
    /// slope put in.
    #[test]
    fn slopes_of_a_simulated_walk() {
        let seed = 4;
        let mut noise =
            crate::model::random::Gaussian::new(crate::model::Seed { seed, stream: 0 }, 1.0);
        let (records, steps) = (400, 64 * 16);
        let mut sum = [0.0; 2];
        let mut claimed = 0.0;
        for _ in 0..records {
            let mut blocks = empty_blocks(f64::from(steps));
            let mut level = 0.0;
            for block in &mut blocks {
                for _ in 0..16 {
                    level += noise.draw();
                    block.mean += (level + 0.3 * block.from_s) / 16.0;
                }
            }
            let slope = Slope::new(&blocks, &[1.0, 0.0, 0.0, 0.0]).expect("blocks");
            claimed = slope.variance(&[1.0, 0.0, 0.0, 0.0]);
            sum[0] += slope.per_s - 0.3;
            sum[1] += (slope.per_s - 0.3).powi(2);
        }
        let records = f64::from(records);
        let ratio = sum[1] / records / claimed;
        // A variance from 400 draws scatters by sqrt(2 / 400); four of that.
        assert!(
            (ratio - 1.0).abs() < 4.0 * (2.0 / records).sqrt(),
            "seed {seed}: {ratio}"
        );
        let mean = sum[0] / records / (claimed / records).sqrt();
        assert!(mean.abs() < 4.0, "seed {seed}: mean off by {mean} sigma");
    }
}
