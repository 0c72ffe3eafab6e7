//! Full overlap: every difference that fits, at any averaging time, over records in memory.
//!
//! Input is a list of *segments*, runs of samples without a gap between them. No difference spans
//! two segments, and a gap costs no other difference. Time is O(samples) an averaging time and
//! nothing is allocated: neighbouring differences are updated from the samples,
//!
//! ```text
//! D[j+1] = D[j] + y[j+2m] - 2 y[j+m] + y[j]
//! H[j+1] = H[j] + y[j+3m] - 3 y[j+2m] + 3 y[j+m] - y[j]
//! E[j+1] = E[j] + H[j]                      because D[j+m] - D[j] = H[j]
//! ```
//!
//! which is exact in integers and would drift in floating point. [`Cumulated`] takes memory for
//! cumulative sums, and less time for it.

mod cumulated;

pub use cumulated::{Cumulated, cumulate};

use crate::fixed_point::FixedPoint;
use crate::wide::Wide;
use crate::{Estimate, Statistic};

/// The estimate over integer codes, exact until its one rounding to `f64`.
///
/// Returns `None` when `m` is zero or no segment is long enough for one difference.
///
/// ```
/// use inm_allan::{full, Statistic};
/// let codes = [1, 3, 2, 6];
/// let estimate = full::integers(Statistic::Allan, &[&codes], 1).unwrap();
/// assert_eq!(estimate.terms, 3);
/// assert_eq!(estimate.variance, (4.0 + 1.0 + 16.0) / 3.0 / 2.0);
/// ```
#[must_use]
pub fn integers(statistic: Statistic, segments: &[&[i32]], m: u64) -> Option<Estimate> {
    let mut sums = Sums::new(statistic, m)?;
    for segment in segments {
        sums.add_segment(segment.len(), |index| i64::from(segment[index]));
    }
    sums.estimate()
}

/// The estimate over floating-point samples.
///
/// Samples are rounded to a grid of at most 2^-40 of the largest distance of any sample from the
/// first ([`FixedPoint`]); the deviation is within one step of that grid of the exact one, and a
/// large mean costs nothing. A sample that is not finite ends its segment, as a gap does.
///
/// Returns `None` when `m` is zero or no segment is long enough for one difference.
#[must_use]
pub fn floats(statistic: Statistic, segments: &[&[f64]], m: u64) -> Option<Estimate> {
    let grid = FixedPoint::covering(segments.iter().copied().flatten().copied(), 1.0);
    let mut sums = Sums::new(statistic, m)?;
    for run in segments
        .iter()
        .flat_map(|segment| segment.split(|sample| !sample.is_finite()))
    {
        // Every finite sample has a code on a grid that covers them all.
        sums.add_segment(run.len(), |index| grid.code(run[index]).unwrap_or(0));
    }
    let mut estimate = sums.estimate()?;
    estimate.variance = grid.scale_variance(estimate.variance);
    Some(estimate)
}

/// Sum of squared differences at one averaging time, over the segments seen so far.
///
/// Codes are below 2^42 and `m` is at most the length of a slice, below 2^60, so differences stay
/// below 2^103; an inner sum of `m` of them fits `i128` while `m` is below 2^42, and 2^42 samples
/// of the smallest type are sixteen tebibytes.
struct Sums {
    statistic: Statistic,
    m: usize,
    terms: u64,
    sum_of_squares: Wide<4>,
}

impl Sums {
    fn new(statistic: Statistic, m: u64) -> Option<Self> {
        // A span that overflows is longer than any slice.
        let m = usize::try_from(m)
            .ok()
            .filter(|&m| m > 0 && m <= usize::MAX / 3)?;
        Some(Self {
            statistic,
            m,
            terms: 0,
            sum_of_squares: Wide::ZERO,
        })
    }

    fn add_segment(&mut self, len: usize, code: impl Fn(usize) -> i64) {
        match self.statistic {
            Statistic::Allan => self.add_second_differences(len, code),
            Statistic::Hadamard => self.add_third_differences(len, code),
            Statistic::Modified => self.add_summed_differences(len, code),
        }
    }

    fn add_second_differences(&mut self, len: usize, code: impl Fn(usize) -> i64) {
        let m = self.m;
        if len < 2 * m {
            return;
        }
        let total = |from: usize| (from..from + m).map(|i| i128::from(code(i))).sum::<i128>();
        let mut difference = total(m) - total(0);
        self.push(difference);
        for j in 0..len - 2 * m {
            difference += i128::from(code(j + 2 * m) - 2 * code(j + m) + code(j));
            self.push(difference);
        }
    }

    fn add_third_differences(&mut self, len: usize, code: impl Fn(usize) -> i64) {
        let m = self.m;
        if len < 3 * m {
            return;
        }
        let total = |from: usize| (from..from + m).map(|i| i128::from(code(i))).sum::<i128>();
        let mut difference = total(2 * m) - 2 * total(m) + total(0);
        self.push(difference);
        for j in 0..len - 3 * m {
            difference += third_difference(&code, j, m);
            self.push(difference);
        }
    }

    fn add_summed_differences(&mut self, len: usize, code: impl Fn(usize) -> i64) {
        let m = self.m;
        // The last inner sum ends one sample before a Hadamard difference would.
        if len + 1 < 3 * m {
            return;
        }
        // D[0] and the sum of D[0]..D[m-1] directly; H[0] = D[m] - D[0] on the way.
        let total = |from: usize| (from..from + m).map(|i| i128::from(code(i))).sum::<i128>();
        let first = total(m) - total(0);
        let (mut difference, mut inner_sum) = (first, first);
        for j in 0..m - 1 {
            difference += i128::from(code(j + 2 * m) - 2 * code(j + m) + code(j));
            inner_sum += difference;
        }
        self.push(inner_sum);
        if len < 3 * m {
            return;
        }
        let last = m - 1;
        difference += i128::from(code(last + 2 * m) - 2 * code(last + m) + code(last));
        let mut third = difference - first;
        for j in 0..=len - 3 * m {
            inner_sum += third;
            self.push(inner_sum);
            if j < len - 3 * m {
                third += third_difference(&code, j, m);
            }
        }
    }

    #[inline]
    fn push(&mut self, difference: i128) {
        self.terms += 1;
        self.sum_of_squares.add_square(difference);
    }

    /// Adds `terms` squared differences that sum to `squares`.
    #[inline]
    fn add_total(&mut self, squares: u128, terms: usize) {
        self.terms += terms as u64;
        self.sum_of_squares.add_u128(squares);
    }

    fn estimate(&self) -> Option<Estimate> {
        let m = self.m as u64;
        (self.terms > 0).then(|| Estimate {
            m,
            variance: self.statistic.variance(m, self.terms, &self.sum_of_squares),
            terms: self.terms,
            stride: 1,
        })
    }
}

/// `y[j+3m] - 3 y[j+2m] + 3 y[j+m] - y[j]`, below 2^45 for codes below 2^42.
#[inline]
fn third_difference(code: &impl Fn(usize) -> i64, j: usize, m: usize) -> i128 {
    i128::from(code(j + 3 * m) - code(j) - 3 * (code(j + 2 * m) - code(j + m)))
}
