//! Sums over long ranges, shared between threads.

use std::ops::Range;

use rayon::prelude::*;

/// Terms that are added up at a time, and worth a thread's while: a choice.
const PART: usize = 1 << 15;

/// Sums of what `terms` gives for each number of `range`; to the bit the same however many threads
/// share the work.
pub fn sums<const N: usize>(
    range: Range<usize>,
    terms: impl Fn(usize) -> [f64; N] + Sync,
) -> [f64; N] {
    let add = |sums: [f64; N], terms: [f64; N]| std::array::from_fn(|one| sums[one] + terms[one]);
    let parts = range.clone().into_par_iter().step_by(PART);
    let parts = parts.map(|start| {
        let part = start..(start + PART).min(range.end);
        part.map(&terms).fold([0.0; N], add)
    });
    let parts: Vec<[f64; N]> = parts.collect();
    parts.into_iter().fold([0.0; N], add)
}

/// The same of as many as `count` sums at once, to which `add` adds what each number of `range` gives.
pub fn sums_of(
    range: Range<usize>,
    count: usize,
    add: impl Fn(usize, &mut [f64]) + Sync,
) -> Vec<f64> {
    let parts = range.clone().into_par_iter().step_by(PART);
    let parts = parts.map(|start| {
        let mut sums = vec![0.0; count];
        (start..(start + PART).min(range.end)).for_each(|k| add(k, &mut sums));
        sums
    });
    let parts: Vec<Vec<f64>> = parts.collect();
    parts.into_iter().fold(vec![0.0; count], |mut sums, part| {
        sums.iter_mut().zip(part).for_each(|(sum, one)| *sum += one);
        sums
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_is_left_out_or_taken_twice() {
        for range in [0..0, 5..6, 3..PART, 3..3 * PART + 3, 1..5 * PART] {
            let count = range.len() as f64;
            let sum = 0.5 * (range.start as f64 + range.end as f64 - 1.0) * count;
            // Whole numbers below 2^53: exact.
            let (one, other) = (range.clone(), range);
            assert_eq!(sums(one, |k| [1.0, k as f64]), [count, sum]);
            let add = |k: usize, sums: &mut [f64]| {
                sums[0] += 1.0;
                sums[1] += k as f64;
            };
            assert_eq!(sums_of(other, 2, add), [count, sum]);
        }
    }
}
