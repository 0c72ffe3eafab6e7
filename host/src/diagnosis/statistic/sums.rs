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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_is_left_out_or_taken_twice() {
        for range in [0..0, 5..6, 3..PART, 3..3 * PART + 3, 1..5 * PART] {
            let count = range.len() as f64;
            let sum = 0.5 * (range.start as f64 + range.end as f64 - 1.0) * count;
            // Whole numbers below 2^53: exact.
            assert_eq!(sums(range, |k| [1.0, k as f64]), [count, sum]);
        }
    }
}
