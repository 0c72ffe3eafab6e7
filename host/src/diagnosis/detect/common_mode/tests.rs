use super::*;
use crate::model::random::{Gaussian, Seed};

const RATE_HZ: f64 = 1000.0;
const LENGTH: usize = 1 << 15;
const LEVEL: f64 = 1e-4;

/// White noise of deviation 1 an axis, with these gains of one more that they share until the sample `until`.
fn axes(seed: u64, gains: &[f64], until: usize) -> Vec<Vec<f32>> {
    let draw = |stream: u64| {
        let mut noise = Gaussian::new(Seed { seed, stream }, 1.0);
        (0..LENGTH).map(|_| noise.draw()).collect::<Vec<f64>>()
    };
    let common = draw(0);
    let axis = |(stream, gain): (u64, &f64)| {
        let own = draw(stream).into_iter().zip(&common).enumerate();
        let both = own.map(|(n, (own, common))| {
            let shared = if n < until { gain * common } else { 0.0 };
            (own + shared) as f32
        });
        both.collect()
    };
    (1..).zip(gains).map(axis).collect()
}

#[test]
fn independent_axes_share_as_often_as_the_level_says() {
    // At 5 % of 40 records two at most; eight or more have a probability of 1e-3.
    let found = (0..40).filter(|&seed| {
        let shared = shared(&axes(seed, &[0.0, 0.0], LENGTH), RATE_HZ, 0.05);
        !shared.axes.is_empty()
    });
    let found: Vec<u64> = found.collect();
    assert!(found.len() < 8, "seeds {found:?}");
}

#[test]
fn what_is_shared_in_one_half_alone_is_no_property_of_the_axes() {
    for seed in 0..4 {
        let half = axes(seed, &[1.0, 1.0], LENGTH / 2);
        let whole = spectra(&half, 0..LENGTH).expect("spectra");
        let bins = whole.cross(0, 1, RATE_HZ, PER_OCTAVE);
        assert!(chance(&bins) < LEVEL, "seed {seed}: nothing to refuse");
        assert_eq!(shared(&half, RATE_HZ, LEVEL).axes, [], "seed {seed}");
        let all = shared(&axes(seed, &[1.0, 1.0], LENGTH), RATE_HZ, LEVEL);
        assert_eq!(all.axes.len(), 1, "seed {seed}");
    }
}

#[test]
fn a_gain_is_told_where_a_third_axis_shares_with_both() {
    for seed in 10..14 {
        let found = shared(&axes(seed, &[1.0, 0.5, -2.0], LENGTH), RATE_HZ, LEVEL);
        assert_eq!(found.axes.len(), 2, "seed {seed}: {found:?}");
        for (common, truth) in found.axes.iter().zip([0.5, -2.0]) {
            let gain = common
                .gain
                .unwrap_or_else(|| panic!("seed {seed}: {common:?}"));
            // Eight numbers beyond five deviations: once in 200 000.
            let off = (gain / truth).ln() / common.gain_log_sd;
            assert!(off.abs() < 5.0, "seed {seed}: {off} deviations, {common:?}");
        }
        let found = shared(&axes(seed, &[1.0, 1.0, 0.0], LENGTH), RATE_HZ, LEVEL);
        let [common] = found.axes.as_slice() else {
            panic!("seed {seed}: {found:?}");
        };
        assert_eq!((common.axis, common.gain), (1, None), "seed {seed}");
        // Nothing is said of the third axis, not even a small number.
        let rows = found.correlation.expect("two axes share");
        let of_third = [rows[0][2], rows[1][2], rows[2][0], rows[2][1]];
        assert_eq!(of_third, [0.0; 4], "seed {seed}");
        assert!((rows[0][1] - 0.5).abs() < 0.05, "seed {seed}: {rows:?}");
    }
}

/// A band with so many averages and a correlation.
fn band(number: usize, averages: f64, correlation: f64) -> CrossBin {
    CrossBin {
        f_hz: 2_f64.powf(0.5 * number as f64),
        density: correlation.into(),
        coherence: correlation * correlation,
        averages,
    }
}

#[test]
fn a_band_in_which_an_axis_is_silent_is_not_all_of_a_gain() {
    const GAIN: f64 = -0.7;
    let far: Vec<CrossBin> = (0..21).map(|number| band(number, 100.0, 0.5)).collect();
    let near: Vec<CrossBin> = far
        .iter()
        .map(|bin| CrossBin {
            density: GAIN * bin.density,
            ..*bin
        })
        .collect();
    // An axis is next to nothing there, and shares as large a part of that.
    let silent = |bins: &[CrossBin]| {
        let mut bins = bins.to_vec();
        bins[3].density *= 1e-12;
        bins
    };
    for (near, far) in [
        (near.clone(), silent(&far)),
        (silent(&near), far.clone()),
        (near.clone(), far.clone()),
    ] {
        let (gain, log_sd) = gain(&near, &far);
        // A silent band is missing from one of both sums.
        assert!((gain / GAIN - 1.0).abs() < 0.051, "{gain}");
        // Both sums have 21 bands of a correlation of a half and 100 averages, whose variance is 1 / 200 each.
        let expected = (2.0 / 200.0 / 21.0_f64).sqrt() / 0.5;
        assert!(
            (log_sd / expected - 1.0).abs() < 0.051,
            "{log_sd}, {expected}"
        );
    }
}

#[test]
fn what_is_shared_in_one_band_alone_is_held_against_that_band() {
    // A half in one band of 21, which over all bands together is 1.5 deviations of chance.
    const AVERAGES: f64 = 100.0;
    let bins: Vec<CrossBin> = (0..21)
        .map(|number| band(number, AVERAGES, if number == 7 { 0.5 } else { 1e-9 }))
        .collect();
    let expected = -AVERAGES * (1.0_f64 - 0.25).ln();
    let nats = nats(&bins, &bins);
    assert!((nats / expected - 1.0).abs() < 1e-6, "{nats} {expected}");
}

#[test]
fn a_band_of_two_averages_says_nothing() {
    // Of one average the coherence is one, whatever is shared.
    let sure: Vec<CrossBin> = (0..9).map(|number| band(number, 100.0, 0.1)).collect();
    let mut all = vec![band(9, 1.0, 1.0 - 1e-9), band(10, 2.0, 0.9)];
    all.extend_from_slice(&sure);
    assert_eq!(chance(&all), chance(&sure));
    assert_eq!(share(&all), share(&sure));
}

#[test]
fn the_share_is_told_as_a_least_one() {
    // Half of the power in every band. Of some thirty bands one lies two and two thirds deviations too high once in
    // eight records: of ten, six or more have a probability of 1e-3.
    let over = (20..30).filter(|&seed| {
        let found = shared(&axes(seed, &[1.0, 1.0], LENGTH), RATE_HZ, LEVEL);
        found.axes[0].share > 0.5
    });
    let over: Vec<u64> = over.collect();
    assert!(over.len() < 6, "seeds {over:?}");
}
