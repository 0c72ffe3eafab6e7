//! One answer against one truth.

use super::allan::{self, ModelError};
use super::answer::{Answer, Axis, Finding, Interval, Remark};
use super::place;
use crate::hidden::case::Case;
use crate::hidden::truth::Truth;
use crate::hidden::wide::counted;

/// What an answer is worth.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Score {
    /// Of each truth, whether it was named.
    pub named: Vec<(&'static str, bool)>,
    /// Effects named that are not there.
    pub extra: Vec<String>,
    /// Remarks about something unexplained.
    pub unexplained: usize,
    /// Parameters of what was named.
    pub parameters: Vec<Parameter>,
    /// Base coefficients of the target after extension.
    pub coefficients: Vec<Parameter>,
    /// Whether a remark points to the right place, of what has no name.
    pub placed: Option<bool>,
    /// Whether all that is named is there once, with the right parameters.
    pub held: bool,
    /// Whether what has no name changes the Allan deviation of no axis by more than 1 %.
    pub unnamed_is_small: bool,
    /// Whether the last model is worse than the five terms somewhere, by more than 1 % and what sampling leaves open.
    pub is_worse: bool,
    /// Errors of the models' Allan deviations in the target, where everything is named and nothing
    /// else.
    pub allan: Vec<ModelError>,
}

/// One parameter beside its truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// `effect.name`.
    pub name: String,
    /// Whether the 95 % interval holds the truth; none where no interval is given.
    pub inside: Option<bool>,
    /// Error in units of the interval's deviation (its width over 3.92).
    pub deviations: Option<f64>,
}

impl Score {
    /// Everything named, nothing else said.
    pub fn is_right(&self) -> bool {
        self.is_named() && self.extra.is_empty() && self.unexplained == 0
    }

    /// Everything named, nothing else named; remarks are allowed.
    pub fn is_named(&self) -> bool {
        self.named.iter().all(|(_, named)| *named) && self.extra.is_empty()
    }
}

/// Compares. Effects in another axis than the target are extra, except those of all axes.
pub fn score(case: &Case, answer: &Answer) -> Score {
    let mut score = Score {
        held: true,
        unnamed_is_small: answer.axes.iter().all(counted::is_small),
        is_worse: answer.axes.iter().any(is_worse),
        ..Score::default()
    };
    let mut left: Vec<(usize, &Finding)> = answer
        .axes
        .iter()
        .enumerate()
        .flat_map(|(axis, said)| said.findings.iter().map(move |finding| (axis, finding)))
        .collect();
    // What has no name cannot be named.
    let truths: &[Truth] = if case.place.is_some() {
        &[]
    } else {
        &case.truths
    };
    for truth in truths {
        let found = take(truth, case.scene.target, &mut left);
        score.named.push((truth.effect, !found.is_empty()));
        score.held &= counted::is_held(truth, &found, &case.scene);
        if !found.is_empty() {
            score.parameters.extend(compare(truth, &found));
        }
    }
    left.retain(|(_, finding)| !counted::is_of_the_form(finding, case));
    counted::take_chain(&mut left, case, answer.axes.len());
    score.extra = left.iter().map(|(_, f)| f.effect.clone()).collect();
    let remarks: Vec<&Remark> = answer.axes.iter().flat_map(|a| &a.unexplained).collect();
    score.unexplained = remarks.len();
    score.placed = case.place.map(|place| place::is_right(&remarks, place));
    // With a wrong rate the coefficients are wrong by powers of the ratio, whoever fits them.
    let rate_is_right = truths.iter().all(|truth| truth.effect != "timebase");
    if let Some(axis) = answer.axes.get(case.scene.target).filter(|_| rate_is_right) {
        score.coefficients = coefficients(case, axis);
    }
    if let Some(axis) = answer
        .axes
        .get(case.scene.target)
        .filter(|_| score.is_right())
    {
        score.allan = allan::errors(case, &axis.views);
    }
    score
}

/// Whether the last model of an axis is worse than the five terms.
fn is_worse(axis: &Axis) -> bool {
    axis.verdict.points.iter().any(|point| {
        let allowed = 1.0 + point.sampling_percent;
        point.model_percent.abs() > point.five_terms_percent.abs() + allowed
    })
}

/// Takes the findings that answer a truth: the nearest in frequency of its name in the target,
/// or all of its name for an effect of all axes.
fn take<'a>(
    truth: &Truth,
    target: usize,
    left: &mut Vec<(usize, &'a Finding)>,
) -> Vec<(usize, &'a Finding)> {
    if truth.effect == "common_mode" {
        let (found, others) = left.iter().partition(|(_, f)| f.effect == truth.effect);
        *left = others;
        return found;
    }
    let distance = |finding: &Finding| {
        let said = finding.parameters.get("f_hz").and_then(|p| p.value);
        let off = said.zip(truth.parameter("f_hz"));
        off.map_or(0.0, |(said, true_hz)| (said / true_hz).ln().abs())
    };
    let nearest = left
        .iter()
        .enumerate()
        .filter(|(_, (axis, f))| *axis == target && f.effect == truth.effect)
        // A line elsewhere is another line.
        .filter(|(_, (_, f))| distance(f) < 0.02 || truth.effect != "sinusoid")
        .min_by(|(_, (_, a)), (_, (_, b))| distance(a).total_cmp(&distance(b)))
        .map(|(index, _)| index);
    nearest
        .map(|index| left.remove(index))
        .into_iter()
        .collect()
}

/// A truth's parameters in the findings that answer it; `gain_2` is the gain said of the second
/// axis.
fn compare(truth: &Truth, found: &[(usize, &Finding)]) -> Vec<Parameter> {
    truth
        .parameters
        .iter()
        .map(|(name, value)| {
            let of_axis: Option<usize> = name.strip_prefix("gain_").and_then(|n| n.parse().ok());
            let said = match of_axis {
                Some(number) => found
                    .iter()
                    .find(|(axis, _)| axis + 1 == number)
                    .and_then(|(_, finding)| finding.parameters.get("gain")),
                None => found[0].1.parameters.get(name.as_str()),
            };
            parameter(format!("{}.{name}", truth.effect), *value, said)
        })
        .collect()
}

fn coefficients(case: &Case, axis: &Axis) -> Vec<Parameter> {
    let base = &case.scene.axes[case.scene.target];
    // Named, or behind a filter, rounding has its own floor.
    let apart = ["quantisation", "rolloff", "averaging"];
    let mut findings = axis.findings.iter();
    let is_named = findings.any(|one| apart.contains(&one.effect.as_str()));
    let rounding = if is_named { 0.0 } else { case.rounding_n() };
    let truths = [
        ("R", base.r.abs()),
        ("K", base.k),
        ("B", base.b),
        ("N", (base.n * case.swell().sqrt()).hypot(rounding)),
        ("Q", base.q * case.swell().sqrt()),
    ];
    let Some(last) = &axis.last else {
        return Vec::new();
    };
    truths
        .iter()
        .map(|(symbol, value)| {
            let name = format!("final.{symbol}");
            parameter(name, *value, last.coefficients.get(*symbol))
        })
        .collect()
}

fn parameter(name: String, truth: f64, said: Option<&Interval>) -> Parameter {
    let mut parameter = Parameter {
        name,
        inside: None,
        deviations: None,
    };
    let Some(said) = said else {
        return parameter;
    };
    if let (Some(lo), Some(hi)) = (said.lo, said.hi) {
        parameter.inside = Some((lo..=hi).contains(&truth));
        parameter.deviations = said.value.map(|value| (value - truth) * 3.92 / (hi - lo));
    } else if let Some(upper) = said.upper {
        parameter.inside = Some(truth <= upper);
    }
    parameter
}
