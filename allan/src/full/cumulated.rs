//! Full overlap from cumulative sums: the same results, an order of magnitude faster.

use super::Sums;
use crate::fixed_point::CODE_LIMIT;
use crate::kernels::{CHUNK, WIDEST, squares, with_vectors};
use crate::{Estimate, Statistic};

/// The cumulative sums of a record's segments, for estimates at many averaging times.
///
/// Eight bytes a sample, kept by the caller. An averaging time costs a nanosecond a sample or two.
///
/// ```
/// use inm_allan::{Statistic, full};
/// let mut sums = [0; 5];
/// full::cumulate([1, 3, 2, 6].into_iter(), 3, &mut sums);
/// let record = full::Cumulated::new(&[&sums]).estimate(Statistic::Allan, 1);
/// assert_eq!(record, full::integers(Statistic::Allan, &[&[1, 3, 2, 6]], 1));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Cumulated<'a> {
    segments: &'a [&'a [i64]],
    /// Second differences of the sums are at most twice, third ones at most four times as large.
    range: u64,
}

/// Fills `sums`, longer by one than `codes`, with zero and the cumulative sums of the codes.
///
/// `level` is taken off each code: none of the statistics sees it, and sums that stay near
/// zero are squared in less time. The mean is a good one. Codes and level are at most
/// [`CODE_LIMIT`] from zero.
pub fn cumulate(codes: impl Iterator<Item = i64>, level: i64, sums: &mut [i64]) {
    let Some((first, rest)) = sums.split_first_mut() else {
        return;
    };
    *first = 0;
    let mut sum = 0_i64;
    let within = |code: i64| code.clamp(-CODE_LIMIT, CODE_LIMIT);
    for (place, code) in rest.iter_mut().zip(codes) {
        // Where it wraps, the range shows it.
        sum = sum.wrapping_add(within(code) - within(level));
        *place = sum;
    }
}

impl<'a> Cumulated<'a> {
    /// Distance between the least and the largest sum of a segment up to which it is quick; beyond
    /// it takes the time of [`integers`](super::integers).
    pub const QUICK: u64 = WIDEST / 4;

    /// Over what [`cumulate`] has made of each segment.
    #[must_use]
    pub fn new(segments: &'a [&'a [i64]]) -> Self {
        let ranges = segments.iter().filter_map(|sums| {
            let (least, most) = (sums.iter().min()?, sums.iter().max()?);
            Some(most.abs_diff(*least))
        });
        Self {
            segments,
            range: ranges.max().unwrap_or(0),
        }
    }

    /// Distance between the least and the largest sum of the segment in which it is largest.
    #[must_use]
    pub fn range(&self) -> u64 {
        self.range
    }

    /// As [`integers`](super::integers), and to the bit, with one exception: inner sums of the
    /// modified variance that may exceed 2^58 are rounded to multiples of at most `m`, which
    /// moves the deviation by less than `1 / m` of a step.
    ///
    /// Returns `None` when `m` is zero or no segment is long enough for one difference.
    #[must_use]
    pub fn estimate(&self, statistic: Statistic, m: u64) -> Option<Estimate> {
        let mut sums = Sums::new(statistic, m)?;
        let m = sums.m;
        // Wrapped sums have a range near 2^64, since no step of theirs is above 2^43.
        if self.range > Self::QUICK {
            for segment in self.segments {
                let code = |i: usize| segment[i + 1].wrapping_sub(segment[i]);
                sums.add_segment(segment.len().saturating_sub(1), code);
            }
            return sums.estimate();
        }
        let inner = u128::from(2 * self.range) * m as u128;
        // 2^shift is at most m, since 2 * range is at most half of what is allowed.
        let shift = match statistic {
            Statistic::Modified => (0..128).find(|shift| inner >> shift <= u128::from(WIDEST))?,
            Statistic::Allan | Statistic::Hadamard => 0,
        };
        for segment in self.segments {
            let segment = Segment { sums: segment, m };
            with_vectors(
                #[inline(always)]
                || match statistic {
                    Statistic::Allan => segment.second(2 * self.range, &mut sums),
                    Statistic::Hadamard => segment.third(4 * self.range, &mut sums),
                    Statistic::Modified => segment.inner((inner >> shift) as u64, shift, &mut sums),
                },
            );
        }
        let mut estimate = sums.estimate()?;
        estimate.variance *= libm::ldexp(1.0, 2 * shift);
        Some(estimate)
    }
}

/// The cumulative sums of a segment, seen at one averaging time.
struct Segment<'a> {
    sums: &'a [i64],
    m: usize,
}

impl Segment<'_> {
    /// The places from `from` to `to`, so many averaging times on.
    #[inline(always)]
    fn part(&self, lags: usize, from: usize, to: usize) -> &[i64] {
        &self.sums[from + lags * self.m..to + lags * self.m]
    }

    #[inline(always)]
    fn second_differences(&self, from: usize, to: usize) -> impl Iterator<Item = i64> {
        let part = |lags| self.part(lags, from, to);
        let knots = part(0).iter().zip(part(1)).zip(part(2));
        knots.map(|((old, middle), new)| (new - middle) - (middle - old))
    }

    #[inline(always)]
    fn third_differences(&self, from: usize, to: usize) -> impl Iterator<Item = i64> {
        let part = |lags| self.part(lags, from, to);
        let knots = part(0).iter().zip(part(1)).zip(part(2)).zip(part(3));
        knots.map(|(((oldest, old), middle), new)| (new - oldest) - 3 * (middle - old))
    }

    /// Adds all second differences, of magnitude at most `bound`.
    #[inline(always)]
    fn second(&self, bound: u64, sums: &mut Sums) {
        for (from, to) in chunks(self.sums.len().saturating_sub(2 * self.m)) {
            sums.add_total(squares(bound, self.second_differences(from, to)), to - from);
        }
    }

    /// Adds all third differences, of magnitude at most `bound`.
    #[inline(always)]
    fn third(&self, bound: u64, sums: &mut Sums) {
        for (from, to) in chunks(self.sums.len().saturating_sub(3 * self.m)) {
            sums.add_total(squares(bound, self.third_differences(from, to)), to - from);
        }
    }

    /// Adds all sums of `m` neighbouring second differences, rounded to multiples of `2^shift`, of
    /// magnitude at most `bound` in these.
    #[inline(always)]
    fn inner(&self, bound: u64, shift: i32, sums: &mut Sums) {
        let Some(steps) = self.sums.len().checked_sub(3 * self.m) else {
            return;
        };
        let first = self.second_differences(0, self.m);
        let mut inner = first.map(i128::from).sum::<i128>() + ((1 << shift) >> 1);
        let mut buffer = [0_i64; CHUNK];
        for (from, to) in chunks(steps) {
            let buffer = &mut buffer[..to - from];
            for (place, third) in buffer.iter_mut().zip(self.third_differences(from, to)) {
                *place = (inner >> shift) as i64;
                inner += i128::from(third);
            }
            sums.add_total(squares(bound, buffer.iter().copied()), to - from);
        }
        sums.push(inner >> shift);
    }
}

/// The places from 0 to `count`, at most [`CHUNK`] at a time.
fn chunks(count: usize) -> impl Iterator<Item = (usize, usize)> {
    let begins = (0..count).step_by(CHUNK);
    begins.map(move |begin| (begin, count.min(begin + CHUNK)))
}
