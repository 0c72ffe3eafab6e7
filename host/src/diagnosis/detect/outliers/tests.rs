//! What looks like an outlier and is none.

mod seen;

use std::f64::consts::TAU;

use super::*;
use crate::diagnosis::detect::trial::{self, Trial, noise, outlier};
use crate::diagnosis::laws::Law;
use crate::diagnosis::record::envelope::Envelope;
use crate::model::{averaging, telegraph};

/// Places far from one another.
const APART: [usize; 4] = [4001, 7500, 11_111, 15_002];

/// Noise with samples that are `size` too large.
fn with(seed: u64, size: f64, places: &[usize]) -> Trial {
    let mut values = noise(seed);
    places.iter().for_each(|&place| values[place] += size);
    Trial::new(values)
}

/// Places of the outliers that are named, none where none are.
fn named_at(proposals: Vec<Proposal>) -> Vec<usize> {
    let waves = match trial::candidate(proposals).map(|one| one.change) {
        Some(Change::Waves(waves)) => waves,
        _ => Vec::new(),
    };
    let all = waves.iter().filter_map(|wave| match wave {
        Wave::Outliers(all) => Some(all.iter().map(|one| one.index)),
        _ => None,
    });
    all.flatten().collect()
}

#[test]
fn large_samples_are_named_where_they_are() {
    for seed in 0..3 {
        let mut trial = with(seed, 9.0, &APART);
        let proposals = trial.ask(&DETECTOR);
        assert_eq!(named_at(proposals), APART, "seed {seed}");
        trial.refuse(KIND);
        assert!(trial.ask(&DETECTOR).is_empty(), "seed {seed}: refused");
        assert!(
            Trial::new(noise(seed)).ask(&DETECTOR).is_empty(),
            "seed {seed}"
        );
    }
}

#[test]
fn large_samples_close_together_are_none() {
    // Four pairs where less than a hundredth of one is expected.
    let pairs: Vec<usize> = APART
        .iter()
        .flat_map(|&place| [place, place + 20])
        .collect();
    let mut trial = with(10, 9.0, &pairs);
    let proposals = trial.ask(&DETECTOR);
    assert!(named_at(trial.ask(&DETECTOR)).is_empty());
    assert!(trial::teaches(&proposals, &Lesson::LargeSamplesInGroups(0)));
    trial.character.learn(Lesson::LargeSamplesInGroups(0));
    assert!(trial.ask(&DETECTOR).is_empty(), "looked for again");
    // What they may have been of is taken out: they are asked again.
    trial.know(crate::model::steps::KIND, [1.0, 0.0], trial::steps(&[]));
    let again = trial.ask(&DETECTOR);
    assert!(trial::teaches(&again, &Lesson::LargeSamplesInGroups(1)));
}

#[test]
fn large_samples_where_an_excluded_band_is_loud_belong_to_it() {
    let mut values = noise(11);
    // A tone of 20 Hz, switched on for 4 s about each of the places.
    for place in APART {
        for (n, value) in values.iter_mut().enumerate().skip(place - 200).take(400) {
            *value += 2.0 * (TAU * 0.2 * n as f64).cos();
        }
    }
    let at = |offset: usize| {
        let mut values = values.clone();
        APART
            .iter()
            .for_each(|place| values[place + offset] += 12.0);
        let mut trial = Trial::new(values);
        trial.exclude(18.0, 22.0);
        trial.ask(&DETECTOR)
    };
    assert!(trial::teaches(&at(0), &Lesson::LargeSamplesInGroups(0)));
    // The same samples while the tone is off.
    let elsewhere = APART.map(|place| place + 1500);
    assert_eq!(named_at(at(1500)), elsewhere);
}

#[test]
fn large_samples_that_short_dwells_leave_are_no_outliers() {
    // Up and down by 50, once a second: one dwell in 200 is shorter than 5 ms and leaves less than 25.
    let places = [4500, 7500, 11_500];
    let turn = |place: usize, index: usize| trial::jump(index, 50.0 - 100.0 * (place % 2) as f64);
    let jumps: Vec<_> = (1..19).map(|place| turn(place, place * 1000)).collect();
    let proposals = |dwell_s: Option<f64>| {
        let mut values = noise(12);
        trial::add(&mut values, &Wave::Steps(jumps.to_vec()));
        places.iter().for_each(|&place| values[place] += 12.0);
        let mut trial = Trial::new(values);
        let kind = dwell_s.map_or(crate::model::steps::KIND, |_| telegraph::KIND);
        trial.know(kind, [50.0, dwell_s.unwrap_or(0.0)], trial::steps(&jumps));
        trial.ask(&DETECTOR)
    };
    assert_eq!(named_at(proposals(None)), places);
    let switching = proposals(Some(1.0));
    assert!(trial::teaches(&switching, &Lesson::LargeSamplesInGroups(1)));
    assert!(trial::withdraws(&switching, KIND));
}

#[test]
fn large_samples_of_a_loud_stretch_are_no_outliers() {
    let places = [6000, 6600, 7300];
    let with = |factor: f64, size: f64| {
        let mut values = noise(13);
        values[5500..8000].iter_mut().for_each(|one| *one *= factor);
        places.iter().for_each(|&place| values[place] = size);
        Trial::new(values).ask(&DETECTOR)
    };
    // The threshold is some 5 of 1, or of 1.5.
    assert_eq!(named_at(with(1.0, 6.5)), places);
    assert!(with(1.5, 6.5).is_empty());
    assert_eq!(named_at(with(1.5, 12.0)), places);
}

#[test]
fn where_the_strength_moves_outliers_are_three_times_as_far_out_as_the_noise_about_them() {
    // The noise is four times as loud in the second half; the threshold is some 5 of 2.9 or of 4.
    let mut values = noise(14);
    let half = values.len() / 2;
    values[half..].iter_mut().for_each(|one| *one *= 4.0);
    for (place, size) in [
        (3000, 30.0),
        (5000, 55.0),
        (half + 3000, 55.0),
        (half + 5000, 90.0),
    ] {
        values[place] = size;
    }
    let mut trial = Trial::new(values);
    let expected = [3000, 5000, half + 3000, half + 5000];
    assert_eq!(named_at(trial.ask(&DETECTOR)), expected);
    trial.character.strength_moves = true;
    assert_eq!(named_at(trial.ask(&DETECTOR)), [5000, half + 5000]);
}

#[test]
fn a_jump_is_no_outlier() {
    let jumps = APART.map(|place| trial::jump(place, if place % 2 == 0 { 25.0 } else { -25.0 }));
    let mut values = noise(15);
    trial::add(&mut values, &Wave::Steps(jumps.to_vec()));
    values[9000] += 60.0;
    let mut trial = Trial::new(values);
    let found = |trial: &Trial| {
        let seen = trial.axis.whitened();
        let powers = trial.axis.powers();
        let all = trial.look(|look| sought(look, &seen.transform, &seen.density, &powers, &[]));
        all.outliers.iter().map(|one| one.index).collect::<Vec<_>>()
    };
    let seen = trial.axis.whitened();
    let usable = filtered(&trial.axis);
    let alike = filter::outliers(&seen.transform, &seen.density, trial::LEVEL, usable, |_| {
        1.0
    });
    assert!(alike.outliers.len() > 1, "no jump looks like an outlier");
    assert_eq!(found(&trial), [9000], "seed 15");
    trial.character.level_switches = true;
    assert_eq!(found(&trial), [9000], "seed 15, where the level switches");
}

#[test]
fn of_many_outliers_few_are_taken_for_jumps_and_all_stay() {
    const SEED: u64 = 16;
    let mut values = noise(SEED);
    for place in (1000..15_000).step_by(1000) {
        values[place] += 60.0;
    }
    trial::add(&mut values, &Wave::Steps(vec![trial::jump(7500, 25.0)]));
    let mut trial = Trial::new(values);
    let seen = trial.axis.whitened();
    let usable = filtered(&trial.axis);
    let alike = filter::outliers(&seen.transform, &seen.density, trial::LEVEL, usable, |_| {
        1.0
    });
    let left = |trial: &Trial| {
        trial.look(|look| jumps::without(look, alike.outliers.clone(), &[], &seen.density).len())
    };
    assert_eq!(left(&trial), alike.outliers.len(), "seed {SEED}");
    trial.character.level_switches = true;
    assert!(
        left(&trial) < alike.outliers.len(),
        "seed {SEED}: one is a jump"
    );
}

#[test]
fn outliers_are_sought_again_once_something_else_was_explained() {
    // Beside the line only the larger ones stand out.
    let line = Wave::Line {
        cycles: 0.123,
        cosine: 6.0,
        sine: 0.0,
        lost: None,
    };
    let mut values = noise(16);
    trial::add(&mut values, &line);
    let sizes = [50.0, 9.0, 50.0, 9.0];
    for (place, size) in APART.into_iter().zip(sizes) {
        values[place] += size;
    }
    let mut trial = Trial::new(values);
    let large = [outlier(APART[0], 48.0), outlier(APART[2], 51.0)];
    let waves = vec![Wave::Outliers(Arc::new(large.to_vec()))];
    trial.know(KIND, [0.01, 50.0], Change::Waves(waves));
    let change = Change::Waves(vec![line]);
    trial.know(crate::model::sinusoid::KIND, [12.3, 6.0], change);
    let proposals = trial.ask(&DETECTOR);
    assert!(trial::teaches(&proposals, &Lesson::OutliersSoughtAmong(2)));
    let again = trial::candidate(proposals).expect("the smaller ones stand out now");
    assert_eq!(again.amends, Some(0));
    trial.accept(again);
    assert_eq!(trial.axis.residual.outliers().len(), APART.len());
    trial.character.learn(Lesson::OutliersSoughtAmong(2));
    assert!(trial.ask(&DETECTOR).is_empty(), "looked for again");
}

#[test]
fn outliers_that_are_found_again_where_they_were_are_left_as_they_are() {
    let mut values = noise(18);
    APART.iter().for_each(|&place| values[place] += 50.0);
    let mut trial = Trial::new(values);
    let known: Vec<_> = APART.iter().map(|&place| outlier(place, 40.0)).collect();
    let waves = vec![Wave::Outliers(Arc::new(known))];
    trial.know(KIND, [0.01, 50.0], Change::Waves(waves));
    trial.character.learn(Lesson::OutliersSoughtAmong(1));
    let proposals = trial.ask(&DETECTOR);
    assert!(
        trial::teaches(&proposals, &Lesson::OutliersSoughtAmong(1)),
        "seed 18: {proposals:?}"
    );
    assert!(trial::candidate(proposals).is_none(), "seed 18");
}

#[test]
fn outliers_that_are_none_any_more_are_taken_back() {
    let mut trial = Trial::new(noise(17));
    let waves = vec![Wave::Outliers(Arc::new(vec![outlier(APART[0], 0.5)]))];
    trial.know(KIND, [0.01, 0.5], Change::Waves(waves));
    assert!(trial::withdraws(&trial.ask(&DETECTOR), KIND));
}

#[test]
fn a_shock_of_one_sample_is_one_of_the_outliers() {
    for (samples, is_one) in [(1.2, true), (12.0, false)] {
        let duration_s = samples / trial::RATE_HZ;
        let shock = Shock {
            time_s: 60.0,
            peak: 40.0,
            duration_s,
            f_hz: 0.0,
            decay_s: 0.0,
        };
        let wave = Wave::Shocks {
            shocks: vec![shock],
            rate_hz: trial::RATE_HZ,
        };
        let mut measured = noise(20);
        APART.iter().for_each(|&place| measured[place] += 9.0);
        trial::add(&mut measured, &wave);
        let mut trial = Trial::new(measured);
        let values = [60.0, 40.0, duration_s, 0.0, 0.0];
        trial.know(shock::KIND, values, Change::Waves(vec![wave]));
        let named = trial::candidate(trial.ask(&DETECTOR)).expect("outliers");
        assert_eq!(named.effect.kind, KIND, "seed 20, {samples} samples");
        let goes = named.supersedes.contains(&shock::KIND);
        assert_eq!(goes, is_one, "seed 20, {samples} samples");
    }
}

#[test]
fn a_mean_that_begins_is_no_outlier() {
    let seed = 21;
    let raw = noise(seed);
    let mean = |n: usize| {
        let window = &raw[(n + 1_usize).saturating_sub(12)..=n];
        window.iter().sum::<f64>() / window.len() as f64
    };
    let mut measured: Vec<f64> = (0..raw.len()).map(mean).collect();
    // Two deviations and a half of a sample by itself, nearly nine of a mean over twelve; or what no sample by itself is.
    measured[0] = 2.5;
    let alone = measured.clone();
    measured[0] = 9.0;
    let law = Law {
        effect: averaging::KIND,
        values: vec![12.0 / trial::RATE_HZ],
    };
    for (first, is_outlier) in [(alone, false), (measured, true)] {
        let mut trial = Trial::new(first);
        assert!(
            trial::candidate(trial.ask(&DETECTOR)).is_some(),
            "seed {seed}: nothing is known of a filter"
        );
        trial.know(averaging::KIND, [law.values[0]], Change::Law(law.clone()));
        let found = trial::candidate(trial.ask(&DETECTOR));
        assert_eq!(found.is_some(), is_outlier, "seed {seed}");
    }
}

#[test]
fn few_outliers_are_dated_one_by_one() {
    let all: Vec<_> = (1..=17).map(|n| outlier(1000 * n, 9.0)).collect();
    assert_eq!(dated(&all[..16], trial::RATE_HZ).len(), 2 * 16);
    assert_eq!(dated(&all, trial::RATE_HZ).len(), 0);
}
