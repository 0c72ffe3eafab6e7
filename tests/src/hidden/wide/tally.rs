//! Tables of the wide draw: the same cases by kind and by what their records are like.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::form::Missing;
use super::scene::mix;
use crate::hidden::case::Case;
use crate::hidden::judge::score::Score;
use crate::hidden::judge::trial::Trial;

/// Edges of the columns of strength.
const STRENGTHS: [f64; 6] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0];

/// What a case's record is like: a heading, and where under it the case stands.
pub fn facts(case: &Case) -> Vec<(&'static str, String)> {
    let scene = &case.scene;
    let edge = STRENGTHS.iter().rev();
    let mut edge = edge.filter(|edge| case.strength.unwrap_or(1.0) >= **edge);
    let octave = scene.samples.ilog2();
    let is_power = scene.samples.is_power_of_two();
    vec![
        (
            "strength from",
            format!("{:>4}", edge.next().unwrap_or(&0.0)),
        ),
        ("length from 2^", format!("{:>2}", octave - octave % 2)),
        (
            "length",
            if is_power { "2^n" } else { "any, or prime" }.to_owned(),
        ),
        ("noise", mix(&scene.axes[scene.target])),
        (
            "chain",
            match (scene.chain.is_none(), scene.declared) {
                (true, _) => "none",
                (_, true) => "declared",
                (_, false) => "undeclared",
            }
            .to_owned(),
        ),
        ("numbers", format!("{:?}", case.form.numbers)),
        (
            "missing",
            match case.form.missing {
                Missing::Nothing => "nothing".to_owned(),
                some => format!("{some:?}"),
            },
        ),
        (
            "rate from",
            format!("{:>4}", 10_u32.pow(scene.rate_hz.log10() as u32)),
        ),
    ]
}

/// Whether a case is right where findings are counted: everything named once with its parameters, nothing
/// else named, nothing left.
pub fn is_right(score: &Score) -> bool {
    score.is_right() && score.held && score.unnamed_is_small
}

/// Rows a kind, then a table for each heading.
pub fn tables(trials: &[Trial]) -> String {
    let redrawn: usize = trials.iter().map(|trial| trial.redrawn).sum();
    let drawn = trials.len() + redrawn;
    let mut text = format!(
        "{redrawn} of {drawn} scenes were drawn again ({:.1} %): not to be seen, or not to be told from a \
         rival, at any strength\n\n",
        100.0 * redrawn as f64 / drawn.max(1) as f64
    );
    let mut headings: BTreeMap<&str, BTreeMap<&str, Vec<&Trial>>> = BTreeMap::new();
    let mut order = vec!["kind"];
    for trial in trials {
        let kind = ("kind", trial.row.as_str());
        let facts = trial
            .facts
            .iter()
            .map(|(heading, at)| (*heading, at.as_str()));
        for (heading, at) in std::iter::once(kind).chain(facts) {
            if !order.contains(&heading) {
                order.push(heading);
            }
            headings
                .entry(heading)
                .or_default()
                .entry(at)
                .or_default()
                .push(trial);
        }
    }
    for heading in order {
        let _ = writeln!(
            text,
            "{heading:<22} cases   right  %    95 %       named   extra  unexpl   worse  held   failed  redrawn"
        );
        for (at, trials) in headings.remove(heading).unwrap_or_default() {
            text.push_str(&row(at, &trials));
        }
        text.push('\n');
    }
    text
}

fn row(at: &str, trials: &[&Trial]) -> String {
    let scores: Vec<&Score> = trials
        .iter()
        .filter_map(|trial| trial.result.as_ref().ok())
        .map(|(score, _)| score)
        .collect();
    let count = |is: &dyn Fn(&Score) -> bool| scores.iter().filter(|score| is(score)).count();
    let right = count(&is_right);
    let (lo, hi) = wilson(right, trials.len());
    format!(
        "{at:<22} {:>5} {right:>7} {:>4.0} {lo:>4.0} to {hi:>3.0} {:>8} {:>7} {:>7} {:>7} {:>5} {:>8} {:>8}\n",
        trials.len(),
        100.0 * right as f64 / trials.len().max(1) as f64,
        count(&|score| score.named.iter().all(|(_, named)| *named)),
        count(&|score| !score.extra.is_empty()),
        count(&|score| score.unexplained > 0),
        count(&|score| score.is_worse),
        count(&|score| score.held),
        trials.len() - scores.len(),
        trials.iter().map(|trial| trial.redrawn).sum::<usize>(),
    )
}

/// 95 % interval of a share, percent (Wilson 1927).
pub fn wilson(part: usize, of: usize) -> (f64, f64) {
    const Z: f64 = 1.96;
    let n = of.max(1) as f64;
    let share = part as f64 / n;
    let centre = share + Z * Z / (2.0 * n);
    let half = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 100.0 / (1.0 + Z * Z / n);
    ((centre - half) * scale, (centre + half) * scale)
}
