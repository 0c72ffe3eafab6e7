//! The tables of a study of added effects.

use std::fmt::Write as _;

use super::score::Score;
use crate::hidden::judge::program::Failure;
use crate::hidden::wide::tally::wilson;

/// Edges of the columns of strength.
const STRENGTHS: [f64; 4] = [2.0, 5.0, 15.0, 40.0];

/// What came of one effect in one stretch.
#[derive(Debug)]
pub struct Trial {
    /// The kind, or `bare` where the program failed on the stretch itself.
    pub kind: &'static str,
    /// The record that the stretch is of.
    pub record: String,
    /// Multiples of strength 1.
    pub strength: f64,
    /// The score, or why there is none.
    pub result: Result<Score, Failure>,
}

/// Rows by kind, record and strength.
pub fn tables(trials: &[Trial]) -> String {
    let by_strength = |trial: &Trial| {
        let below = STRENGTHS.iter().rev().find(|edge| trial.strength >= **edge);
        format!("from {:>3}", below.unwrap_or(&STRENGTHS[0]))
    };
    let mut text = table("kind", trials, &|trial| trial.kind.to_owned());
    text.push_str(&table("record", trials, &|trial| trial.record.clone()));
    text.push_str(&table("strength", trials, &by_strength));
    text
}

fn table(heading: &str, trials: &[Trial], of: &dyn Fn(&Trial) -> String) -> String {
    let mut text = format!(
        "{heading:<16} cases   named  %    95 %       among    held   extra     new    gone  failed\n"
    );
    let mut rows: Vec<String> = trials.iter().map(of).collect();
    rows.sort();
    rows.dedup();
    for name in rows {
        let of_row: Vec<&Trial> = trials.iter().filter(|trial| of(trial) == name).collect();
        text.push_str(&row(&name, &of_row));
    }
    text.push_str(&row("all", &trials.iter().collect::<Vec<_>>()));
    text.push('\n');
    text
}

fn row(name: &str, trials: &[&Trial]) -> String {
    let scores = trials.iter().filter_map(|trial| trial.result.as_ref().ok());
    let scores: Vec<&Score> = scores.collect();
    let count = |is: &dyn Fn(&Score) -> bool| scores.iter().filter(|score| is(score)).count();
    let named = count(&|score| score.named);
    let (lo, hi) = wilson(named, trials.len());
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{name:<16} {:>5} {named:>7} {:>4.0} {lo:>4.0} to {hi:>3.0} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7}",
        trials.len(),
        100.0 * named as f64 / trials.len().max(1) as f64,
        count(&|score| score.among),
        count(&|score| score.named && score.held),
        count(&|score| !score.extra.is_empty()),
        count(&|score| !score.new.is_empty()),
        count(&|score| !score.gone.is_empty()),
        trials.len() - scores.len(),
    );
    text
}
