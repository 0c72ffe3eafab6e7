//! One random record given to the program, and what is wrong with what it says.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::Value;

use super::bounds::{Room, broken};
use super::record::Record;
use super::run::{End, run};
use crate::hidden::judge::answer::{Answer, Interval};

/// How long the program may take of the processors.
pub const LIMIT: Duration = Duration::from_secs(60);

/// Samples simulated from the model at most: it is to be read, not to be judged.
const SIMULATED: f64 = 8192.0;

/// One of so many records gets a page with pictures too.
const WITH_PAGE: u64 = 4;

/// What came of one record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outcome {
    /// How it ended, where it ended well: `diagnosed`, or why it was refused.
    pub end: String,
    /// What is wrong, a class each; none for a record that passes.
    pub failures: Vec<String>,
}

/// Writes the record, diagnoses it and checks the answer, in a folder that is gone afterwards.
///
/// # Errors
/// If files cannot be written or the program does not start.
pub fn check(inm: &Path, record: &Record) -> io::Result<Outcome> {
    let folder = tempfile::tempdir()?;
    let files = record.write(folder.path())?;
    let path = |name: &str| folder.path().join(name);
    let (json, model) = (path("answer.json"), path("model.json"));
    let mut arguments: Vec<PathBuf> = vec!["diagnose".into(), files.record.clone()];
    arguments.extend(files.arguments.iter().map(PathBuf::from));
    arguments.extend([
        "--json".into(),
        json.clone(),
        "--model".into(),
        model.clone(),
    ]);
    if record.seed.is_multiple_of(WITH_PAGE) {
        arguments.extend(["--report".into(), path("page.html")]);
    }
    let (status, said) = match run(inm, &arguments, folder.path(), LIMIT)? {
        End::Late => return Ok(Outcome::failed("late: not done after 60 s".to_owned())),
        End::Ended(status, said) => (status, said),
    };
    if let Some(panic) = panicked(&said) {
        return Ok(Outcome::failed(panic));
    }
    match status {
        Some(0 | 1) => {}
        Some(2) => return Ok(refused(&said)),
        other => {
            return Ok(Outcome::failed(format!(
                "status: {other:?}, {}",
                masked(&said)
            )));
        }
    }
    let mut failures = said_wrong(&json, record)?;
    failures.extend(unread(inm, &model, record, folder.path())?);
    failures.sort();
    failures.dedup();
    Ok(Outcome {
        end: "diagnosed".to_owned(),
        failures,
    })
}

impl Outcome {
    fn failed(why: String) -> Self {
        Self {
            end: "failed".to_owned(),
            failures: vec![why],
        }
    }
}

/// A refusal is good if it says why.
fn refused(said: &str) -> Outcome {
    let why = masked(said);
    let failures = match why.is_empty() {
        true => vec!["refused without a word".to_owned()],
        false => Vec::new(),
    };
    Outcome {
        end: format!("refused: {why}"),
        failures,
    }
}

/// Place and words of a panic.
fn panicked(said: &str) -> Option<String> {
    let mut lines = said.lines();
    let line = lines.find(|line| line.contains("panicked at"))?;
    let place = line.split("panicked at").nth(1).unwrap_or_default();
    let words = lines.next().unwrap_or_default();
    Some(format!(
        "panic:{} {}",
        place.trim_end_matches(':'),
        masked(words)
    ))
}

/// The first line without its numbers and names, so that refusals of one kind are one class.
fn masked(said: &str) -> String {
    let line = said.lines().find(|line| !line.trim().is_empty());
    let mut text = String::new();
    for c in line.unwrap_or_default().chars() {
        match c {
            '0'..='9' if text.ends_with('#') => {}
            '0'..='9' => text.push('#'),
            c => text.push(c),
        }
    }
    let words = text.split(' ').filter(|word| !word.contains('/'));
    words
        .collect::<Vec<_>>()
        .join(" ")
        .chars()
        .take(110)
        .collect()
}

fn said_wrong(json: &Path, record: &Record) -> io::Result<Vec<String>> {
    let text = std::fs::read(json)?;
    let answer: Answer = match serde_json::from_slice(&text) {
        Ok(answer) => answer,
        Err(error) => return Ok(vec![format!("json: {}", masked(&error.to_string()))]),
    };
    let raw: Value = serde_json::from_slice(&text)?;
    let mut failures = Vec::new();
    if answer.axes.len() != record.columns.len() {
        failures.push("json: not one axis a column".to_owned());
    }
    for (axis, column) in answer.axes.iter().zip(&record.columns) {
        let room = room(record, column);
        for finding in &axis.findings {
            for (name, said) in &finding.parameters {
                let name = name.as_str();
                if let Some(rule) = broken(&finding.effect, name, said, &room) {
                    failures.push(format!("bound: {}.{name}: {rule}", finding.effect));
                }
            }
        }
        let last = axis.last.iter().flat_map(|last| &last.coefficients);
        failures.extend(last.filter_map(|(name, said)| coefficient(name, said)));
    }
    probabilities(&raw, &mut failures);
    Ok(failures)
}

fn coefficient(name: &str, said: &Interval) -> Option<String> {
    let (lo, hi) = (said.lo.unwrap_or(0.0), said.hi.unwrap_or(f64::INFINITY));
    let value = said.value?;
    let bad = !(lo..=hi).contains(&value) || value < 0.0;
    bad.then(|| format!("bound: final.{name}: outside its own interval, or negative"))
}

/// Whatever is called a probability, wherever it stands.
fn probabilities(value: &Value, failures: &mut Vec<String>) {
    match value {
        Value::Array(values) => values.iter().for_each(|one| probabilities(one, failures)),
        Value::Object(fields) => {
            for (name, one) in fields {
                let p = one.as_f64().filter(|_| name == "p_value");
                if p.is_some_and(|p| !(0.0..=1.0).contains(&p)) {
                    failures.push("bound: p_value: no probability".to_owned());
                }
                probabilities(one, failures);
            }
        }
        _ => {}
    }
}

fn room(record: &Record, column: &[f64]) -> Room {
    let finite = column.iter().filter(|value| value.is_finite());
    let ends = finite.fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, most), value| {
            (
                least.min(value * record.scale),
                most.max(value * record.scale),
            )
        },
    );
    Room {
        samples: column.len(),
        rate_hz: record.rate_hz,
        least: ends.0,
        most: ends.1,
        chain: record.chain,
    }
}

/// Whether `inm simulate` reads the model.
fn unread(inm: &Path, model: &Path, record: &Record, folder: &Path) -> io::Result<Option<String>> {
    let samples = SIMULATED.min(record.columns[0].len() as f64);
    let arguments: Vec<PathBuf> = vec![
        "simulate".into(),
        "--model".into(),
        model.to_owned(),
        "--duration".into(),
        (samples / record.rate_hz).to_string().into(),
        "-o".into(),
        folder.join("simulated.npy"),
    ];
    let end = run(inm, arguments, folder, LIMIT)?;
    Ok(match end {
        End::Late => Some("model: simulating takes more than 60 s".to_owned()),
        End::Ended(Some(0), _) => None,
        End::Ended(_, said) => Some(match panicked(&said) {
            Some(panic) => format!("model: {panic}"),
            None => format!("model: {}", masked(&said)),
        }),
    })
}
