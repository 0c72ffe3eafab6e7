//! From a simulation to a fit or a diagnosis to a simulation: what comes out looks like what went in.

use inm_host::internals::analyse::{Analysis, AnalysisOptions, AxisAnalysis, analyse};
use inm_host::internals::model::PerCoefficient;
use inm_host::internals::model::published::PublishedAxis;
use inm_host::internals::model::whole::Model;
use inm_host::internals::simulate::source::Simulation;
use inm_host::{DiagnosisOptions, diagnose};

const SEED: u64 = 11;

/// 2^20 samples at 2000/s.
const LENGTH: u64 = 1 << 20;

/// Standard deviations that a point may be off: of some 400 points one in 4000 tests is.
const SIGMAS: f64 = 5.0;

fn analysed(model: &Model, length: u64, seed: u64) -> Analysis {
    let mut simulation = Simulation::new(model, length, seed).expect("a sound model");
    analyse(&mut simulation, &AnalysisOptions::default(), |_| {}).expect("it does not fail")
}

/// Relative error of a variance with `edf` degrees of freedom that is compared with another such.
fn sigma(edf: f64, other: f64) -> f64 {
    (2.0 / edf + 2.0 / other).sqrt()
}

fn compare(axis: &AxisAnalysis, again: &AxisAnalysis) {
    let mut points = 0;
    for (name, first, second) in [
        ("Allan", &axis.allan, &again.allan),
        ("modified", &axis.modified, &again.modified),
        ("Hadamard", &axis.hadamard, &again.hadamard),
    ] {
        for (a, b) in first.iter().zip(second.iter()) {
            // With fewer the law of the ratio is far from normal.
            if a.edf < 20.0 || b.edf < 20.0 {
                continue;
            }
            let off = 2.0 * (b.adev / a.adev).ln() / sigma(a.edf, b.edf);
            assert!(
                off.abs() < SIGMAS,
                "seed {SEED}, {name} m = {}: {off:.1} sigma",
                a.m
            );
            points += 1;
        }
    }
    let bins = axis.spectrum.iter().zip(&again.spectrum);
    for (a, b) in bins.filter(|(a, b)| a.edf > 20.0 && b.edf > 20.0) {
        let off = (b.psd / a.psd).ln() / sigma(a.edf, b.edf);
        assert!(
            off.abs() < SIGMAS,
            "seed {SEED}, {} Hz: {off:.1} sigma",
            a.f_hz
        );
        points += 1;
    }
    assert!(points > 200, "{points} points were compared");
}

#[test]
fn a_simulation_of_the_fitted_model_looks_like_the_record() {
    for axis in PublishedAxis::ALL {
        let mut model = Model::published(Some(axis));
        let record = analysed(&model, LENGTH, SEED);
        let fit = record.axes[0].fits.likelihood.as_ref().expect("a fit");
        let squares = fit.squares();
        model.axes[0].coefficients = PerCoefficient::from_fn(|one| squares.get(one).sqrt());
        let again = analysed(&model, LENGTH, SEED + 1);
        compare(&record.axes[0], &again.axes[0]);
    }
}

#[test]
fn another_model_does_not() {
    let record = analysed(&Model::published(Some(PublishedAxis::X)), LENGTH, SEED);
    let other = analysed(&Model::published(Some(PublishedAxis::Y)), LENGTH, SEED);
    let different = std::panic::catch_unwind(|| compare(&record.axes[0], &other.axes[0]));
    assert!(different.is_err(), "X and Y were taken for one another");
}

/// A record of a `model`'s one axis, and one of the model that its diagnosis makes.
fn diagnosed_and_simulated(model: &Model, length: u64, seed: u64) -> [AxisAnalysis; 2] {
    let mut record = Simulation::new(model, length, seed).expect("a sound model");
    let found = diagnose(&mut record, DiagnosisOptions::default(), &|_, _| {});
    let found = found.expect("a diagnosis").model();
    [(model, seed), (&found, seed + 10)].map(|(model, seed)| {
        let mut analysed = analysed(model, length, seed);
        analysed.axes.remove(0)
    })
}

/// Lines that pass a pole with the noise: a tone that keeps its frequency, and one that does not.
const BEHIND_A_POLE: [&str; 2] = [
    r#"{ "effect": "sinusoid", "parameters": { "f_hz": 130.5, "amplitude": 0.04 } }"#,
    r#"{ "effect": "wandering_line",
         "parameters": { "f_hz": 210, "wander_hz": 2, "wander_s": 3, "amplitude_1": 0.04 } }"#,
];

#[test]
fn a_simulation_of_lines_behind_a_pole_is_as_loud_as_the_record() {
    /// Share that a deviation may be off by: three standard deviations of sampling, a hundredth in each of both, of an amplitude, which is
    /// known to half of one, and of the corner's, to two thirds.
    const MOST: f64 = 0.05;
    /// Samples: enough to know all of that so well, and an odd number.
    const SHORT: u64 = 150_001;
    /// Degrees of freedom from which sampling is.
    const SURE: f64 = 5000.0;
    for (seed, line) in (21..).zip(BEHIND_A_POLE) {
        let text = format!(
            r#"{{ "schema": 1, "rate_hz": 1000, "axes": [ {{ "name": "X", "coefficients": {{ "N": 1e-3 }},
                 "effects": [ {line},
                   {{ "effect": "rolloff", "parameters": {{ "corner_hz": 50 }} }} ] }} ] }}"#
        );
        let model = Model::from_json(&text).expect("a model");
        let [before, after] = diagnosed_and_simulated(&model, SHORT, seed);
        let both = before
            .allan
            .iter()
            .zip(&after.allan)
            .filter(|(a, _)| a.edf > SURE);
        let off = both.map(|(a, b)| (a.m, b.adev / a.adev - 1.0));
        let worst = off
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            .expect("points");
        assert!(
            worst.1.abs() < MOST,
            "seed {seed}: m = {}, {:.3}",
            worst.0,
            worst.1
        );
    }
}

/// A hand that takes the sensor up, turns it, and lays it down again: it sways a thousand times as strongly as it trembles.
const TAKEN_UP: &str = r#"{ "schema": 1, "rate_hz": 1000, "axes": [ { "name": "X", "coefficients": { "N": 1e-3 },
  "effects": [ { "effect": "motion", "parameters": {
    "time_s_1": 60, "duration_s_1": 9, "step_1": -30, "mean_1": 2, "fade_s_1": 2, "f_hz_1": 0.8, "width_hz_1": 0.2, "amplitude_1": 100,
    "time_s_2": 60, "duration_s_2": 9, "step_2": 0, "fade_s_2": 2, "f_hz_2": 2.1, "width_hz_2": 0.5, "amplitude_2": 80,
    "time_s_3": 60, "duration_s_3": 9, "step_3": 0, "fade_s_3": 2, "f_hz_3": 30, "width_hz_3": 20, "amplitude_3": 0.1 } } ] } ] }"#;

#[test]
fn a_simulation_of_a_motion_is_as_loud_as_it_was() {
    /// Samples, and the longest averages that are compared: those of what turns many times.
    const SHORT: u64 = 150_001;
    const LONGEST: u64 = 200;
    /// Share that a deviation may be off by: what turned a few times had one energy, told to a tenth of it in half an octave, and where in
    /// that it was counts as the square of the frequency.
    const MOST: f64 = 0.2;
    let model = Model::from_json(TAKEN_UP).expect("a model");
    for seed in 31..34 {
        let [before, after] = diagnosed_and_simulated(&model, SHORT, seed);
        let both = before.allan.iter().zip(&after.allan);
        for (a, b) in both.filter(|(a, _)| a.m <= LONGEST) {
            let off = b.adev / a.adev - 1.0;
            assert!(off.abs() < MOST, "seed {seed}: m = {}, {off:.3}", a.m);
        }
    }
}
