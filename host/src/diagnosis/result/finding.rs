//! The result of a diagnosis, as `--json` writes it.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use crate::analyse::SourceSummary;
use crate::chain::Chain;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::place::Place;
pub use crate::diagnosis::result::rival::Rival;
use crate::diagnosis::result::suspicion::Suspicion;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::result::verdict::Verdict;
use crate::diagnosis::result::views::Views;
use crate::model::PerCoefficient;
use crate::model::axis::ModelAxis;
use crate::model::kind::Kind;
use crate::model::marks::Mark;
use crate::model::whole::{Model, SCHEMA};
use crate::signal::Unit;

/// Everything that was found out about a record.
#[derive(Debug, Clone, Serialize)]
pub struct Diagnosis {
    /// Version of this structure.
    pub schema: u32,
    /// Where the record comes from, and how long it is.
    pub source: SourceSummary,
    /// Probability at most of any finding or remark where nothing is hidden.
    pub family_level: f64,
    /// One diagnosis an axis, in the order of the record.
    pub axes: Vec<AxisDiagnosis>,
    /// Correlation of the axes' noise, one row each, where they share any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation: Option<Vec<Vec<f64>>>,
}

impl Diagnosis {
    /// The model that the diagnosis ends with, as `inm simulate --model` reads it.
    pub fn model(&self) -> Model {
        Model {
            schema: SCHEMA,
            rate_hz: self.source.rate_hz,
            axes: self
                .axes
                .iter()
                .map(|axis| axis.last.model.clone())
                .collect(),
            correlation: self.correlation.clone(),
        }
    }
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a reference"
)]
const fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// The diagnosis of one axis.
#[derive(Debug, Clone, Serialize)]
pub struct AxisDiagnosis {
    /// Name of the axis.
    pub name: String,
    /// Unit of the signal.
    pub unit: Unit,
    /// Why it could not be diagnosed, beside others that could; all else is empty then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// The signal chain that the spectrum's upper end shows, where none is declared; it is part of the models.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recognised_chain: Option<Chain>,
    /// Missing samples in whose place noise was drawn as the rest of the axis has it.
    #[serde(skip_serializing_if = "is_zero")]
    pub filled_samples: usize,
    /// The five terms alone.
    pub base: Base,
    /// What there is beyond them.
    pub findings: Vec<Finding>,
    /// What no effect of the catalogue explains.
    pub unexplained: Vec<Remark>,
    /// What is in the last model without a name.
    pub unnamed: Option<Unnamed>,
    /// Kinds that were suspected and not found; empty unless some were.
    #[serde(rename = "suspects", skip_serializing_if = "Vec::is_empty")]
    pub suspicions: Vec<Suspicion>,
    /// The model with all findings.
    #[serde(rename = "final")]
    pub last: Final,
    /// Whether one may simulate with it.
    pub verdict: Verdict,
    /// What both models look like next to the record.
    pub views: Views,
}

impl AxisDiagnosis {
    /// Whether something is left unexplained, or without a name where it matters.
    pub fn lacks(&self) -> bool {
        !self.unexplained.is_empty() || self.unnamed.as_ref().is_some_and(Unnamed::matters)
    }
}

/// The five terms alone.
#[derive(Debug, Clone, Serialize)]
pub struct Base {
    /// The model of the five terms alone.
    pub model: ModelAxis,
    /// Where that model fails.
    pub discrepancies: Vec<Remark>,
    /// Error of its Allan deviation on the held-out part, percent.
    pub allan_error_percent: Option<f64>,
    /// What sampling alone makes of that.
    pub allan_error_sampling_percent: Option<f64>,
}

/// Noise that is in a model without a name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unnamed {
    /// Probability of as much in data of the model without it, the search included.
    pub p_value: f64,
    /// Largest change of the model's Allan deviation when it is taken out, percent, at averaging times of
    /// [`LEAST_INTERVALS`](crate::diagnosis::result::verdict::LEAST_INTERVALS) or more.
    pub allan_change_percent: f64,
    /// Its bands, the strongest first.
    pub bands: Vec<UnnamedBand>,
}

impl Unnamed {
    /// Whether it matters to who simulates with the model.
    pub fn matters(&self) -> bool {
        self.allan_change_percent >= MATTERS_PERCENT
    }
}

/// Change of the Allan deviation from which noise without a name matters, percent: a little less than the
/// source's simulation was off by (Pavlov and Petrov: 4 %).
const MATTERS_PERCENT: f64 = 3.0;

/// A band of noise without a name.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct UnnamedBand {
    /// Its middle, hertz.
    pub f_hz: f64,
    /// Its width at half the power, hertz.
    pub width_hz: f64,
    /// Root mean square, unit of the signal.
    pub amplitude: f64,
}

/// A test that fails and has no name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Remark {
    /// Name of the test.
    pub test: String,
    /// Place in frequency, time or amplitude.
    #[serde(flatten)]
    pub place: Place,
    /// Probability of as much in data of the fitted model, the search included.
    pub p_value: f64,
    /// How it looks, in words.
    pub description: String,
}

/// An effect that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Which effect of the catalogue it is.
    pub effect: Kind,
    /// What it is physically, in words.
    pub cause: String,
    /// What to look at on the bench.
    pub check: String,
    /// Parameters of the effect, in the order and the units of the catalogue.
    #[serde(rename = "parameters", serialize_with = "named")]
    pub estimate: Estimate,
    /// Probability of as much in data without it, the search included.
    pub p_value: f64,
    /// Other effects that explain the same, with the logarithm of the odds for this one.
    pub rivals: Vec<Rival>,
    /// What it is worth on data that the fit has not seen.
    pub gain: Gain,
    /// Coefficients as fitted without it, each in its own unit.
    pub without: PerCoefficient<Option<f64>>,
}

/// Writes the parameters by the catalogue's names.
fn named<S: Serializer>(estimate: &Estimate, serializer: S) -> Result<S::Ok, S::Error> {
    estimate.named().serialize(serializer)
}

/// Change of the Allan deviation below which an effect is small, percent: a quarter of what the
/// source's simulation was off by (Pavlov and Petrov: 4 %).
pub const SMALL_PERCENT: f64 = 1.0;

impl Finding {
    /// An effect by itself: nothing is known of its gain yet.
    pub fn new(estimate: &Estimate, p_value: f64) -> Self {
        let kind = estimate.kind;
        Self {
            effect: kind,
            cause: kind.meaning().to_owned(),
            check: kind.check(&estimate.plain()),
            estimate: estimate.clone(),
            p_value,
            rivals: Vec::new(),
            gain: Gain::default(),
            without: PerCoefficient::default(),
        }
    }

    /// What it is, the likeliest first: more than one name where the record does not decide.
    pub fn name(&self) -> String {
        let undecided = self.rivals.iter().filter(|rival| rival.is_undecided());
        let names = std::iter::once(self.effect).chain(undecided.map(|rival| rival.effect));
        let names: Vec<&str> = names.map(|kind| kind.name()).collect();
        names.join(" or ")
    }

    /// Its parameters that are known, by the catalogue's names.
    pub fn parameters(&self) -> BTreeMap<String, Value> {
        self.estimate.named()
    }

    /// Where it shows in pictures.
    pub fn marks(&self) -> Vec<Mark> {
        self.effect.marks(&self.estimate.plain())
    }

    /// Whether it hardly changes the Allan deviation, however sure it is.
    pub fn is_small(&self) -> bool {
        let change = self.gain.allan_change_percent;
        change.is_some_and(|change| change < SMALL_PERCENT)
    }
}

/// What a finding is worth on held-out data.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Gain {
    /// Gain in predictive log-likelihood, nats.
    pub heldout_nats: Option<f64>,
    /// Largest change of the model's Allan deviation when it is taken out, percent: its size, however
    /// sure it is.
    pub allan_change_percent: Option<f64>,
    /// Error of the model's Allan deviation without it, percent.
    pub allan_error_percent_before: Option<f64>,
    /// Error of the model's Allan deviation with it, percent.
    pub allan_error_percent_after: Option<f64>,
}

/// The model with all findings.
#[derive(Debug, Clone, Serialize)]
pub struct Final {
    /// The model, as `inm simulate --model` reads it.
    pub model: ModelAxis,
    /// The five coefficients with their intervals.
    pub coefficients: PerCoefficient<Coefficient>,
    /// Error of its Allan deviation on the held-out part, percent.
    pub allan_error_percent: Option<f64>,
    /// What sampling alone makes of that.
    pub allan_error_sampling_percent: Option<f64>,
}

/// A coefficient of the final model.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Coefficient {
    /// Its value, in its own unit; `None` where it is not resolved from zero.
    pub value: Option<f64>,
    /// Lower end of its 95 % interval.
    pub lo: Option<f64>,
    /// Upper end of its 95 % interval.
    pub hi: Option<f64>,
    /// Whether it is resolved from zero, in a test of 5 %.
    pub identified: bool,
    /// Its 95 % bound; `None` where it is resolved, or not resolved next to what was taken out.
    pub upper: Option<f64>,
}
