//! Each of what makes a tone, by windows, lines and courses in which it alone decides.

use realfft::num_complex::Complex64;

use super::*;
use crate::model::motion;

/// What windows say in which a tone has this energy.
const fn said(energy: f64, share: f64, p_value: f64) -> Option<Steadiness> {
    Some(Steadiness {
        energy,
        p_value,
        share,
    })
}

#[test]
fn a_tone_grows_with_its_windows_and_is_steadier_than_noise_by_more_than_chance() {
    let is_tone = |before, share, p_value| {
        let both = [before, said(6.0, share, p_value)];
        plainest(&both, trial::LEVEL) == Some(1)
    };
    assert!(is_tone(said(3.0, 0.0, 1.0), 1.0, 1e-9));
    assert!(!is_tone(said(5.0, 0.0, 1.0), 1.0, 1e-9), "does not grow");
    assert!(!is_tone(None, 1.0, 1e-9), "nothing is known of its growth");
    assert!(!is_tone(said(3.0, 0.0, 1.0), 0.5, 1e-9), "as narrow noise");
    assert!(!is_tone(said(3.0, 0.0, 1.0), 1.0, 1e-3), "by chance");
}

#[test]
fn the_first_windows_in_which_a_tone_is_strong_are_the_best_or_else_the_surest() {
    let best = |p_values: [f64; 5], first: f64| {
        let energy = |number: usize| first * f64::from(1 << number);
        let all = p_values.iter().enumerate();
        let all: Vec<_> = all.map(|(n, p)| said(energy(n), 1.0, *p)).collect();
        plainest(&all, trial::LEVEL)
    };
    let [sure, surer] = [1e-6, 1e-9];
    assert_eq!(best([1.0, sure, surer, sure, surer], 1.0), Some(3));
    assert_eq!(best([1.0, sure, surer, sure, sure], 0.1), Some(2));
}

/// Noise with lines that fade towards both ends of the record or do not.
fn with_lines(seed: u64, lines_hz: &[f64], fades: bool) -> Trial {
    let mut values = noise(seed);
    let length = values.len() as f64;
    for (n, value) in values.iter_mut().enumerate() {
        let fading = 0.5 - 0.5 * (TAU * n as f64 / length).cos();
        let size = if fades { 0.5 * fading } else { 0.5 };
        let turns = lines_hz.iter().map(|f_hz| f_hz * n as f64 / RATE_HZ);
        *value += size * turns.map(|turns| (TAU * turns).cos()).sum::<f64>();
    }
    Trial::new(values)
}

#[test]
fn only_lines_that_are_not_steady_and_not_known_are_suspected() {
    let suspected = |trial: &Trial| trial.look(suspects).len();
    for lines_hz in [&[20.0][..], &[11.0, 22.0, 33.0]] {
        let steady = with_lines(8, lines_hz, false);
        assert!(
            !lines::lines(&steady.axis, trial::LEVEL).is_empty(),
            "seed 8"
        );
        assert_eq!(suspected(&steady), 0, "seed 8: {lines_hz:?}");
        let mut fading = with_lines(8, lines_hz, true);
        assert_ne!(suspected(&fading), 0, "seed 8: {lines_hz:?}");
        fading.exclude(5.0, 40.0);
        assert_eq!(suspected(&fading), 0, "seed 8: {lines_hz:?}, excluded");
    }
}

#[test]
fn a_multiple_that_folds_or_lies_partly_in_an_excluded_band_is_none_of_it() {
    let count = |f_hz: f64, excluded_hz: Range<f64>| {
        let mut trial = with(1, &tone(f_hz, &[0.5, 0.4]), |_| 1.0);
        if !excluded_hz.is_empty() {
            trial.exclude(excluded_hz.start, excluded_hz.end);
        }
        let (_, values) = found(&trial).expect("a plain tone");
        values.len() - wandering_line::FIRST_AMPLITUDE
    };
    assert_eq!(count(23.5, 0.0..0.0), 2, "seed 1");
    // Beyond 0.48 of the rate.
    assert_eq!(count(24.2, 0.0..0.0), 1, "seed 1");
    assert_eq!(count(20.0, 40.0..42.0), 1, "seed 1");
}

/// A band about a tone and the tone as it is followed there.
fn followed(seed: u64) -> (Band, Track) {
    let trial = with(seed, &tone(20.0, &[0.5]), |_| 1.0);
    let band = Band::about(
        &trial.axis,
        &trial.axis.whitened(),
        &(19.8..20.2),
        ROOM,
        None,
    );
    let band = band.expect("a band");
    let best = steadiest(&trial.axis, &band).expect("a plain tone");
    (band, best.0)
}

#[test]
fn of_too_few_windows_there_is_no_course() {
    let (band, mut track) = followed(5);
    // Where the ring closes none counts; frequencies lie between two windows.
    let first = track.counts.iter().position(|counts| *counts);
    let last = first.expect("windows that count") + 16;
    track.counts[last + 1..].fill(false);
    assert!(course(&band, &track).is_some(), "seed 5");
    track.counts[last] = false;
    assert!(course(&band, &track).is_none(), "seed 5");
}

#[test]
fn where_nothing_was_measured_a_course_does_not_move() {
    let (band, mut track) = followed(5);
    track.counts[10..14].fill(false);
    let wander_hz = |track: &Track| course(&band, track).expect("a course").wander_hz;
    let before = wander_hz(&track);
    track.places[10..14]
        .iter_mut()
        .for_each(|place| *place += 50.0);
    assert_eq!(wander_hz(&track), before, "seed 5");
}

#[test]
fn what_fills_a_quarter_of_the_spectrum_is_no_line() {
    let is_named = |rms_hz: f64, time_s: f64, reach_hz: f64| {
        let wide = WanderingLine {
            wander: Wander { rms_hz, time_s },
            ..tone(25.0, &[3.0])
        };
        let trial = with(1, &wide, |_| 1.0);
        let within_hz = 25.0 - reach_hz..25.0 + reach_hz;
        trial.look(|look| named(look, &within_hz, 1e-9).is_some())
    };
    // It fills some 8 Hz of 50, and some 17.
    assert!(is_named(2.0, 200.0, 1.0), "seed 1");
    assert!(!is_named(2.0, 20.0, 4.0), "seed 1");
}

/// What is 60 dB above the noise stands above it an octave away still.
#[test]
fn a_tone_far_above_the_noise_is_one_line_however_far_its_skirts_reach() {
    let (kind, values) = found(&with(13, &tone(4.0, &[1000.0]), |_| 1.0)).expect("a plain tone");
    assert_eq!(kind, wandering_line::KIND, "seed 13");
    let amplitudes = &values[wandering_line::FIRST_AMPLITUDE..];
    let [Some(amplitude)] = amplitudes else {
        panic!("seed 13: multiples that are not there: {amplitudes:?}");
    };
    assert!(
        (amplitude.value / 1000.0 - 1.0).abs() < 0.01,
        "seed 13: {amplitude:?}"
    );
}

#[test]
fn noise_as_loud_as_far_as_the_next_multiple_is_no_line() {
    let trial = with(5, &tone(20.0, &[0.5]), |_| 1.0);
    let (mut band, track) = followed(5);
    let seen = trial.axis.whitened();
    let within = |band: &Band, own: u32| {
        let place = |f_hz: f64| (f_hz / band.step_hz) as usize - band.first;
        let tone = Tone {
            seen: &seen,
            band,
            track: &track,
            f_hz: 20.0,
            own: place(19.9)..place(20.1),
        };
        // A sixteenth of the tone's frequency is a good part of the band.
        harmonics::up_to_next(band, &(0..band.ordinates.len()), &tone, [own, own])
    };
    let inside = within(&band, 16).expect("a line");
    let ends = |place: usize| band.frequency_hz(place as f64);
    let half_way = 0.5 * 20.0 / 16.0;
    assert!(
        (ends(inside.start) - (20.0 - half_way)).abs() < 2.0 * band.step_hz,
        "seed 5"
    );
    assert!(
        (ends(inside.end) - (20.0 + half_way)).abs() < 2.0 * band.step_hz,
        "seed 5"
    );
    band.ordinates.fill(Complex64::new(3.0, 0.0));
    assert_eq!(within(&band, 16), None, "as loud everywhere");
}

#[test]
fn what_the_strongest_lower_multiple_leaks_is_no_base() {
    assert_eq!(harmonics::number(&[]), 1);
    assert_eq!(harmonics::number(&[(2, 1.0), (3, 0.05)]), 2);
    assert_eq!(harmonics::number(&[(2, 1.0), (4, 0.2)]), 4);
}

#[test]
fn a_tone_that_was_taken_for_motion_is_followed_through_it() {
    // Where it goes furthest, for a tenth of the record.
    let mut values = noise(14);
    let far = 0..values.len() / 10;
    let mut turns = 0.0;
    let mut drawn = numbers(14, 3);
    let mut off_hz = 0.0;
    for (n, value) in values.iter_mut().enumerate() {
        // Over 5 s by 0.05 Hz.
        off_hz += 0.002 * (0.05 * drawn.draw() * 1000_f64.sqrt() - off_hz);
        turns += (20.0 + off_hz + if far.contains(&n) { 1.0 } else { 0.0 }) / RATE_HZ;
        *value += 3.0 * (TAU * turns).cos();
    }
    let mut trial = Trial::new(values);
    let seconds = far.len() as f64 / RATE_HZ;
    let happened = Change::Happened {
        masked: vec![far],
        waves: Vec::new(),
    };
    trial.know(
        motion::KIND,
        [0.0, seconds, 0.0, 21.0, 0.1, 1.5, 0.0, 0.0],
        happened,
    );
    let named = trial.look(|look| named(look, &(19.8..20.2), 1e-9));
    let candidate = trial::candidate(named.into_iter().collect()).expect("a plain tone");
    assert!(candidate.supersedes.contains(&motion::KIND), "seed 14");
    let Change::Tone(bands_hz) = &candidate.change else {
        panic!("seed 14: {:?}", candidate.change);
    };
    assert!(bands_hz[0].contains(&21.0), "seed 14: {bands_hz:?}");
}

#[test]
fn a_tone_that_glides_far_does_not_wander() {
    // From 20 Hz on, in 200 s: as far as a clock drifts, and as what runs up does.
    for (seed, far_hz, is_named) in [(90, 0.4, true), (91, 4.0, false), (92, -4.0, false)] {
        let mut values = noise(seed);
        let count = values.len() as f64;
        for (n, value) in values.iter_mut().enumerate() {
            let share = n as f64 / count;
            let cycles = (20.0 + 0.5 * far_hz * share) * n as f64 / RATE_HZ;
            *value += 2.0 * (TAU * cycles).sin();
        }
        let trial = Trial::new(values);
        let named = trial.look(|look| {
            let ends_hz = [20.0, 20.0 + far_hz];
            let within_hz = ends_hz[0].min(ends_hz[1])..ends_hz[0].max(ends_hz[1]);
            named(look, &within_hz, 1e-9).is_some()
        });
        assert_eq!(named, is_named, "seed {seed}, {far_hz} Hz");
    }
}

#[test]
fn mains_of_which_some_multiples_are_known_are_followed_with_all_of_them() {
    let (mut trial, seed) = wandering_mains(&[0.5, 0.5]);
    // The first was found by itself.
    let known = Change::Tone(vec![49.0..51.0]);
    trial.know(hum::KIND, [50.0, 0.1, 1.0, 0.5], known);
    let named = trial::candidate(trial.ask(&DETECTOR)).expect("plain mains");
    assert_eq!(named.effect.kind, hum::KIND, "seed {seed}");
    assert_eq!(named.supersedes, [hum::KIND], "seed {seed}");
    let amplitudes = named.effect.values[hum::FIRST_AMPLITUDE..].iter();
    let amplitudes: Vec<f64> = amplitudes.flatten().map(|one| one.value).collect();
    assert_eq!(amplitudes.len(), 2, "seed {seed}: {amplitudes:?}");
}

#[test]
fn mains_of_which_fewer_multiples_are_followed_stay_as_they_were() {
    let (mut trial, seed) = wandering_mains(&[0.5, 0.5]);
    let known = Change::Tone(vec![49.0..51.0, 149.0..151.0, 249.0..251.0]);
    trial.know(hum::KIND, [50.0, 0.1, 1.0, 0.5], known);
    let named = trial::candidate(trial.ask(&DETECTOR));
    assert!(named.is_none(), "seed {seed}: {named:?}");
}

#[test]
fn multiples_that_are_all_multiples_of_one_have_that_as_their_base() {
    let common = |numbers: &[u32]| numbers.iter().copied().fold(0, harmonics::gcd);
    assert_eq!(common(&[4, 8]), 4);
    assert_eq!(common(&[6, 9, 12]), 3);
    assert_eq!(common(&[2, 3]), 1, "neither is the other's");
    assert_eq!(common(&[]), 0, "no line, no base");
}
