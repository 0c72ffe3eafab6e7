//! The table of how far the models' Allan deviations are off, by averaging time and by kind.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::allan::ModelError;
use super::trial::Trial;

/// What the mean over records may be off by beside its standard error, percent.
pub const ALLOWED_PERCENT: f64 = 1.0;

/// Mean of some errors, percent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// Errors.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Standard error of the mean; infinite for less than two errors.
    pub error: f64,
    /// Mean of their sizes.
    pub size: f64,
}

impl Mean {
    /// Of these; none of none.
    pub fn of(errors: &[f64]) -> Option<Self> {
        let count = errors.len();
        let of = |values: &dyn Fn(f64) -> f64| {
            errors.iter().map(|&one| values(one)).sum::<f64>() / count as f64
        };
        let mean = of(&|one| one);
        let variance = of(&|one| (one - mean).powi(2)) / (count as f64 - 1.0);
        (count > 0).then(|| Self {
            count,
            mean,
            error: if count > 1 {
                variance.sqrt()
            } else {
                f64::INFINITY
            },
            size: of(&f64::abs),
        })
    }

    /// By how much it is further off than allowed beside its standard error; negative within.
    pub fn beyond(&self) -> f64 {
        self.mean.abs() - ALLOWED_PERCENT - self.error
    }
}

/// A column of the errors.
type Column = fn(&ModelError) -> Option<f64>;

const TRUTH_BEFORE: Column = |one| one.truth.map(|sides| sides.before);
const TRUTH_AFTER: Column = |one| one.truth.map(|sides| sides.after);
const HELD_BEFORE: Column = |one| Some(one.held_out.before);
const HELD_AFTER: Column = |one| Some(one.held_out.after);

/// Errors by averaging time in samples.
type ByTime<'a> = BTreeMap<u64, Vec<&'a ModelError>>;

fn by_time<'a>(trials: impl Iterator<Item = &'a Trial>) -> ByTime<'a> {
    let mut all = ByTime::new();
    for (score, _) in trials.filter_map(|trial| trial.result.as_ref().ok()) {
        for one in &score.allan {
            all.entry(one.m).or_default().push(one);
        }
    }
    all
}

fn mean(errors: &[&ModelError], column: Column) -> Option<Mean> {
    let values: Vec<f64> = errors.iter().filter_map(|one| column(one)).collect();
    Mean::of(&values)
}

/// Mean of a column at the averaging time where it is furthest off.
fn worst(all: &ByTime<'_>, column: Column) -> Option<(u64, Mean)> {
    all.iter()
        .filter_map(|(&m, errors)| Some((m, mean(errors, column)?)))
        .filter(|(_, mean)| mean.count > 1)
        .max_by(|(_, a), (_, b)| a.beyond().total_cmp(&b.beyond()))
}

/// Errors of the models' Allan deviations, of records in which everything was named and nothing else:
/// a row an averaging time, then a row a kind at its worst one.
pub fn table(trials: &[Trial]) -> String {
    let all = by_time(trials.iter());
    let (truth, held) = (worst(&all, TRUTH_AFTER), worst(&all, HELD_AFTER));
    let mut text = format!(
        "Allan deviation of the models, mean error +- its standard error, percent\n\
         {:<12}{:^38}{:^30}\n{:<12}{HEADER}{:>6}{HEADER}\n",
        "", "over the truth", "over the held-out part", "tau s", "size"
    );
    for (&m, errors) in &all {
        let over_truth = Row::new(errors, TRUTH_BEFORE, TRUTH_AFTER);
        let over_held = Row::new(errors, HELD_BEFORE, HELD_AFTER);
        let marks = [
            (&over_truth, truth, "truth"),
            (&over_held, held, "held-out part"),
        ];
        let marks = marks.map(|(row, worst, name)| {
            let is_worst = worst.is_some_and(|(at, _)| at == m);
            let worst = if is_worst {
                format!("  worst over the {name}")
            } else {
                String::new()
            };
            format!("{}{worst}", row.mark())
        });
        let tau_s = errors[0].tau_s;
        let size = over_truth.size();
        let _ = writeln!(
            text,
            "{tau_s:<12.4}{over_truth}{size}{over_held}{}",
            marks.concat()
        );
    }
    let _ = writeln!(
        text,
        "\nover the truth, each kind at its worst averaging time"
    );
    let _ = writeln!(text, "{:<24}{:<12}{HEADER}{:>6}", "row", "tau s", "size");
    for row in rows(trials) {
        let own = by_time(trials.iter().filter(|trial| trial.row == row));
        let Some((m, _)) = worst(&own, TRUTH_AFTER) else {
            let _ = writeln!(text, "{row:<24}-");
            continue;
        };
        let errors = &own[&m];
        let (tau_s, means) = (errors[0].tau_s, Row::new(errors, TRUTH_BEFORE, TRUTH_AFTER));
        let (size, mark) = (means.size(), means.mark());
        let _ = writeln!(text, "{row:<24}{tau_s:<12.4}{means}{size}{mark}");
    }
    text
}

/// Names of the columns of a [`Row`].
const HEADER: &str = "  cases   before    after     +-";

/// Before and after beside one another.
struct Row(Option<(Mean, Mean)>);

impl Row {
    fn new(errors: &[&ModelError], before: Column, after: Column) -> Self {
        Self(mean(errors, before).zip(mean(errors, after)))
    }

    fn size(&self) -> String {
        let size = self.0.map(|(_, after)| format!("{:.2}", after.size));
        format!("{:>6}", size.as_deref().unwrap_or("-"))
    }

    fn mark(&self) -> &'static str {
        let beyond = self.0.is_some_and(|(_, after)| after.beyond() > 0.0);
        if beyond { "  beyond 1 %" } else { "" }
    }
}

impl std::fmt::Display for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Some((before, after)) = self.0 else {
            return write!(f, "{:>7} {:>8} {:>8} {:>6}", 0, "-", "-", "-");
        };
        let (before, count, mean) = (before.mean, after.count, after.mean);
        write!(f, "{count:>7} {before:>8.2} {mean:>8.2} ")?;
        if after.error.is_finite() {
            write!(f, "{:>6.2}", after.error)
        } else {
            write!(f, "{:>6}", "-")
        }
    }
}

fn rows(trials: &[Trial]) -> Vec<&str> {
    let mut rows: Vec<&str> = trials.iter().map(|trial| trial.row.as_str()).collect();
    rows.dedup();
    rows
}
