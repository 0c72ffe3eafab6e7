//! What is said of a disturbance against what happened.

use super::record::Record;
use super::table::TOLERANCE_S;
use crate::hidden::judge::answer::{Answer, Finding};

/// What an answer is worth.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Score {
    /// Whether the axis that shows it most has one of the accepted names.
    pub named: bool,
    /// Whether all that is said of its time is right.
    pub timed: bool,
    /// Names that are not accepted.
    pub extra: Vec<String>,
    /// Names that were given in that axis.
    pub given: Vec<String>,
    /// Remarks about something unexplained.
    pub unexplained: usize,
}

impl Score {
    /// Right kind, right time, nothing else named.
    pub fn is_right(&self) -> bool {
        self.named && self.timed && self.extra.is_empty()
    }
}

/// Compares.
pub fn score(record: &Record, answer: &Answer) -> Score {
    let everyday = record.everyday;
    let is_accepted = |finding: &&Finding| everyday.names.contains(&finding.effect.as_str());
    let plainest = answer.axes.get(record.plainest);
    let there: Vec<&Finding> = plainest.iter().flat_map(|axis| &axis.findings).collect();
    let all = || answer.axes.iter().flat_map(|axis| &axis.findings);
    let mut extra: Vec<String> = all()
        .filter(|one| !is_accepted(one) && !everyday.beside.contains(&one.effect.as_str()))
        .map(|one| one.effect.clone())
        .collect();
    extra.sort();
    let mut given: Vec<String> = there.iter().map(|one| one.effect.clone()).collect();
    given.sort();
    given.dedup();
    Score {
        named: there.iter().any(is_accepted),
        timed: record.event_s.is_none_or(|event_s| {
            let mut spans = there
                .iter()
                .copied()
                .filter(|one| is_accepted(one))
                .flat_map(spans);
            let any = there
                .iter()
                .copied()
                .any(|one| is_accepted(&one) && !spans_of(one).is_empty());
            any && spans.all(|span_s| is_near(span_s, event_s))
        }),
        extra,
        given,
        unexplained: answer.axes.iter().map(|axis| axis.unexplained.len()).sum(),
    }
}

fn spans(finding: &Finding) -> impl Iterator<Item = (f64, f64)> {
    spans_of(finding).into_iter()
}

/// From when to when a finding says that something was: `from_s` to `to_s`, or moments, numbered or not.
fn spans_of(finding: &Finding) -> Vec<(f64, f64)> {
    let value = |name: &str| finding.parameters.get(name).and_then(|one| one.value);
    let mut spans = Vec::new();
    for (name, one) in &finding.parameters {
        let Some(value_s) = one.value else { continue };
        if let Some(number) = name.strip_prefix("from_s") {
            let to_s = value(&format!("to_s{number}")).unwrap_or(value_s);
            spans.push((value_s, to_s));
        } else if name.starts_with("time_s") {
            spans.push((value_s, value_s));
        }
    }
    spans
}

/// Within the event, but for the longer of [`TOLERANCE_S`] and its own length.
fn is_near((from_s, to_s): (f64, f64), (begun_s, over_s): (f64, f64)) -> bool {
    let slack_s = TOLERANCE_S.max(over_s - begun_s);
    from_s >= begun_s - slack_s && to_s <= over_s + slack_s
}
