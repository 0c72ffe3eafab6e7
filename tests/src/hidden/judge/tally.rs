//! The tables of a study.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::trial::Trial;

/// Named right, named beside, and how long it took, a row a kind; then what was named instead.
pub fn confusion(trials: &[Trial]) -> String {
    let mut text = String::from(
        "row                      cases   right   named   extra  unexpl   worse  placed  failed  median s\n",
    );
    let rows = rows(trials);
    for (row, trials) in &rows {
        text.push_str(&summary(row, trials));
    }
    let all: Vec<&Trial> = trials.iter().collect();
    text.push_str(&summary("all", &all));
    text.push_str("\nnamed, of cases of each row (- nothing):\n");
    for (row, trials) in &rows {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for (score, _) in trials.iter().filter_map(|trial| trial.result.as_ref().ok()) {
            let right = score.named.iter().filter(|(_, named)| *named);
            let mut names: Vec<String> = right
                .map(|(name, _)| (*name).to_owned())
                .chain(score.extra.iter().cloned())
                .collect();
            names.sort();
            names.dedup();
            if names.is_empty() {
                names.push("-".to_owned());
            }
            *counts.entry(names.join("+")).or_default() += 1;
        }
        let mut counts: Vec<_> = counts.into_iter().collect();
        counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let counts: Vec<String> = counts.iter().map(|(n, c)| format!("{n} {c}")).collect();
        let _ = writeln!(text, "  {row:<22} {}", counts.join(", "));
    }
    text
}

fn rows(trials: &[Trial]) -> Vec<(&str, Vec<&Trial>)> {
    let mut rows: Vec<(&str, Vec<&Trial>)> = Vec::new();
    for trial in trials {
        match rows.iter_mut().find(|(row, _)| *row == trial.row) {
            Some((_, of_row)) => of_row.push(trial),
            None => rows.push((&trial.row, vec![trial])),
        }
    }
    rows
}

fn summary(row: &str, trials: &[&Trial]) -> String {
    let scores: Vec<_> = trials
        .iter()
        .filter_map(|t| t.result.as_ref().ok())
        .collect();
    let count = |is: &dyn Fn(&super::score::Score) -> bool| {
        scores.iter().filter(|(score, _)| is(score)).count()
    };
    let mut times: Vec<f64> = scores.iter().map(|(_, time)| time.as_secs_f64()).collect();
    times.sort_by(f64::total_cmp);
    let median = times.get(times.len() / 2).copied().unwrap_or(0.0);
    format!(
        "{row:<22} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {median:>9.2}\n",
        trials.len(),
        count(&|score| score.is_right()),
        count(&|score| score.is_named()),
        count(&|score| !score.extra.is_empty()),
        count(&|score| score.unexplained > 0),
        count(&|score| score.is_worse),
        count(&|score| score.placed == Some(true)),
        trials.len() - scores.len(),
    )
}

/// How often the intervals hold the truth, and the rms error in their deviations.
pub fn coverage(trials: &[Trial]) -> String {
    let mut found: BTreeMap<&str, (usize, usize, usize, f64, usize)> = BTreeMap::new();
    for (score, _) in trials.iter().filter_map(|trial| trial.result.as_ref().ok()) {
        for parameter in score.parameters.iter().chain(&score.coefficients) {
            let (said, inside, missing, squares, with) =
                found.entry(&parameter.name).or_insert((0, 0, 0, 0.0, 0));
            match parameter.inside {
                Some(is_inside) => {
                    *said += 1;
                    *inside += usize::from(is_inside);
                }
                None => *missing += 1,
            }
            if let Some(deviations) = parameter.deviations.filter(|d| d.is_finite()) {
                *squares += deviations * deviations;
                *with += 1;
            }
        }
    }
    let mut text =
        String::from("parameter                 said  inside      %  not said  rms deviations\n");
    let (mut all_said, mut all_inside) = (0, 0);
    for (name, (said, inside, missing, squares, with)) in &found {
        if !name.starts_with("final.") {
            all_said += said;
            all_inside += inside;
        }
        let share = percent(*inside, *said);
        let rms = (squares / (*with).max(1) as f64).sqrt();
        let _ = writeln!(
            text,
            "{name:<24} {said:>5} {inside:>7} {share:>6} {missing:>9} {rms:>15.2}"
        );
    }
    let _ = writeln!(
        text,
        "{:<24} {all_said:>5} {all_inside:>7} {:>6}",
        "effects, pooled",
        percent(all_inside, all_said)
    );
    text
}

/// Detection against strength, a row a kind and a column a strength: percent named, whatever else is
/// said, and in brackets percent that the ideal detector sees.
pub fn detection(trials: &[Trial]) -> String {
    let mut strengths: Vec<f64> = trials.iter().filter_map(|trial| trial.strength).collect();
    strengths.sort_by(f64::total_cmp);
    strengths.dedup();
    let mut text = String::from("named % (ideal %)\nstrength      ");
    for strength in &strengths {
        let _ = write!(text, "{strength:>12.2}");
    }
    text.push('\n');
    let mut rows = rows(trials);
    rows.push(("all", trials.iter().collect()));
    for (row, trials) in rows {
        let _ = write!(text, "{row:<14}");
        for strength in &strengths {
            let here = trials
                .iter()
                .filter(|trial| trial.strength == Some(*strength));
            let here: Vec<&Trial> = here.copied().collect();
            let _ = write!(text, "{:>12}", share(&here));
        }
        text.push('\n');
    }
    text
}

/// A cell of [`detection`]; a program that failed has named nothing.
fn share(trials: &[&Trial]) -> String {
    if trials.is_empty() {
        return "-".to_owned();
    }
    let is_named = |trial: &&&Trial| {
        let result = trial.result.as_ref();
        result.is_ok_and(|(score, _)| score.named.iter().all(|(_, named)| *named))
    };
    let (named, count) = (trials.iter().filter(is_named).count(), trials.len() as f64);
    let ideal: f64 = trials.iter().filter_map(|trial| trial.ideal_power).sum();
    let named = 100.0 * named as f64 / count;
    format!("{named:.0} ({:.0})", 100.0 * ideal / count)
}

fn percent(part: usize, of: usize) -> String {
    if of == 0 {
        return "-".to_owned();
    }
    format!("{:.1}", 100.0 * part as f64 / of as f64)
}
