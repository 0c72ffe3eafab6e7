//! The table of a study of everyday disturbances.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::score::Score;
use crate::hidden::judge::program::Failure;
use crate::hidden::wide::tally::wilson;

/// What came of one record: what is in it, its seed, and the score.
pub type Trial = (&'static str, u64, Result<Score, Failure>);

/// A row a disturbance; then what was named instead.
pub fn table(trials: &[Trial]) -> String {
    let mut rows: Vec<(&str, Vec<&Trial>)> = Vec::new();
    for trial in trials {
        match rows.iter_mut().find(|(name, _)| *name == trial.0) {
            Some((_, of_row)) => of_row.push(trial),
            None => rows.push((trial.0, vec![trial])),
        }
    }
    let mut text = String::from(
        "disturbance     cases   right  %    95 %       kind    time   extra  unexpl  failed\n",
    );
    for (name, trials) in &rows {
        text.push_str(&row(name, trials));
    }
    text.push_str(&row("all", &trials.iter().collect::<Vec<_>>()));
    text.push_str("\ngiven in the axis that shows it most (- nothing):\n");
    for (name, trials) in &rows {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for score in trials
            .iter()
            .filter_map(|(_, _, score)| score.as_ref().ok())
        {
            let given = match score.given.is_empty() {
                true => "-".to_owned(),
                false => score.given.join("+"),
            };
            *counts.entry(given).or_default() += 1;
        }
        let mut counts: Vec<_> = counts.into_iter().collect();
        counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let counts: Vec<String> = counts.iter().map(|(n, c)| format!("{n} {c}")).collect();
        let _ = writeln!(text, "  {name:<13} {}", counts.join(", "));
    }
    text
}

fn row(name: &str, trials: &[&Trial]) -> String {
    let scores = trials
        .iter()
        .filter_map(|(_, _, score)| score.as_ref().ok());
    let scores: Vec<&Score> = scores.collect();
    let count = |is: &dyn Fn(&Score) -> bool| scores.iter().filter(|score| is(score)).count();
    let right = count(&Score::is_right);
    let (lo, hi) = wilson(right, trials.len());
    format!(
        "{name:<14} {:>6} {right:>7} {:>4.0} {lo:>4.0} to {hi:>3.0} {:>7} {:>7} {:>7} {:>7} {:>7}\n",
        trials.len(),
        100.0 * right as f64 / trials.len().max(1) as f64,
        count(&|score| score.named),
        count(&|score| score.timed),
        count(&|score| !score.extra.is_empty()),
        count(&|score| score.unexplained > 0),
        trials.len() - scores.len(),
    )
}
