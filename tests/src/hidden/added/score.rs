//! What is said of a stretch with an effect in it, beside what is said of the bare stretch.

use super::case::Case;
use super::stretch::Stretch;
use crate::hidden::judge::answer::{Answer, Finding};
use crate::hidden::wide::counted;

/// What an answer is worth.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Score {
    /// Whether the effect was named.
    pub named: bool,
    /// Whether it was, or is one of some names that the record does not decide between.
    pub among: bool,
    /// Whether the effect was named, with parameters within their bounds.
    pub held: bool,
    /// Names that neither the effect nor the bare stretch has.
    pub extra: Vec<String>,
    /// Those of them that are none of the bare stretch's, or the effect's, by any name that the record does not decide between.
    pub new: Vec<String>,
    /// Names of the bare stretch that are gone.
    pub gone: Vec<String>,
    /// All names.
    pub given: Vec<String>,
}

impl Score {
    /// Named, and nothing that was not there before.
    pub fn is_right(&self) -> bool {
        self.named && self.extra.is_empty()
    }
}

/// Names of the findings in an answer.
pub fn names(answer: &Answer) -> Vec<String> {
    let findings = answer.axes.iter().flat_map(|axis| &axis.findings);
    findings.map(|finding| finding.effect.clone()).collect()
}

/// Compares with the answer to the `bare` stretch.
pub fn score(case: &Case, stretch: &Stretch, bare: &Answer, answer: &Answer) -> Score {
    let of_bare = || bare.axes.iter().flat_map(|axis| &axis.findings);
    let bare = names(bare);
    let findings = || answer.axes.iter().flat_map(|axis| &axis.findings);
    let of = |name: &str| -> Vec<(usize, &Finding)> {
        let found = findings().find(|finding| finding.effect == name);
        found.map(|finding| (0, finding)).into_iter().collect()
    };
    let given = names(answer);
    let is_hidden = |name: &str| case.truths.iter().any(|truth| truth.effect == name);
    let is_held = |name: &str| {
        let truth = case.truths.iter().find(|truth| truth.effect == name);
        truth.is_none_or(|truth| counted::is_held(truth, &of(name), &stretch.scene))
    };
    let extra = given
        .iter()
        .filter(|name| !bare.contains(name) && !is_hidden(name));
    let is_new = |one: &&Finding| {
        let is_known = |name: &str| {
            let mut of_bare = of_bare().flat_map(Finding::names);
            is_hidden(name) || of_bare.any(|other| other == name)
        };
        !one.names().any(is_known)
    };
    let new = findings().filter(is_new).map(|one| one.effect.clone());
    let gone = bare.iter().filter(|name| !given.contains(name));
    Score {
        named: given.iter().any(|name| name == case.kind.name),
        among: findings().any(|one| one.names().any(|name| name == case.kind.name)),
        new: new.collect(),
        held: is_held(case.kind.name),
        extra: extra.cloned().collect(),
        gone: gone.cloned().collect(),
        given,
    }
}
