//! What stands for a course where samples are missing on end.
//!
//! Noise that is drawn there is drawn from a law that still takes the course for a walk: it wanders as that would, and speaks
//! against the course. A cubic through what lies on either side goes on as the course does; a walk that is there as well
//! is lost in the gap alone.

use std::ops::Range;

use nalgebra::{Matrix4, Vector4};

/// Means on either side that the cubic rests on, at least, beside as many as are missing: a choice. Four numbers are fitted
/// to twice as many, and the noise of a mean does not decide.
const LEAST: usize = 8;

/// Puts a cubic in the place of each of the `gaps` of a record that lie between other samples, in means over `factor` of
/// them each.
pub fn cross(means: &mut [f64], gaps: &[Range<usize>], factor: usize) {
    let gaps: Vec<Range<usize>> = gaps
        .iter()
        .map(|gap| gap.start / factor..gap.end.div_ceil(factor).min(means.len()))
        // The last samples make no mean.
        .filter(|gap| !gap.is_empty())
        .collect();
    let is_missing = |n: &usize| gaps.iter().any(|gap| gap.contains(n));
    for gap in &gaps {
        let beside = gap.len().max(LEAST);
        let before = gap.start.saturating_sub(beside)..gap.start;
        let after = gap.end..(gap.end + beside).min(means.len());
        let there = |side: Range<usize>| side.filter(|n| !is_missing(n)).count();
        if [before.clone(), after.clone()].map(there).into_iter().min() < Some(LEAST) {
            continue;
        }
        let all = before.chain(after).filter(|n| !is_missing(n));
        // Between -1 and 1, so that powers of time are of one size.
        let middle = 0.5 * (gap.start + gap.end) as f64;
        let reach = (beside + gap.len()) as f64;
        let powers = |n: usize| {
            let at = (n as f64 + 0.5 - middle) / reach;
            Vector4::new(1.0, at, at * at, at * at * at)
        };
        let (mut gram, mut products) = (Matrix4::zeros(), Vector4::zeros());
        for n in all {
            let powers = powers(n);
            gram += powers * powers.transpose();
            products += powers * means[n];
        }
        if let Some(factors) = gram.cholesky() {
            let sizes = factors.solve(&products);
            gap.clone().for_each(|n| means[n] = sizes.dot(&powers(n)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_goes_on_through_a_gap_and_what_touches_an_end_stays() {
        let at = |n: usize| {
            let time = n as f64 / 100.0;
            1.0 - 3.0 * time + 2.0 * time * time + 0.7 * time.powi(3)
        };
        let truth: Vec<f64> = (0..200).map(at).collect();
        let mut means = truth.clone();
        // In samples, five a mean; the second begins and ends within one.
        let gaps = [0..20, 252..378, 552..599];
        for gap in [0..4, 50..76, 110..120] {
            means[gap].fill(1e3);
        }
        cross(&mut means, &gaps, 5);
        assert!(means[..4].iter().all(|mean| *mean == 1e3));
        for (n, (mean, truth)) in means.iter().zip(&truth).enumerate().skip(4) {
            assert!((mean - truth).abs() < 1e-9, "{n}: {mean} for {truth}");
        }
    }
}
