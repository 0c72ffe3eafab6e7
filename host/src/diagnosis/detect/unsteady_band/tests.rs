//! What becomes of a band that comes and goes.

use super::*;
use crate::diagnosis::detect::look::Lesson;
use crate::diagnosis::detect::trial::{self, Trial, noise};
use crate::diagnosis::explanation::Change;
use crate::diagnosis::record::wave::Wave;
use crate::model::kind::Kind;
use crate::model::random::Seed;
use crate::model::shock::Shock;
use crate::model::wander::Wander;
use crate::model::{Term, telegraph, wandering_line};

/// Samples from one moment at which the band comes to the next; it stays for a fifth of them.
const PERIOD: usize = 1500;

/// Adds a band about 20 Hz that comes and goes.
fn add_band(values: &mut [f64], seed: u64) {
    trial::add_band(values, seed, 1.2, |n| {
        if n % PERIOD < PERIOD / 5 { 1.0 } else { 0.0 }
    });
}

/// Noise with such a band.
fn values(seed: u64) -> Vec<f64> {
    let mut values = noise(seed);
    add_band(&mut values, seed);
    values
}

/// The band that is excluded, and what may have been found for it.
fn excluded(trial: &Trial) -> Option<(Range<f64>, Vec<Kind>)> {
    let mut proposals = trial.ask(&DETECTOR);
    match proposals.pop()? {
        Proposal::Exclude(excluded, kinds) => Some((excluded.band_hz, kinds)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_band_that_comes_and_goes_is_excluded() {
    let (band_hz, kinds) = excluded(&Trial::new(values(0))).expect("a plain band");
    assert!(
        band_hz.start < 20.0 && 20.0 < band_hz.end,
        "seed 0: {band_hz:?}"
    );
    assert!(band_hz.end - band_hz.start < 12.5, "seed 0: {band_hz:?}");
    assert_eq!(kinds, [outliers::KIND], "seed 0");
    assert!(excluded(&Trial::new(noise(0))).is_none(), "seed 0: steady");
}

#[test]
fn all_of_the_noise_is_no_band() {
    let values = noise(1).into_iter().enumerate();
    let all = values.map(|(n, value)| {
        if (n / PERIOD).is_multiple_of(2) {
            2.0 * value
        } else {
            value
        }
    });
    let mut trial = Trial::new(all.collect());
    trial.character.strength_moves = true;
    let found = noise::unsteady(&trial.axis, 0.0..50.0, &[], trial::LEVEL);
    assert!(found.is_some(), "seed 1: steady");
    assert!(excluded(&trial).is_none(), "seed 1");
}

#[test]
fn a_band_that_small_outliers_make_is_theirs() {
    // Of a tenth of the density there, or of all of it and as few: chance may make it as unsteady.
    for (size, is_excluded) in [(1.0, true), (300.0, false)] {
        let mut trial = Trial::new(values(7));
        trial.know(outliers::KIND, [0.1, size], Change::Waves(Vec::new()));
        assert_eq!(
            excluded(&trial).is_some(),
            is_excluded,
            "seed 7, size {size}"
        );
    }
}

#[test]
fn outliers_make_no_band_that_is_steadier_than_noise() {
    let mut trial = Trial::new(noise(10));
    trial.know(outliers::KIND, [0.1, 300.0], Change::Waves(Vec::new()));
    for (variance, is_theirs) in [(0.1, true), (-0.1, false)] {
        let found = Unsteady {
            from_hz: 19.0,
            to_hz: 21.0,
            peak_hz: 20.0,
            tile_s: 1.0,
            variance,
            p_value: 1e-9,
        };
        let is_of_outliers = is_of_outliers(&trial.axis, &found);
        assert_eq!(is_of_outliers, is_theirs, "seed 10, {variance}");
    }
}

#[test]
fn a_tone_that_wanders_has_a_name_and_is_not_excluded() {
    let tone = wandering_line::WanderingLine {
        f_hz: 20.0,
        wander: Wander {
            rms_hz: 0.05,
            time_s: 5.0,
        },
        amplitudes: vec![0.5],
    };
    let seed = Seed {
        seed: 11,
        stream: 7,
    };
    let mut values = noise(11);
    tone.generator(trial::RATE_HZ, seed).add_to(&mut values);
    let kinds = trial::kinds(&Trial::new(values).ask(&DETECTOR));
    assert_eq!(kinds, [wandering_line::KIND], "seed 11");
}

#[test]
fn a_band_that_a_long_burst_makes_is_its_own() {
    // The long stretch has as much of the band as the rest of the record; a short one may be a shock that rings.
    for (length, factor, is_excluded) in [(0, 1.0, true), (PERIOD, 1.6, false), (600, 2.0, true)] {
        let mut values = values(3);
        values[6 * PERIOD..6 * PERIOD + length]
            .iter_mut()
            .for_each(|one| *one *= factor);
        let trial = Trial::new(values);
        let stretch = trial.look(burst::even);
        assert_eq!(stretch.is_some(), length > 0, "seed 3, {length}");
        assert_eq!(
            excluded(&trial).is_some(),
            is_excluded,
            "seed 3, {length}: {stretch:?}"
        );
    }
}

#[test]
fn jumps_at_its_moments_may_have_been_found_for_it() {
    for (offset, is_named) in [(PERIOD / 10, true), (PERIOD * 3 / 5, false)] {
        let mut trial = Trial::new(values(9));
        let at = |period: usize| trial::jump(period * PERIOD + offset, 0.0);
        trial.know(
            steps::KIND,
            [0.0; 2],
            trial::steps(&[3, 5, 7, 9, 11].map(at)),
        );
        let (_, kinds) = excluded(&trial).expect("a plain band");
        assert_eq!(kinds.contains(&steps::KIND), is_named, "seed 9, {offset}");
    }
}

#[test]
fn a_level_that_switches_is_named_before_a_band_is_excluded() {
    let (mut values, _) = trial::switching(8, 4.0);
    add_band(&mut values, 8);
    let proposals = Trial::new(values).ask(&DETECTOR);
    assert!(
        trial::teaches(&proposals, &Lesson::LevelSwitches),
        "seed 8: {proposals:?}"
    );
    let is_excluded = |one: &Proposal| matches!(one, Proposal::Exclude(..));
    assert!(!proposals.iter().any(is_excluded), "seed 8");
}

#[test]
fn where_two_levels_decide_no_band_is_looked_at() {
    for (dwell_s, is_excluded) in [(20.0, true), (1.0, false)] {
        let mut trial = Trial::new(values(5));
        trial.know(telegraph::KIND, [1.0, dwell_s], trial::steps(&[]));
        assert_eq!(
            excluded(&trial).is_some(),
            is_excluded,
            "seed 5, {dwell_s} s"
        );
    }
}

#[test]
fn a_record_of_many_bands_is_of_another_kind() {
    let mut trial = Trial::new(values(6));
    for number in 0..MOST_BANDS {
        if number + 1 == MOST_BANDS {
            assert!(excluded(&trial).is_some(), "seed 6, {number} bands");
        }
        let from_hz = 40.0 + number as f64;
        trial.exclude(from_hz, from_hz + 0.1);
    }
    assert_eq!(trial.axis.excluded().len(), MOST_BANDS);
    assert!(excluded(&trial).is_none(), "seed 6");
}

#[test]
fn what_comes_and_goes_beside_a_tone_is_its_own() {
    // As far on either side as it is wide itself.
    for (width_hz, is_excluded) in [(1.0, true), (12.0, false)] {
        let mut trial = Trial::new(values(0));
        let tone = Change::Tone(vec![26.5..26.5 + width_hz]);
        trial.know(wandering_line::KIND, [27.0, 0.1, 5.0, 0.1], tone);
        let found = excluded(&trial);
        assert_eq!(
            found.is_some(),
            is_excluded,
            "seed 0, {width_hz} Hz: {found:?}"
        );
    }
}

#[test]
fn shocks_no_higher_than_the_band_comes_by_itself_are_the_band() {
    let (band, _) = excluded(&Trial::new(values(0))).expect("a plain band");
    let beside_hz = |widths: f64| {
        let width_hz = band.end - band.start;
        band.end + widths * width_hz
    };
    // The band has the deviation 1.2 for a fifth of the time, 0.5 in the mean.
    for (peaks, f_hz, is_band) in [
        (&[2.0][..], beside_hz(0.4), true),
        (&[2.0], beside_hz(2.0), false),
        (&[2.0], 20.0, true),
        (&[2.0, 1.5], 20.0, true),
        (&[2.0, 9.0], 20.0, false),
        (&[2.0], 35.0, false),
        (&[2.0], 0.0, false),
    ] {
        let mut trial = Trial::new(values(0));
        let shock = |peak: &f64| Shock {
            time_s: 60.0,
            peak: *peak,
            duration_s: 2.0,
            f_hz,
            decay_s: 1.0,
        };
        let wave = Wave::Shocks {
            shocks: peaks.iter().map(shock).collect(),
            rate_hz: trial::RATE_HZ,
        };
        let change = Change::Happened {
            masked: vec![6000..6200],
            waves: vec![wave],
        };
        trial.know(shock::KIND, [60.0, 2.0, 2.0, f_hz, 1.0], change);
        let (_, kinds) = excluded(&trial).expect("a plain band");
        assert_eq!(
            kinds.contains(&shock::KIND),
            is_band,
            "seed 0, {peaks:?} at {f_hz} Hz"
        );
    }
}
