//! What looks like a line and is none by itself.

mod close;
mod cycles;
mod excluded;
mod lobes;
mod mains;

use std::f64::consts::TAU;

use super::*;
use crate::diagnosis::detect::trial::{self, Trial, noise};
use crate::diagnosis::laws::Law;
use crate::model::kind::Kind;
use crate::model::resonance::Resonance;
use crate::model::{Seed, Term, wandering_line};

/// A line as it is measured.
fn measured(f_hz: f64) -> Measured {
    Measured {
        line: Line {
            frequency_hz: f_hz,
            frequency_sd_hz: 1e-3,
            amplitude: 1.0,
            ratio: 100.0,
            false_alarm: 1e-9,
        },
        wave: trial::line(f_hz, 1.0),
        amplitude_sd: 0.01,
    }
}

/// Frequencies at which single lines are proposed.
fn single_hz(trial: &Trial, all: &[f64]) -> Vec<f64> {
    let groups = all.iter().map(|f_hz| Group::Single(measured(*f_hz)));
    let proposals = trial.look(|look| proposals(look, groups.collect(), |_| false));
    let first = |one: Proposal| match one {
        Proposal::Explain(candidate) => candidate.effect.plain()[0],
        other => panic!("{other:?}"),
    };
    proposals.into_iter().map(first).collect()
}

#[test]
fn single_samples_no_larger_than_a_tone_are_looked_for_again_beside_it() {
    for (size, is_asked) in [(0.5, true), (2.0, false)] {
        let mut trial = with_line(9, false);
        trial.know(outliers::KIND, [1.0, size], Change::Waves(Vec::new()));
        // Its amplitude is 1.
        let line = trial.look(|look| single(look, &mut Vec::new(), measured(3.7)));
        let Some(Proposal::Explain(candidate)) = line else {
            panic!("seed 9: no line");
        };
        let asks = candidate.reopens.contains(&outliers::KIND);
        assert_eq!(asks, is_asked, "seed 9, {size}");
    }
}

/// Noise with a line at 3.7 Hz, which `fades` towards both ends or does not.
fn with_line(seed: u64, fades: bool) -> Trial {
    let mut values = noise(seed);
    let length = values.len() as f64;
    for (n, value) in values.iter_mut().enumerate() {
        let turns = n as f64 / length;
        let size = if fades {
            0.5 - 0.5 * (TAU * turns).cos()
        } else {
            1.0
        };
        *value += 0.5 * size * (TAU * 0.037 * n as f64).cos();
    }
    Trial::new(values)
}

#[test]
fn lines_within_excluded_bands_are_left() {
    let mut trial = with_line(6, false);
    assert_eq!(
        trial::kinds(&trial.ask(&DETECTOR)),
        [sinusoid::KIND],
        "seed 6"
    );
    trial.exclude(3.0, 4.4);
    assert!(trial.ask(&DETECTOR).is_empty(), "seed 6");
    // Of a machine's lines the others stay.
    let mut values = noise(6);
    for f_hz in [11.0, 22.0, 33.0] {
        trial::add(&mut values, &trial::line(f_hz, 0.5));
    }
    let mut trial = Trial::new(values);
    let there = |trial: &Trial| -> Vec<bool> {
        let hum = trial::candidate(trial.ask(&DETECTOR)).expect("a machine");
        assert_eq!(hum.effect.kind, hum::KIND, "seed 6");
        let amplitudes = hum.effect.values.iter().skip(hum::FIRST_AMPLITUDE);
        amplitudes.map(Option::is_some).collect()
    };
    assert_eq!(there(&trial), [true; 3], "seed 6");
    trial.exclude(21.0, 23.0);
    assert_eq!(there(&trial), [true, false, true], "seed 6");
}

#[test]
fn a_line_that_wanders_is_left_and_then_excluded() {
    let steady = with_line(0, false);
    assert_eq!(
        trial::kinds(&steady.ask(&DETECTOR)),
        [sinusoid::KIND],
        "seed 0"
    );
    assert!(steady.ask(&WANDERING).is_empty(), "seed 0");
    let mut fading = with_line(0, true);
    assert!(fading.ask(&DETECTOR).is_empty(), "seed 0, fading");
    let excluded = fading.ask(&WANDERING);
    let Some(Proposal::ExcludeLine(line)) = excluded.first() else {
        panic!("seed 0, fading: {excluded:?}");
    };
    assert!(
        line.band_hz.contains(&3.7),
        "seed 0, fading: {:?}",
        line.band_hz
    );
    assert_eq!(excluded.len(), 1, "what is left beside it is no second one");
    fading.exclude(3.0, 4.4);
    assert!(fading.ask(&WANDERING).is_empty(), "seed 0: excluded again");
}

#[test]
fn what_is_left_of_a_steady_line_is_not_excluded() {
    let mut fading = with_line(0, true);
    assert!(!fading.ask(&WANDERING).is_empty(), "seed 0");
    // What fades has a height of a quarter on average. Of a line of height 1 that was taken out beside it that is more than a
    // hundredth of the energy, of one of height 10 it is less.
    for (height, is_left) in [(1.0, false), (10.0, true)] {
        // Put in as well as taken out, so that nothing else changes.
        let both = [height, -height].map(|height| trial::line(3.705, height));
        let out = Change::Waves(both.to_vec());
        fading.know(sinusoid::KIND, [3.705, height], out);
        assert_eq!(
            fading.ask(&WANDERING).is_empty(),
            is_left,
            "seed 0, {height}"
        );
    }
}

#[test]
fn of_the_two_peaks_of_a_line_that_turns_once_one_is_excluded() {
    let mut values = noise(7);
    let half = values.len() / 2;
    for (n, value) in values.iter_mut().enumerate() {
        let size = if n < half { 0.15 } else { -0.15 };
        *value += size * (TAU * 0.037 * n as f64).cos();
    }
    let trial = Trial::new(values);
    let groups = lines(&trial.axis, trial::LEVEL);
    assert!(
        matches!(&groups[..], [Group::Single(_), Group::Single(_)]),
        "seed 7: {groups:?}"
    );
    assert_eq!(trial.ask(&WANDERING).len(), 1, "seed 7");
}

/// Makes a resonance known.
fn know_resonance(trial: &mut Trial, f_hz: f64) {
    let law = Law {
        effect: resonance::KIND,
        values: vec![f_hz, 0.2, 1.0],
    };
    trial.accept(Candidate::new(
        Estimate::of_law(resonance::KIND),
        1e-9,
        3.0,
        Change::Law(law),
    ));
    let about = resonances_hz(&trial.axis);
    assert!(about[0].contains(&f_hz), "{f_hz} Hz: {about:?}");
}

#[test]
fn the_top_of_a_resonance_is_no_line() {
    let mut trial = Trial::new(noise(1));
    know_resonance(&mut trial, 20.0);
    let [about] = &resonances_hz(&trial.axis)[..] else {
        panic!("seed 1: no resonance");
    };
    let far_hz = about.end + 1.0;
    let within_hz = 0.5 * (about.start + about.end);
    assert_eq!(single_hz(&trial, &[within_hz, far_hz]), [far_hz], "seed 1");
}

#[test]
fn a_line_that_wanders_within_a_resonance_is_left_to_it() {
    // Four widths from the top a resonance has little of its power, far from there it has none.
    for (f_hz, amplitude, count) in [(20.8, 0.3, 0), (3.7, 0.15, 1)] {
        let mut values = noise(9);
        let rings = Resonance {
            f_hz: 20.0,
            width_hz: 0.2,
            amplitude: 1.0,
        };
        let random = Seed { seed: 9, stream: 7 };
        rings.generator(trial::RATE_HZ, random).add_to(&mut values);
        let half = values.len() / 2;
        for (n, value) in values.iter_mut().enumerate() {
            let size = if n < half { amplitude } else { -amplitude };
            *value += size * (TAU * f_hz / trial::RATE_HZ * n as f64).cos();
        }
        let mut trial = Trial::new(values);
        know_resonance(&mut trial, 20.0);
        assert_eq!(trial.ask(&WANDERING).len(), count, "seed 9: {f_hz}");
    }
}

#[test]
fn what_is_left_beside_a_line_is_no_second_one() {
    let mut trial = Trial::new(noise(2));
    // Of two that are found together as well.
    assert_eq!(
        single_hz(&trial, &[30.0, 30.05, 12.02, 13.0]),
        [30.0, 12.02, 13.0],
        "seed 2"
    );
    let out = Change::Waves(vec![trial::line(12.0, 0.0)]);
    trial.know(sinusoid::KIND, [12.0, 0.0], out);
    assert_eq!(single_hz(&trial, &[12.02, 13.0]), [13.0], "seed 2");
    trial.refuse(sinusoid::KIND);
    assert!(single_hz(&trial, &[13.0]).is_empty(), "seed 2: refused");
}

#[test]
fn what_is_left_of_a_cluster_is_no_line() {
    let lines = [20.0, 20.05, 20.1].map(|f_hz| measured(f_hz).line).to_vec();
    let cluster = Group::Cluster {
        f_hz: 20.05,
        width_hz: 0.1,
        lines,
    };
    let trial = Trial::new(noise(3));
    let proposals = trial.look(|look| proposals(look, vec![cluster], |_| false));
    assert!(proposals.is_empty(), "seed 3: {proposals:?}");
}

#[test]
fn a_harmonic_is_added_to_the_mains_that_are_there() {
    let found = |kind: Kind, waves: Vec<Wave>, base_hz: f64| {
        let mut trial = Trial::new(noise(4));
        trial.know(kind, [50.0, 0.0, 0.0, 2.0], Change::Waves(waves));
        let lines = vec![(1, measured(50.0)), (3, measured(150.0))];
        let group = Group::Hum {
            base_hz,
            base_sd_hz: 1e-3,
            lines,
        };
        let proposals = trial.look(|look| proposals(look, vec![group], |_| false));
        trial::candidate(proposals).expect("mains")
    };
    let known = || vec![trial::line(49.0, 0.0)];
    // Of another base, without lines that were taken out, and no mains at all: another one.
    assert_eq!(found(hum::KIND, known(), 60.0).amends, None, "seed 4");
    assert_eq!(found(hum::KIND, Vec::new(), 50.1).amends, None, "seed 4");
    assert_eq!(found(sinusoid::KIND, known(), 50.1).amends, None, "seed 4");
    let found = found(hum::KIND, known(), 50.1);
    assert_eq!(found.amends, Some(0), "seed 4");
    let values: Vec<Option<f64>> = found
        .effect
        .values
        .iter()
        .map(|one| one.map(|one| one.value))
        .collect();
    let known = [Some(50.0), Some(0.0), Some(0.0), Some(2.0), None];
    assert_eq!(values[..5], known, "seed 4");
    assert!(
        values.len() == 6 && values[5].is_some(),
        "seed 4: {values:?}"
    );
    assert!(
        matches!(&found.change, Change::Waves(waves) if waves.len() == 3),
        "seed 4"
    );
}

/// The same, plain, with a third of every 15 s missing, which gives it others beside it, a fifteenth of a hertz apart.
fn with_gaps(seed: u64, fades: bool) -> Trial {
    let whole = with_line(seed, fades);
    let measured = whole.axis.residual.measured().iter().enumerate();
    let values = measured.map(|(n, value)| if n % 1500 < 500 { f64::NAN } else { *value });
    Trial::new(values.collect())
}

#[test]
fn where_much_is_missing_the_strongest_of_a_cluster_is_a_line() {
    let trial = with_gaps(5, false);
    let groups = lines(&trial.axis, trial::LEVEL);
    assert!(trial.axis.lines(trial::LEVEL).len() >= 3, "seed 5");
    assert!(
        matches!(&groups[..], [Group::Single(_)]),
        "seed 5: {groups:?}"
    );
    let line = trial::candidate(trial.ask(&DETECTOR)).expect("a plain line");
    // It is known to far less than a hundredth of what is between it and its neighbours.
    let f_hz = line.effect.plain()[0];
    assert!((f_hz - 3.7).abs() < 1e-3, "seed 5: {f_hz} Hz");
}

#[test]
fn a_few_cycles_are_no_line() {
    let trial = Trial::new(noise(7));
    let is_line = |cycles: f64| {
        trial.look(|look| unresolved(look, cycles / look.duration_s(), 1e-9).is_some())
    };
    assert!(is_line(70.0), "seed 7");
    assert!(!is_line(60.0), "seed 7");
}

#[test]
fn what_is_too_narrow_for_a_resonance_and_does_not_keep_its_size_is_no_line() {
    let is_line = |fades| with_line(9, fades).look(|look| unresolved(look, 3.7, 1e-9).is_some());
    assert!(is_line(false), "seed 9");
    assert!(!is_line(true), "seed 9: fades");
}

#[test]
fn what_is_beside_a_tone_by_less_than_its_width_is_left_of_it() {
    let named = |from_hz: f64, to_hz: f64| {
        let mut trial = with_line(8, false);
        let band = from_hz..to_hz;
        trial.know(
            wandering_line::KIND,
            [0.5 * (from_hz + to_hz), 0.1, 1.0, 1.0],
            Change::Tone(vec![band]),
        );
        trial::candidate(trial.ask(&DETECTOR)).is_some()
    };
    // The line is at 3.7 Hz.
    assert!(!named(3.8, 4.0), "seed 8");
    assert!(named(4.0, 4.2), "seed 8");
}
