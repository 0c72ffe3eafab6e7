//! The whitened record in tiles of time and frequency: how strong each is, which of them count, and their
//! [score](super::noise).

use std::ops::Range;

use realfft::num_complex::Complex64;

use crate::diagnosis::axis::{AxisState, Whitened};
use crate::diagnosis::record::envelope::of_share;
use crate::diagnosis::statistic::matched_filter::smooth_len;
use crate::fft::{self, long::Long};
use crate::numeric::order::median;

/// Ordinates of the widest band whose transform is planned.
const LONGEST: usize = 1 << 16;

/// The least strength that others are taken over: where noise all but vanishes, other noise is all there is.
const LEAST_KNOWN: f64 = 0.0025;

/// Strength of the whitened record in the band of the ordinates, at `ordinates.len()` moments, in
/// units of its density.
pub fn strengths(seen: &Whitened, ordinates: Range<usize>) -> Vec<f64> {
    over_time(seen, whitened(seen, ordinates).collect())
}

/// The ordinates of a band over the root of their densities.
pub(super) fn whitened(
    seen: &Whitened,
    ordinates: Range<usize>,
) -> impl Iterator<Item = Complex64> {
    let pairs = seen.transform.ordinates()[ordinates.clone()].iter();
    let pairs = pairs.zip(&seen.density[ordinates]);
    pairs.map(|(ordinate, density)| ordinate / density.sqrt())
}

/// Power of a band, given by its ordinates, at as many even moments, over that of the record.
pub(super) fn over_time(seen: &Whitened, mut band: Vec<Complex64>) -> Vec<f64> {
    // A length with large prime factors would take many times the time and the memory.
    band.truncate(smooth_len(band.len()));
    if band.len() > LONGEST {
        Long::new(band.len()).inverse(&mut band);
    } else {
        fft::inverse(band.len()).process(&mut band);
    }
    let unit = (band.len() as f64 * seen.transform.power()).recip();
    band.iter().map(|value| value.norm_sqr() * unit).collect()
}

/// Which of `size` moments of a ring of `length` samples count.
pub fn counting(axis: &AxisState, length: usize, size: usize) -> Vec<bool> {
    let of_moment = length as f64 / size as f64;
    // A moment stands in the middle of its samples.
    let sample = |moment: f64| ((moment - 0.5) * of_moment).max(0.0) as usize;
    let moments = (0..size).map(|moment| sample(moment as f64)..sample(moment as f64 + 1.0));
    as_whole_as_most(axis, moments)
}

/// Which of some stretches of samples are all of measured ones; where most are not, which of them hold as many as most
/// do, but for a few: what was drawn in the place of the others is noise as it is known, and hides as much everywhere.
pub fn as_whole_as_most(
    axis: &AxisState,
    stretches: impl Iterator<Item = Range<usize>>,
) -> Vec<bool> {
    /// Part of what most hold: a choice. A tone's power then differs by a fifth at most.
    const AS_MOST: f64 = 0.9;
    let shares: Vec<f64> = stretches.map(|one| axis.usable_share(&one)).collect();
    let most = median(&mut shares.clone()).unwrap_or_default();
    let least = if most < 1.0 { AS_MOST * most } else { 1.0 };
    let counts = |share: f64| share > 0.0 && share >= least;
    shares.into_iter().map(counts).collect()
}

/// What the explanations say of the strength of what swings at each of `size` moments, as the mean square that a band of
/// as many ordinates shows; empty where they say nothing.
pub fn known(axis: &AxisState, length: usize, size: usize) -> Vec<f64> {
    if !axis.has_envelope() {
        return Vec::new();
    }
    let samples = length as f64 / size as f64;
    let moments = (0..size).map(|moment| moment as f64 * samples);
    moments.map(|at| axis.square_over(at, samples)).collect()
}

/// Takes the strengths of some ordinates over what is known of them, if anything is.
pub fn over(axis: &AxisState, strengths: &mut [f64], known: &[f64], ordinates: &Range<usize>) {
    if known.is_empty() {
        return;
    }
    let share = axis.mean_short_share(ordinates, axis.whitened().transform.frequency(1));
    for (strength, known) in strengths.iter_mut().zip(known) {
        *strength /= of_share(share, *known).max(LEAST_KNOWN);
    }
}

/// Sum of scores of the tiles that count, and their number.
pub(super) fn score(strengths: &[f64], counts: &[bool]) -> (f64, f64) {
    let good = || {
        let pairs = strengths.iter().zip(counts);
        pairs.filter(|(_, counts)| **counts).map(|(one, _)| *one)
    };
    let tiles = good().count() as f64;
    let mean = good().sum::<f64>() / tiles.max(1.0);
    if tiles < 8.0 || mean <= 0.0 {
        return (0.0, 0.0);
    }
    // Over the group's own mean, which takes 1/8 a group off.
    let sum: f64 = good().map(|one| (-one / mean).exp() - 0.5).sum();
    (sum + 0.125, tiles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::axis;

    /// Which stretches of a hundred samples count in noise in which these samples are missing.
    fn counting(is_missing: impl Fn(usize) -> bool) -> Vec<bool> {
        let axis = axis(
            1,
            40_000,
            |n, noise| if is_missing(n) { f64::NAN } else { noise },
        );
        as_whole_as_most(&axis, (50..300).map(|one| 100 * one..100 * one + 100))
    }

    #[test]
    fn where_most_stretches_are_whole_the_others_do_not_count() {
        let counts = counting(|n| n == 20_050);
        assert_eq!(counts.iter().filter(|counts| !**counts).count(), 1);
        assert!(!counts[150]);
    }

    #[test]
    fn where_samples_are_missing_everywhere_stretches_count_that_miss_no_more_than_most() {
        // Every fourth, and in one stretch every second.
        let counts = counting(|n| n % if (20_000..20_100).contains(&n) { 2 } else { 4 } == 0);
        assert_eq!(counts.iter().filter(|counts| !**counts).count(), 1);
        assert!(!counts[150]);
    }
}
