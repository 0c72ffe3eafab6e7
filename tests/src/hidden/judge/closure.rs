//! Whether data of the model that a diagnosis ends with are diagnosed as the record was.

use std::fmt::Write;

use super::answer::Answer;
use super::program::{Failure, Program};
use super::trial::Task;
use crate::hidden::case::{Case, Files};

/// Names found in a record, and in data of its model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Closed {
    /// Those of each axis, sorted.
    pub first: Vec<Vec<String>>,
    /// Those of each axis in the data.
    pub again: Vec<Vec<String>>,
    /// Remarks about something unexplained in the data.
    pub remarks: usize,
}

impl Closed {
    /// The same effects and nothing else.
    pub fn is_same(&self) -> bool {
        self.first == self.again && self.remarks == 0
    }
}

/// Draws a case, diagnoses it, simulates the last model as long and at the same temperature, and
/// diagnoses that.
///
/// # Errors
/// If the program fails.
pub fn close(task: &Task, program: &Program) -> Result<Closed, Failure> {
    let case = Case::draw(&task.plan, task.seed);
    let folder = tempfile::tempdir()?;
    let files = case.write(folder.path())?;
    let model = folder.path().join("model.json");
    let first = program.diagnose_to(&files, Some(&model))?.answer;
    let again = Files {
        record: folder.path().join("again.npy"),
        arguments: files.arguments.clone(),
    };
    let duration_s = case.columns[0].len() as f64 / case.scene.rate_hz;
    let mut arguments = vec![
        "simulate".into(),
        "--model".into(),
        model.into_os_string(),
        "--seed".into(),
        task.seed.to_string().into(),
        "--duration".into(),
        duration_s.to_string().into(),
        "--output".into(),
        again.record.clone().into_os_string(),
    ];
    if case.temperature.is_some() {
        arguments.extend([
            "--temperature".into(),
            files.record.into_os_string(),
            "--temperature-column".into(),
            case.columns.len().to_string().into(),
        ]);
    }
    program.run(arguments)?;
    let second = program.diagnose_to(&again, None)?.answer;
    Ok(Closed {
        first: names(&first),
        remarks: second.axes.iter().map(|axis| axis.unexplained.len()).sum(),
        again: names(&second),
    })
}

fn names(answer: &Answer) -> Vec<Vec<String>> {
    let of_axis = |axis: &super::answer::Axis| {
        let names = axis.findings.iter().map(|one| one.effect.clone());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    answer.axes.iter().map(of_axis).collect()
}

/// How many of each row's records show the same again.
pub fn table(tasks: &[Task], closed: &[Result<Closed, Failure>]) -> String {
    let mut rows: Vec<(String, usize, usize)> = Vec::new();
    for (task, closed) in tasks.iter().zip(closed) {
        let name = task.plan.name();
        if rows.last().is_none_or(|row| row.0 != name) {
            rows.push((name, 0, 0));
        }
        if let Some(row) = rows.last_mut() {
            row.1 += usize::from(closed.as_ref().is_ok_and(Closed::is_same));
            row.2 += 1;
        }
    }
    let (same, all) = rows
        .iter()
        .fold((0, 0), |sum, row| (sum.0 + row.1, sum.1 + row.2));
    rows.push(("all".to_owned(), same, all));
    let mut text = String::from("the same effects, and nothing else, in data of the model found\n");
    for (name, same, all) in rows {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{name:<16}{same:>6} of {all}");
    }
    text
}
