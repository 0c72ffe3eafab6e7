//! The models of an axis before and after, held against its record.

use crate::diagnosis::axis::{AxisState, ramp};
use crate::diagnosis::describe::effects::{finding, law_effects};
use crate::diagnosis::explain::{Bare, slope};
use crate::diagnosis::explanation::{Explanation, Snapshot};
use crate::diagnosis::held_out;
use crate::diagnosis::held_out::allan::HeldCurve;
use crate::diagnosis::held_out::size::Sizes;
use crate::diagnosis::result::finding::{Finding, Gain};
use crate::diagnosis::result::views::AllanPoint;
use crate::diagnosis::views;
use crate::fit::likelihood::Fit;
use crate::fit::likelihood::ramp::Ramp;
use crate::model::PerCoefficient;
use crate::model::axis::ModelAxis;
use crate::model::kind::Kind;
use crate::model::{drift, steps, telegraph, thermal, warmup};
use crate::signal::Axis;

/// An axis with its models.
pub(super) struct JudgedAxis {
    /// The five terms alone.
    pub base: Judged,
    /// The noise of the last model.
    pub noise: Judged,
    /// What was accepted.
    pub findings: Vec<Finding>,
    /// Its Allan deviation, measured and as both models expect it.
    pub allan: Vec<AllanPoint>,
}

impl JudgedAxis {
    /// Of an axis with `bare`, what was noted before anything was explained, the slope of what is left, and
    /// the gains of its explanations on held-out data.
    pub fn new(
        judge: &Judge<'_>,
        bare: &Bare,
        ramp: Option<Ramp>,
        held_out_nats: &[Option<f64>],
    ) -> Self {
        let axis = judge.axis;
        let base = judge.judged(&Snapshot::default(), &bare.fit, bare.slope);
        let noise = judge.judged(&explained_now(axis), &axis.fit, slope(ramp));
        let findings = judge.findings(held_out_nats, &noise.model);
        let allan = views::allan(axis, [&base.model, &noise.model], &findings);
        Self {
            base,
            noise,
            findings,
            allan,
        }
    }
}

/// All that explains an axis; what has no name is a law too.
fn explained_now(axis: &AxisState) -> Snapshot {
    let mut now = Snapshot::of(axis.explanations());
    now.laws.clone_from(&axis.laws);
    now
}

/// The slope of what is left, unless effects were taken out that go with one: then what is left tells little of it.
pub(super) fn last_ramp(axis: &AxisState) -> Option<Ramp> {
    if takes_slope(axis.explanations()) {
        None
    } else {
        ramp::ramp(axis)
    }
}

/// Whether effects were taken out that go with a slope, so that what is left says little of it.
fn takes_slope(explanations: &[Explanation]) -> bool {
    const SLOW: [Kind; 5] = [
        steps::KIND,
        warmup::KIND,
        drift::KIND,
        thermal::KIND,
        telegraph::KIND,
    ];
    let mut courses = explanations.iter().filter(|one| one.law().is_none());
    courses.any(|one| SLOW.contains(&one.kind()))
}

/// Holds models against the half of the record that they were not fitted to.
pub(super) struct Judge<'a> {
    /// What is measured.
    pub signal: &'a Axis,
    /// With all that is known of it.
    pub axis: &'a AxisState,
    /// Mean of the record, in the unit of the signal.
    pub mean: f64,
    /// The Allan deviation of the half that no model was fitted to.
    pub held: &'a HeldCurve,
}

/// A model, and how far off its Allan deviation is.
pub(super) struct Judged {
    /// The model.
    pub model: ModelAxis,
    /// Its variances at the points of the held-out half.
    pub expected: Vec<f64>,
    /// Root mean square error of its deviations, percent.
    pub error_percent: Option<f64>,
    /// What sampling alone makes of that.
    pub sampling_percent: Option<f64>,
}

impl Judge<'_> {
    /// The model of a snapshot and its fit, with the ramp `r`.
    fn judged(&self, snapshot: &Snapshot, fit: &Fit, r: f64) -> Judged {
        let model = ModelAxis {
            name: self.signal.name.clone(),
            unit: self.signal.unit,
            mean: self.mean,
            chain: self.axis.chain.clone(),
            coefficients: PerCoefficient {
                r,
                ..held_out::coefficients(&fit.squared)
            },
            effects: law_effects(&self.axis.bins, snapshot, fit),
        };
        let expected = self.held.expected(self.axis, &model, snapshot);
        let error = self.held.error_percent(&expected);
        Judged {
            model,
            expected,
            error_percent: error.map(|(error, _)| error),
            sampling_percent: error.map(|(_, sampling)| sampling),
        }
    }

    /// What was accepted, with its gains; `last` is the noise of the last model.
    fn findings(&self, nats: &[Option<f64>], last: &ModelAxis) -> Vec<Finding> {
        let explanations = self.axis.explanations();
        let now = Snapshot::of(explanations);
        let sizes = Sizes::new(self.axis, last, &now);
        let error_percent = |snapshot: &Snapshot, fit: &Fit| {
            let judged = self.judged(snapshot, fit, last.coefficients.r);
            judged.error_percent
        };
        let reported = |(one, nats): (&Explanation, &Option<f64>)| {
            let gain = Gain {
                heldout_nats: *nats,
                allan_change_percent: sizes.change_percent(one),
                allan_error_percent_before: error_percent(&one.without, &one.before),
                allan_error_percent_after: error_percent(&one.with, &one.after),
            };
            finding(self.axis, one, gain)
        };
        explanations.iter().zip(nats).map(reported).collect()
    }
}
