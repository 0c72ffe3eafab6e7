//! Tests of what is drawn in short gaps.

use nalgebra::{DMatrix, DVector};

use super::*;
use crate::diagnosis::statistic::matched_filter::Transformer;
use crate::model::Seed;
use crate::model::random::Gaussian;

const RATE_HZ: f64 = 50.0;

fn of(values: &[f64]) -> Option<ShortGaps> {
    ShortGaps::of(values, &[])
}

/// Noise with gaps of one to five samples.
fn with_gaps(seed: u64) -> Vec<f64> {
    let mut normal = Gaussian::new(Seed { seed, stream: 3 }, 1.0);
    let mut values: Vec<f64> = (0..150).map(|_| normal.draw()).collect();
    for gap in [20..21, 23..24, 70..75, 90..92] {
        values[gap].fill(f64::NAN);
    }
    values
}

/// Red noise on a white floor.
fn density(ring_len: usize) -> Vec<f64> {
    let of = |k: usize| 0.1 + 10.0 / (1.0 + (k as f64 / 4.0).powi(2));
    (0..=ring_len / 2).map(of).collect()
}

/// Noise of that density that is as strong all along.
fn steady(density: &[f64]) -> Noise<'_> {
    Noise {
        rate_hz: RATE_HZ,
        density,
        strength: &|_| 1.0,
    }
}

#[test]
fn what_is_drawn_is_as_strong_as_the_noise_is_there() {
    const LEN: usize = 30_011;
    let seed = 4;
    // Five times as loud in the second half, with a mean square of one.
    let strength = |n: usize| if n < LEN / 2 { 1.0 } else { 5.0 } / 13_f64.sqrt();
    let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let mut values: Vec<f64> = (0..LEN).map(|n| strength(n) * normal.draw()).collect();
    values
        .iter_mut()
        .skip(2)
        .step_by(3)
        .for_each(|one| *one = f64::NAN);
    let gaps = ShortGaps::of(&values, &[]).expect("gaps");
    gaps.bridge(&mut values);
    let density = vec![1.0 / RATE_HZ; gaps.ring_len() / 2 + 1];
    let noise = Noise {
        strength: &strength,
        ..steady(&density)
    };
    gaps.fill(&mut values, &[], &noise);
    let drawn = |half: Range<usize>| {
        let there = gaps.places().iter().filter(|place| half.contains(place));
        let there: Vec<f64> = there
            .map(|place| values[*place] / strength(*place))
            .collect();
        there.iter().map(|one| one * one).sum::<f64>() / there.len() as f64
    };
    for half in [0..LEN / 2, LEN / 2..LEN] {
        let square = drawn(half.clone());
        // Mean square of 5000 normal numbers, five deviations.
        let limit = 5.0 * (2.0_f64 / 5000.0).sqrt();
        assert!(
            (square - 1.0).abs() < limit,
            "{half:?}: {square}, seed {seed}"
        );
    }
}

#[test]
fn a_tone_that_ends_in_another_phase_than_it_began_goes_on_in_gaps_next_to_the_ends() {
    const LEN: usize = 20_000;
    /// Turns of the tone in the record, and how far beside it its power lies.
    const TURNS: f64 = 500.5;
    const BESIDE: f64 = 40.0;
    for seed in 12..15 {
        let [mut noise, mut lost] = [3, 4].map(|stream| Gaussian::new(Seed { seed, stream }, 1.0));
        let tone = |n: usize| {
            let turns = TURNS * n as f64 / LEN as f64;
            1000.0 * (std::f64::consts::TAU * turns + 1.0).cos()
        };
        let truth: Vec<f64> = (0..LEN).map(|n| tone(n) + noise.draw()).collect();
        // A third of normal numbers is below this.
        let lose = |value: &f64| {
            if lost.draw() < -0.43 {
                f64::NAN
            } else {
                *value
            }
        };
        let mut values: Vec<f64> = truth.iter().map(lose).collect();
        // What is missing at either end is no gap.
        (values[0], values[LEN - 1]) = (truth[0], truth[LEN - 1]);
        let gaps = of(&values).expect("short gaps");
        let turns = |k: usize| k as f64 * LEN as f64 / gaps.ring_len() as f64;
        let in_band = 500_f64.powi(2) * LEN as f64 / RATE_HZ / (2.0 * BESIDE);
        let density = |k: usize| {
            let is_tone = (turns(k) - TURNS).abs() < BESIDE;
            RATE_HZ.recip() + if is_tone { in_band } else { 0.0 }
        };
        let density: Vec<f64> = (0..=gaps.ring_len() / 2).map(density).collect();
        gaps.bridge(&mut values);
        gaps.fill(&mut values, &[], &steady(&density));
        let near = gaps.places().iter().filter(|place| **place < 300);
        let off: Vec<f64> = near
            .map(|&place| (values[place] - truth[place]).powi(2))
            .collect();
        let off = (off.iter().sum::<f64>() / off.len() as f64).sqrt();
        // Three hundredths of the tone; with no more between the ends than a filter spreads it is up to a quarter.
        assert!(off < 30.0, "seed {seed}: {off}");
    }
}

#[test]
fn what_a_sample_does_to_a_gap_is_what_the_law_says() {
    let seed = 11;
    let values = with_gaps(seed);
    let gaps = of(&values).expect("short gaps");
    let density = density(gaps.ring_len());
    let filled = |values: &[f64]| {
        let mut values = values.to_vec();
        gaps.bridge(&mut values);
        gaps.fill(&mut values, &[], &steady(&density));
        values
    };
    // What is drawn is the same in both: their difference is the conditional mean of the gaps, given a sample.
    let (moved, by) = (72 + 5, 1000.0);
    let mut other = values.clone();
    other[moved] += by;
    let pairs = filled(&other).into_iter().zip(filled(&values));
    let difference: Vec<f64> = pairs.map(|(other, one)| other - one).collect();
    let ring = Transformer::new(gaps.ring_len());
    let zeros = ring.transform_ring(ring.zeros(), RATE_HZ);
    let row = zeros.answer(|k| density[k].recip());
    let places = &gaps.places;
    let inner = DMatrix::from_fn(places.len(), places.len(), |i, j| {
        row[places[i].abs_diff(places[j])]
    });
    let outer = DVector::from_fn(places.len(), |i, _| -by * row[places[i].abs_diff(moved)]);
    let expected = inner.lu().solve(&outer).expect("a positive matrix");
    for (n, &place) in gaps.places().iter().enumerate() {
        // A hundredth of a deviation, which is below 1 here, is left by the last turn; so far is that of either.
        let off = (difference[place] - expected[n]).abs();
        assert!(off < 0.02, "{place}: off by {off}, seed {seed}");
    }
    let largest = expected
        .iter()
        .fold(0.0_f64, |most, one| most.max(one.abs()));
    // A fiftieth of the sample by which it moved.
    assert!(largest > 20.0, "the neighbours follow by {largest}");
}

#[test]
fn what_is_measured_stays_and_long_gaps_too() {
    let mut values = with_gaps(12);
    values[100..133].fill(f64::NAN);
    values[..3].fill(f64::NAN);
    let gaps = of(&values).expect("short gaps");
    assert_eq!(gaps.ranges(), [20..21, 23..24, 70..75, 90..92]);
    assert_eq!(gaps.places().len(), 9);
    assert!((gaps.share() - 9.0 / (150.0 - 36.0)).abs() < 1e-12);
    let mut filled = values.clone();
    gaps.bridge(&mut filled);
    assert!(gaps.places().iter().all(|&place| filled[place].is_finite()));
    let measured = (0..150).filter(|n| values[*n].is_finite());
    assert!(measured.into_iter().all(|n| filled[n] == values[n]));
    assert!(filled[100..133].iter().all(|value| value.is_nan()));
}

#[test]
fn what_is_no_measurement_is_filled_however_long() {
    let mut values = vec![1.0; 400];
    values[100..133].fill(f64::NAN);
    values[200..201].fill(f64::NAN);
    let replaced: Vec<usize> = (201..290).chain(300..340).collect();
    let gaps = ShortGaps::of(&values, &replaced).expect("gaps");
    assert_eq!(gaps.ranges(), [200..290, 300..340]);
    assert!((gaps.share() - 130.0 / (400.0 - 33.0)).abs() < 1e-12);
}

#[test]
fn nothing_missing_and_too_much_missing_are_left_alone() {
    assert!(of(&[1.0; 100]).is_none());
    let every_third = (0..300).map(|n| if n % 3 == 1 { 1.0 } else { f64::NAN });
    assert!(of(&every_third.collect::<Vec<f64>>()).is_none());
}

#[test]
fn what_is_drawn_in_quantisation_noise_keeps_its_sums() {
    /// Samples between two that are missing.
    const APART: usize = 500;
    let seed = 8;
    let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let sums: Vec<f64> = (0..20_012).map(|_| normal.draw()).collect();
    let mut values: Vec<f64> = sums.windows(2).map(|pair| pair[1] - pair[0]).collect();
    values
        .iter_mut()
        .skip(200)
        .step_by(APART)
        .for_each(|one| *one = f64::NAN);
    let gaps = ShortGaps::of(&values, &[]).expect("gaps");
    gaps.bridge(&mut values);
    let ring_len = gaps.ring_len();
    let density: Vec<f64> = (0..=ring_len / 2)
        .map(|k| {
            let turn = std::f64::consts::PI * k.max(1) as f64 / ring_len as f64;
            (2.0 * turn.sin()).powi(2) / RATE_HZ
        })
        .collect();
    gaps.fill(&mut values, &[], &steady(&density));
    let mut sum = sums[0];
    let off: Vec<f64> = (values.iter().zip(&sums[1..]))
        .map(|(value, truth)| {
            sum += value;
            sum - truth
        })
        .collect();
    // The bridges, 1.6 off each, leave the line through all a slope of sqrt(40) 5770 1.6 12 / 20 000^3, which the gaps at the ends make
    // good by 0.4 each; four of these and of what the sums on either side know a gap by.
    let limit = 4.0 * (0.4 + (2.0 / 200_f64).sqrt());
    for gap in gaps.ranges() {
        let step = off[gap.end] - off[gap.start - 1];
        assert!(step.abs() < limit, "{gap:?}: {step}, seed {seed}");
    }
}
