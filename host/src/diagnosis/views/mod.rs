//! What a diagnosis looks like: measured, modelled and simulated side by side, axis by axis.
//!
//! Before is the model of five terms alone, after the extended one: the law of its noise and what
//! its deterministic part (lines, steps, settling, outliers) adds in this very record. With both
//! stands one simulated record of the extended model, as `inm simulate` makes it.

pub mod allan;
pub mod amplitudes;
pub mod course;
mod edges;
pub mod growth;
mod passing;
pub mod spectrum;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::options::Options;
use crate::diagnosis::record::in_record::InRecord;
use crate::diagnosis::result::finding::Finding;
use crate::diagnosis::result::views::{
    AllanPoint, Amplitudes, Counts, Course, SpectrumPoint, Views,
};
use crate::fit::likelihood::Fit;
use crate::model::axis::ModelAxis;
use crate::model::whole::{Model, SCHEMA};
use crate::simulate::source::Simulation;
use passing::Passing;

/// Seed of the simulated record.
pub const SEED: u64 = 1;

/// Samples simulated at a time: half a mebibyte.
const BLOCK: usize = 1 << 16;

/// What has to be noted down before anything is taken out of the record.
#[derive(Clone)]
pub struct Before {
    fit: Fit,
    amplitudes: Counts,
}

impl Before {
    /// Of an axis with nothing known and the `fit` of the five terms alone; `None` where no views are wanted.
    pub fn new(axis: &AxisState, fit: &Fit, options: &Options) -> Option<Self> {
        options.views.then(|| Self {
            fit: fit.clone(),
            amplitudes: Counts::new(axis),
        })
    }
}

/// The models that are compared.
#[derive(Clone, Copy)]
pub struct Models<'a> {
    /// The model of the five terms alone.
    pub base: &'a ModelAxis,
    /// The noise of the extended model: five terms and what has a spectrum.
    pub noise: &'a ModelAxis,
    /// All of it, as it is simulated.
    pub whole: &'a ModelAxis,
}

impl Views {
    /// Of an axis that is done and the points of its [Allan deviation](allan), with a simulated record at the
    /// `temperature`, which costs as much as some of the tests. The held-out half is not among them yet.
    pub fn new(
        axis: &AxisState,
        before: Before,
        (models, mut allan): (Models<'_>, Vec<AllanPoint>),
        findings: &[Finding],
        temperature: Option<&[f64]>,
    ) -> Self {
        // One more record's worth of memory at a time.
        let course = Course::new(axis, findings, models.whole.mean);
        let after = Counts::new(axis);
        let passing = Passing::new(axis, findings);
        let own = in_record(axis);
        let (mut spectrum, velocity_error) = rayon::join(
            || spectrum::Pooled::new(axis, &before.fit, &own, &passing),
            || growth::compare(axis, models, &own),
        );
        let amplitudes = Amplitudes {
            before: before.amplitudes,
            after,
        };
        drop(own);
        let simulated = simulate(axis, models.whole, temperature);
        if let Some(simulated) = &simulated {
            allan::add_simulated(&mut allan, simulated, axis.rate_hz);
            spectrum.add_simulated(simulated);
        }
        Self {
            allan,
            held_out: Vec::new(),
            spectrum: spectrum.points,
            velocity_error,
            simulation_seed: simulated.map(|_| SEED),
            course,
            amplitudes,
        }
    }
}

/// The Allan deviation of an axis, measured and as two models expect it in this very record: that of the five terms alone and
/// the noise of the extended one.
pub fn allan(
    axis: &AxisState,
    before_and_after: [&ModelAxis; 2],
    findings: &[Finding],
) -> Vec<AllanPoint> {
    allan::points(
        axis,
        before_and_after,
        &in_record(axis),
        &Passing::new(axis, findings),
    )
}

/// The density of an axis, measured in all of the record and as the five terms alone, fitted as `before`, and the last model
/// expect it.
pub fn densities(axis: &AxisState, before: &Fit, findings: &[Finding]) -> Vec<SpectrumPoint> {
    let (own, passing) = (in_record(axis), Passing::new(axis, findings));
    spectrum::Pooled::new(axis, before, &own, &passing).points
}

/// Adds what a record of `model` comes to, simulated once, to the points of an axis, where data can be made of it.
pub fn add_simulated(
    points: &mut [AllanPoint],
    axis: &AxisState,
    model: &ModelAxis,
    temperature: Option<&[f64]>,
) {
    if let Some(simulated) = simulate(axis, model, temperature) {
        allan::add_simulated(points, &simulated, axis.rate_hz);
    }
}

/// What the model has of this record, as it is simulated.
fn in_record(axis: &AxisState) -> InRecord {
    let mut own = InRecord::of(&axis.residual, axis.residual.waves());
    edges::soften(axis, own.courses_mut());
    own
}

/// A record of `model` as long as that of `axis`, with the same samples missing, about its mean, at
/// the same `temperature`. `None` where the model is none.
fn simulate(axis: &AxisState, model: &ModelAxis, temperature: Option<&[f64]>) -> Option<Vec<f64>> {
    let mean = model.mean;
    let model = Model {
        schema: SCHEMA,
        rate_hz: axis.rate_hz,
        axes: vec![model.clone()],
        correlation: None,
    };
    let length = axis.residual.len();
    let simulation = match temperature {
        Some(column) => Simulation::at_temperature(&model, length as u64, SEED, column.to_vec()),
        None => Simulation::new(&model, length as u64, SEED),
    };
    let mut simulation = simulation.ok()?;
    let mut values = Vec::with_capacity(length);
    while values.len() < length {
        values.append(&mut simulation.next_columns(BLOCK).remove(0));
    }
    for (value, measured) in values.iter_mut().zip(axis.residual.whole()) {
        // Missing where the record misses one.
        *value += 0.0 * measured - mean;
    }
    Some(values)
}
