//! From a simulation to a fit to a simulation: what comes out looks like what went in.

use inm_host::internals::analyse::{Analysis, AnalysisOptions, AxisAnalysis, analyse};
use inm_host::internals::model::PerCoefficient;
use inm_host::internals::model::published::PublishedAxis;
use inm_host::internals::model::whole::Model;
use inm_host::internals::simulate::source::Simulation;

const SEED: u64 = 11;

/// 2^20 samples at 2000/s.
const LENGTH: u64 = 1 << 20;

/// Standard deviations that a point may be off: of some 400 points one in 4000 tests is.
const SIGMAS: f64 = 5.0;

fn analysed(model: &Model, seed: u64) -> Analysis {
    let mut simulation = Simulation::new(model, LENGTH, seed).expect("a sound model");
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
        let record = analysed(&model, SEED);
        let fit = record.axes[0].fits.likelihood.as_ref().expect("a fit");
        let squares = fit.squares();
        model.axes[0].coefficients = PerCoefficient::from_fn(|one| squares.get(one).sqrt());
        let again = analysed(&model, SEED + 1);
        compare(&record.axes[0], &again.axes[0]);
    }
}

#[test]
fn another_model_does_not() {
    let record = analysed(&Model::published(Some(PublishedAxis::X)), SEED);
    let other = analysed(&Model::published(Some(PublishedAxis::Y)), SEED);
    let different = std::panic::catch_unwind(|| compare(&record.axes[0], &other.axes[0]));
    assert!(different.is_err(), "X and Y were taken for one another");
}
