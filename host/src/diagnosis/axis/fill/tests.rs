//! Tests of filling until law and fill agree.

use super::*;
use crate::diagnosis::record::envelope::Envelope;
use crate::diagnosis::record::wave::{Outlier, Wave};
use crate::diagnosis::trial::take_in;
use crate::model::random::{Gaussian, Seed};
use crate::model::{cyclic, outliers};

const RATE_HZ: f64 = 100.0;

/// White noise between a walk and ten times as much quantisation noise, an odd number of samples.
fn noise(seed: u64) -> Vec<f64> {
    let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let (mut level, mut before) = (0.0, 0.0);
    let values = (0..60_001).map(|_| {
        level += 0.01 * normal.draw();
        let now = 3.0 * normal.draw();
        let step = now - before;
        before = now;
        normal.draw() + level + step
    });
    values.collect()
}

/// Two-sided density of that noise.
fn density(f_hz: f64) -> f64 {
    let turn = 2.0 * (std::f64::consts::PI * f_hz / RATE_HZ).sin();
    (1.0 + (0.01 / turn).powi(2) + (3.0 * turn).powi(2)) / RATE_HZ
}

/// The same without the samples beside which a normal number lies beyond so many deviations.
fn lost(values: &[f64], beyond: f64, seed: u64) -> Vec<f64> {
    let mut normal = Gaussian::new(Seed { seed, stream: 9 }, 1.0);
    let lose = |&value: &f64| match normal.draw() > beyond {
        true => f64::NAN,
        false => value,
    };
    values.iter().map(lose).collect()
}

#[test]
fn a_law_is_found_whatever_single_samples_miss() {
    // None, a thousandth, a twentieth, three tenths of a normal law lie beyond these.
    let shares = [
        (f64::INFINITY, 0.0),
        (3.09, 1e-3),
        (1.645, 0.05),
        (0.524, 0.3),
    ];
    for (seed, (beyond, share)) in (1..).zip(shares) {
        let values = lost(&noise(seed), beyond, seed);
        let axis = AxisState::new(Arc::new(values), RATE_HZ, None).expect("a spectrum");
        for f_hz in [0.02, 0.5, 2.0, 10.0, 40.0] {
            let ratio = axis.density(f_hz) / density(f_hz);
            // The walk, of which an octave about 0.02 Hz has 24 ordinates, is known to a fifth, all else to 4 %. With a third
            // missing, what is drawn beside ten times as much quantisation noise scatters by 25 % from record to record
            // at 0.5 Hz and by 13 % at 2 Hz. Straight lines make 2 Hz twice as loud where a twentieth misses.
            let sd = match f_hz {
                _ if f_hz < 0.1 => 0.2,
                _ if share > 0.2 && f_hz < 1.0 => 0.25,
                _ if share > 0.2 && f_hz < 5.0 => 0.13,
                _ => 0.04,
            };
            assert!(
                ratio.ln().abs() < 3.0 * sd,
                "{share} missing: {ratio} of the power at {f_hz} Hz, seed {seed}"
            );
        }
        let drawn = axis.filled_samples() as f64 / 60_001.0;
        assert!((drawn - share).abs() < 0.01, "{drawn} of {share}");
    }
}

/// Every ratio of an axis's power to that of the noise in a band.
fn ratios(axis: &AxisState, inside_hz: std::ops::Range<f64>) -> Vec<f64> {
    let bins = axis.data.f_hz.iter().zip(&axis.data.psd);
    let inside = bins.filter(|(f_hz, _)| inside_hz.contains(*f_hz));
    inside.map(|(f_hz, psd)| psd / density(*f_hz)).collect()
}

#[test]
fn what_a_strong_tone_had_filled_is_gone_with_it() {
    use crate::diagnosis::record::wave::Wave;
    use crate::diagnosis::trial::take_in;
    use crate::model::sinusoid;
    for seed in 11..14 {
        let (cycles, amplitude) = (0.073, 3000.0);
        let added = (0..).zip(noise(seed)).map(|(n, value)| {
            let turn = std::f64::consts::TAU * cycles * f64::from(n);
            value + amplitude * turn.cos()
        });
        let values = lost(&added.collect::<Vec<_>>(), 0.524, seed);
        let axis = AxisState::new(Arc::new(values), RATE_HZ, None);
        let mut axis = axis.expect("a spectrum");
        let line = Wave::Line {
            cycles,
            cosine: amplitude,
            sine: 0.0,
            lost: None,
        };
        take_in(&mut axis, sinusoid::KIND, Change::Waves(vec![line]));
        // What is drawn of this noise scatters by a quarter, and its bins as much again.
        let off = ratios(&axis, 5.0..45.0);
        assert!(
            off.iter().all(|ratio| (0.3..3.0).contains(ratio)),
            "seed {seed}: {off:?}"
        );
    }
}

#[test]
fn gaps_are_filled_by_what_no_law_explains() {
    for seed in 21..24 {
        // The mean of twelve white samples: lobes that the five terms do not have.
        let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let white: Vec<f64> = (0..60_012).map(|_| normal.draw()).collect();
        let means: Vec<f64> = white.windows(12).map(|some| some.iter().sum()).collect();
        let axis = AxisState::new(Arc::new(lost(&means, 0.524, seed)), RATE_HZ, None);
        let axis = axis.expect("a spectrum");
        // Where the first lobe ends, one bin about 100/12 Hz has a hundredth of the power of the start at most.
        let bins = axis.data.f_hz.iter().zip(&axis.data.psd);
        let least = bins
            .filter(|(f_hz, _)| (7.0..10.0).contains(*f_hz))
            .fold(f64::INFINITY, |least, (_, psd)| least.min(*psd));
        let start = axis.data.psd[axis.data.f_hz.partition_point(|f_hz| *f_hz < 1.0)];
        assert!(least < 0.01 * start, "seed {seed}: {} of it", least / start);
    }
}

#[test]
fn no_test_looks_at_what_was_drawn_and_all_look_beside_it() {
    let values = lost(&noise(5), 3.09, 5);
    let axis = AxisState::new(Arc::new(values.clone()), RATE_HZ, None).expect("a spectrum");
    let inside = 2000..58_000;
    assert!(
        inside
            .clone()
            .all(|n| axis.usable(n) == values[n].is_finite())
    );
    let drawn = inside.filter(|n| values[*n].is_nan()).count();
    assert!(drawn > 20, "{drawn} missing, seed 5");
}

#[test]
fn what_tends_to_nothing_is_moved_on_by_a_tenth_at_most() {
    // A floor that loses a third in each fill goes on to where three more would bring it, one that all but vanishes no further than a tenth.
    let mut course = vec![vec![1.0, 1.0], vec![2.0 / 3.0, 1e-5]];
    let mut density = vec![4.0 / 9.0, 1e-10];
    go_on(&mut course, &mut density);
    let three_more = 4.0 / 9.0 * (2.0_f64 / 3.0).powi(3);
    assert!((density[0] / three_more - 1.0).abs() < 1e-9, "{density:?}");
    assert!((density[1] / 1e-11 - 1.0).abs() < 1e-9, "{density:?}");
    assert!(course.is_empty());
}

#[test]
fn what_was_drawn_before_a_swing_had_a_name_is_drawn_anew() {
    let seed = 6;
    let envelope = Envelope {
        depth: 0.9,
        period: 3000.0,
        phase_rad: 0.3,
    };
    let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let values: Vec<f64> = (0..30_011)
        .map(|n| envelope.factor(n) * normal.draw())
        .collect();
    // A third of the samples.
    let values = lost(&values, 0.43, seed);
    let mut axis = AxisState::new(Arc::new(values), RATE_HZ, None).expect("a spectrum");
    // Mean square of what was drawn where the noise is quiet, over that of the noise there.
    let quiet = |axis: &AxisState| {
        let places = axis.short_gaps().expect("gaps").places();
        let there = places.iter().filter(|n| envelope.factor(**n) < 0.3);
        let squares = there.map(|n| (axis.filled[*n] / envelope.factor(*n)).powi(2));
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), one| (sum + one, count + 1.0));
        assert!(count > 1000.0, "{count}");
        sum / count
    };
    let before = quiet(&axis);
    assert!(before > 10.0, "{before}, seed {seed}");
    take_in(&mut axis, cyclic::KIND, Change::Strength(envelope));
    let after = quiet(&axis);
    // Of more than a thousand normal numbers; the law is known to a few percent.
    assert!((after - 1.0).abs() < 0.25, "{after}, seed {seed}");
}

#[test]
fn what_outliers_made_of_gaps_goes_with_them() {
    for seed in [21, 22] {
        let mut values = lost(&noise(seed), 0.524, seed);
        // Twelve of ten thousand deviations: three million times the noise's power, drawn into every gap.
        let places = (0..12).filter_map(|n| (4801 * (n + 1)..).find(|&at| values[at].is_finite()));
        let all = places.map(|index| Outlier {
            index,
            size: 5e4,
            size_sd: 1.0,
        });
        let all: Vec<Outlier> = all.collect();
        all.iter().for_each(|one| values[one.index] += one.size);
        let mut axis = AxisState::new(Arc::new(values), RATE_HZ, None).expect("a spectrum");
        let taken = Change::Waves(vec![Wave::Outliers(Arc::new(all))]);
        take_in(&mut axis, outliers::KIND, taken);
        for f_hz in [2.0, 10.0, 40.0] {
            let off = (axis.density(f_hz) / density(f_hz)).ln();
            // As where none were: 13 % at 2 Hz.
            assert!(
                off.abs() < 5.0 * 0.13,
                "seed {seed}: {f_hz} Hz off by {off}"
            );
        }
    }
}
