//! The published table's open question (docs/studies/hidden-line.md): a line makes the published
//! fit report an inflated Q; the diagnosis names the line and returns Q.

use std::path::Path;

use inm_host::internals::model::Coefficient;
use inm_host::{AnalysisOptions, DiagnosisOptions, Model, analyse, diagnose, simulate};

const SEED: u64 = 1;

const LENGTH: u64 = 1 << 18;

/// Standard deviations that a parameter may be off: one in a million is.
const SIGMAS: f64 = 5.0;

/// Half a 95 % interval in standard deviations.
const HALF_INTERVAL: f64 = 1.96;

#[test]
fn a_line_inflates_the_published_q_and_the_diagnosis_gives_it_back() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/models/hidden-line.json");
    let model = Model::open(path.to_str().expect("a name")).expect("the model of the page");
    let truth = model.axes[0].coefficients.q;
    let simulation = || simulate(&model, LENGTH, SEED, None).expect("a sound model");

    let analysis = analyse(&mut simulation(), &AnalysisOptions::default(), |_| {});
    let analysis = analysis.expect("it does not fail");
    let published = analysis.axes[0].fits.published.as_ref().expect("17 points");
    let inflated = published.q.value.expect("a square above zero");
    assert!(
        inflated > 1.15 * truth,
        "seed {SEED}: the published fit reports {inflated:e}, the truth is {truth:e}"
    );

    let options = DiagnosisOptions {
        views: false,
        ..DiagnosisOptions::default()
    };
    let axes = diagnose(&mut simulation(), options, &|_, _| {})
        .expect("long enough")
        .axes;
    let axis = &axes[0];
    let names: Vec<&str> = axis.findings.iter().map(|one| one.effect.name()).collect();
    assert_eq!(names, ["sinusoid"], "seed {SEED}");
    assert!(
        axis.unexplained.is_empty(),
        "seed {SEED}: {:?}",
        axis.unexplained
    );
    let hidden = &model.axes[0].effects[0];
    for (parameter, truth) in hidden.parameters().iter().zip(hidden.values()) {
        let found = axis.findings[0].parameters()[parameter.name.as_ref()];
        let half = 0.5 * (found.hi.expect("an end") - found.lo.expect("an end"));
        assert!(
            (found.value - truth).abs() < SIGMAS * half / HALF_INTERVAL,
            "seed {SEED}, {}: {found:?}, the truth is {truth}",
            parameter.name
        );
    }
    let q = axis.last.coefficients.get(Coefficient::Q);
    let (value, lo, hi) = (q.value, q.lo.expect("an end"), q.hi.expect("an end"));
    let value = value.expect("resolved from zero");
    assert!(
        (value - truth).abs() < SIGMAS * 0.5 * (hi - lo) / HALF_INTERVAL,
        "seed {SEED}: Q {value:e} ({lo:e} to {hi:e}), the truth is {truth:e}"
    );
}
