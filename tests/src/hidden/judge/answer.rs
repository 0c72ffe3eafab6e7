//! What `inm diagnose --json` says, as far as it is judged (schema 1).

use std::collections::BTreeMap;

use serde::Deserialize;

/// The whole answer.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct Answer {
    /// One for each axis.
    pub axes: Vec<Axis>,
}

/// What is said of one axis.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct Axis {
    /// Effects named.
    pub findings: Vec<Finding>,
    /// What is wrong without a name.
    pub unexplained: Vec<Remark>,
    /// The model after all findings.
    #[serde(rename = "final")]
    pub last: Option<Last>,
    /// What the model holds without a name; none where it needs nothing.
    #[serde(default)]
    pub unnamed: Option<serde_json::Value>,
    /// How good the models are.
    #[serde(default)]
    pub verdict: Verdict,
    /// What the pictures show.
    #[serde(default)]
    pub views: Views,
}

/// How good the models are, at every averaging time that is judged.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct Verdict {
    /// Averaging times of 20 intervals or more.
    pub points: Vec<Judged>,
}

/// How far the models are off at an averaging time.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Judged {
    /// Standard deviation of what was measured, percent.
    pub sampling_percent: f64,
    /// The five terms alone, percent above what was measured.
    pub five_terms_percent: f64,
    /// The last model.
    pub model_percent: f64,
}

/// Curves of the record and of the models, the five terms alone and the last one.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct Views {
    /// Allan deviation, whole record.
    pub allan: Vec<Modelled>,
    /// Allan deviation, the part that is held out.
    pub held_out: Vec<Held>,
}

/// What two models expect at an averaging time.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Modelled {
    /// Averaging time, samples.
    pub m: u64,
    /// Five terms alone.
    pub before: f64,
    /// The last model.
    pub after: f64,
}

/// What was measured there, too.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Held {
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// Measured deviation.
    pub adev: f64,
    /// Degrees of freedom behind it.
    pub edf: f64,
    /// The models.
    #[serde(flatten)]
    pub models: Modelled,
}

/// One effect named.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct Finding {
    /// Its name.
    pub effect: String,
    /// What else it may be.
    #[serde(default)]
    pub rivals: Vec<Rival>,
    /// Its parameters.
    #[serde(default)]
    pub parameters: BTreeMap<String, Interval>,
}

/// What else a finding may be.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct Rival {
    /// Its name.
    pub effect: String,
    /// Logarithm of the odds for the finding against it.
    pub log_odds: f64,
}

/// Odds below which a record leaves open which of two names is right: the 5 % of all intervals.
const DECIDES: f64 = 20.0;

impl Finding {
    /// All names that the record does not decide between, the one that is given first.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let undecided = self.rivals.iter();
        let undecided = undecided.filter(|rival| rival.log_odds < DECIDES.ln());
        std::iter::once(self.effect.as_str()).chain(undecided.map(|one| one.effect.as_str()))
    }
}

/// A value with its 95 % interval. Null where it is not known.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
pub struct Interval {
    /// Best estimate.
    pub value: Option<f64>,
    /// Lower end.
    pub lo: Option<f64>,
    /// Upper end.
    pub hi: Option<f64>,
    /// Upper bound of what cannot be resolved from zero.
    pub upper: Option<f64>,
}

/// Something left unexplained. Kept as it comes: its words are looked through for the place.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(transparent)]
pub struct Remark(pub serde_json::Value);

/// The final model.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct Last {
    /// R, K, B, N, Q.
    #[serde(default)]
    pub coefficients: BTreeMap<String, Interval>,
}

impl Remark {
    /// All its words and numbers, in lower case.
    pub fn text(&self) -> String {
        fn collect(value: &serde_json::Value, into: &mut String) {
            match value {
                serde_json::Value::String(text) => into.push_str(text),
                serde_json::Value::Number(number) => into.push_str(&number.to_string()),
                serde_json::Value::Array(values) => {
                    values.iter().for_each(|value| collect(value, into));
                }
                serde_json::Value::Object(fields) => {
                    for (name, value) in fields {
                        into.push_str(name);
                        into.push(' ');
                        collect(value, into);
                    }
                }
                _ => {}
            }
            into.push_str(" ; ");
        }
        let mut text = String::new();
        collect(&self.0, &mut text);
        text.to_lowercase()
    }
}
