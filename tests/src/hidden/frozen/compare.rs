//! Two answers side by side.
//!
//! On one machine a program that was rebuilt without a change says the same to the last bit. On
//! another the transforms, whose vector units differ, round otherwise, in the record as in the
//! diagnosis. What this moves was measured by a change of every sample by one unit in its last
//! place, at random, three times: the tolerances are three times the most that it made of a number.

use std::fmt;

use serde_json::{Map, Value};

/// Relative difference that rounding may make of what is not fitted.
const ROUNDING: f64 = 1e-9;

/// Difference that a fit may make, in widths of the 95 % interval: it ends where a step is small
/// beside the interval, and where that is depends on the last bits. Measured: up to 8e-6.
const FIT: f64 = 3e-5;

/// Difference of a model's coefficient, as a share of it or of the bound that the record sets,
/// whichever is larger. The five terms alone come without intervals, and where the record hardly
/// tells a coefficient the likelihood is flat. Measured: up to 1.6e-4.
const COEFFICIENT: f64 = 5e-4;

/// Difference of two logarithms of odds that is none, where they are small: no odds are judged to
/// a thousandth. Measured: up to 1.4e-4.
const LOG_ODDS: f64 = 5e-4;

/// Difference of two p-values that is none: some rounding errors of 1, of which a small p-value
/// may be what is left.
const P_VALUE: f64 = 1e-15;

/// What differs.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Where, as in `axes[0].findings[1].p_value`.
    pub path: String,
    /// What it was.
    pub before: String,
    /// What it is now.
    pub now: String,
    /// By how many times what is allowed; infinity where no difference is.
    pub times: f64,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            path,
            before,
            now,
            times,
        } = self;
        write!(f, "{path}: was {before}, is {now}")?;
        if times.is_finite() {
            write!(f, " ({times:.2e} times the tolerance)")?;
        }
        Ok(())
    }
}

/// Every difference between the answers, those within the tolerance as well.
pub fn differences(before: &Value, now: &Value) -> Vec<Difference> {
    let mut found = Vec::new();
    let place = Place {
        path: String::new(),
        axis: None,
        scale: Scale::Relative(ROUNDING),
    };
    place.compare(before, now, &mut found);
    found
}

/// How two numbers are compared.
#[derive(Clone, Copy)]
enum Scale {
    /// To this relative difference.
    Relative(f64),
    /// To [`FIT`] of the number.
    Fitted,
    /// To [`FIT`] of the number, or [`LOG_ODDS`].
    LogOdds,
    /// To [`COEFFICIENT`] of the larger of the number and this.
    Coefficient(f64),
    /// To [`FIT`] of this, or [`ROUNDING`].
    Interval(f64),
    /// By logarithms, for it is these that are added up; to [`FIT`] of the logarithm.
    PValue,
}

impl Scale {
    /// The difference in multiples of what is allowed.
    fn times(self, before: f64, now: f64) -> f64 {
        let (size, difference) = (before.abs().max(now.abs()), (before - now).abs());
        let part = |allowed: f64| match difference == 0.0 {
            true => 0.0,
            false => difference / allowed,
        };
        match self {
            Self::Relative(share) => part(share * size),
            Self::Fitted => part(FIT * size),
            Self::LogOdds => part((FIT * size).max(LOG_ODDS)),
            Self::Coefficient(bound) => part(COEFFICIENT * size.max(bound)),
            Self::Interval(width) => part((FIT * width).max(ROUNDING * size)),
            Self::PValue if difference <= P_VALUE => 0.0,
            Self::PValue => {
                let (before, now) = (before.ln(), now.ln());
                (before - now).abs() / (FIT * before.abs().min(now.abs()).max(1.0))
            }
        }
    }
}

/// A place in the answer.
struct Place<'a> {
    path: String,
    /// The axis that it is in, as it was.
    axis: Option<&'a Value>,
    scale: Scale,
}

impl<'a> Place<'a> {
    fn compare(&self, before: &'a Value, now: &Value, found: &mut Vec<Difference>) {
        match (before, now) {
            (Value::Object(before), Value::Object(now)) => self.fields(before, now, found),
            (Value::Array(before), Value::Array(now)) if before.len() == now.len() => {
                for (i, (one, other)) in before.iter().zip(now).enumerate() {
                    let place = Place {
                        path: format!("{}[{i}]", self.path),
                        axis: match self.path.as_str() {
                            "axes" => Some(one),
                            _ => self.axis,
                        },
                        scale: self.scale,
                    };
                    place.compare(one, other, found);
                }
            }
            (Value::Number(one), Value::Number(other)) => {
                let number = |number: &serde_json::Number| number.as_f64().unwrap_or(f64::NAN);
                let times = self.scale.times(number(one), number(other));
                if times != 0.0 {
                    let times = if times.is_nan() { f64::INFINITY } else { times };
                    found.push(self.difference(before, now, times));
                }
            }
            _ if before == now => {}
            _ => found.push(self.difference(before, now, f64::INFINITY)),
        }
    }

    fn fields(
        &self,
        before: &'a Map<String, Value>,
        now: &Map<String, Value>,
        found: &mut Vec<Difference>,
    ) {
        let absent = Value::Null;
        let mut names: Vec<&String> = before.keys().chain(now.keys()).collect();
        names.sort();
        names.dedup();
        for name in names {
            let path = match self.path.as_str() {
                "" => name.clone(),
                path => format!("{path}.{name}"),
            };
            let place = Place {
                path,
                axis: self.axis,
                scale: self.scale_of(name, before),
            };
            match (before.get(name), now.get(name)) {
                (Some(before), Some(now)) => place.compare(before, now, found),
                (before, now) => {
                    let say = |value: Option<&Value>| value.unwrap_or(&absent).clone();
                    found.push(place.difference(&say(before), &say(now), f64::INFINITY));
                }
            }
        }
    }

    /// How the numbers in a field of this object are compared.
    fn scale_of(&self, name: &str, object: &Map<String, Value>) -> Scale {
        match name {
            "source" | "mean" => Scale::Relative(ROUNDING),
            "axes" => Scale::Fitted,
            "p_value" => Scale::PValue,
            // The letters of the coefficients: what is not resolved from zero is known to its bound.
            "R" | "K" | "B" | "N" | "Q" => {
                let coefficient = self.axis.map(|axis| &axis["final"]["coefficients"][name]);
                let width = coefficient.and_then(Value::as_object).and_then(width);
                Scale::Coefficient(width.unwrap_or(0.0))
            }
            "heldout_nats" | "log_odds" => Scale::LogOdds,
            "value" | "lo" | "hi" | "upper" => width(object).map_or(self.scale, Scale::Interval),
            _ => self.scale,
        }
    }

    fn difference(&self, before: &Value, now: &Value, times: f64) -> Difference {
        Difference {
            path: self.path.clone(),
            before: before.to_string(),
            now: now.to_string(),
            times,
        }
    }
}

/// Width of the interval in `lo` and `hi`; where one is not known, the bound in `upper`.
fn width(object: &Map<String, Value>) -> Option<f64> {
    let number = |name: &str| object.get(name).and_then(Value::as_f64);
    match (number("lo"), number("hi"), number("upper")) {
        (Some(lo), Some(hi), _) => Some(hi - lo),
        (_, _, upper) => upper,
    }
}
