//! A frozen record: what it is made of, and how it gets onto disk.

use std::io;
use std::path::Path;

use super::change::Change;
use crate::hidden::case::{Case, Files};
use crate::hidden::judge::trial::Task;
use crate::hidden::npy;

/// A record whose diagnosis is frozen.
#[derive(Clone)]
pub struct Frozen {
    name: String,
    parts: Vec<Task>,
    change: Change,
}

impl Frozen {
    /// One of the judge's cases, changed.
    pub fn one(task: Task, change: Change) -> Self {
        let name = format!("{}-{}{}", task.plan.name(), task.seed, change.suffix());
        Self {
            name,
            parts: vec![task],
            change,
        }
    }

    /// The first axes of several cases side by side. Of each, the next seed is taken whose case
    /// has no chain: there is one for a whole record.
    pub fn axes(parts: Vec<Task>) -> Self {
        let names: Vec<String> = parts.iter().map(|task| task.plan.name()).collect();
        Self {
            name: format!("axes-{}", names.join("-")),
            parts,
            change: Change::None,
        }
    }

    /// Its name, which stays.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Writes its files into `folder`. The names in the answer are relative to it, so that what
    /// the program says of them does not depend on where the folder is.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<Files> {
        let (mut case, step) = self.make();
        let mut arguments = case.arguments();
        let record = format!("{}.npy", self.name);
        if let Some(step) = step {
            arguments.extend(["--scale".to_owned(), step.to_string()]);
            let codes: Vec<Vec<i32>> = case.columns.iter().map(|c| codes(c, step)).collect();
            let columns: Vec<&[i32]> = codes.iter().map(Vec::as_slice).collect();
            npy::write(&folder.join(&record), &columns)?;
        } else {
            case.columns.extend(case.temperature.take());
            write(&folder.join(&record), &case.columns)?;
        }
        if let Some(reference) = &case.reference {
            let name = format!("{}.reference.npy", self.name);
            write(&folder.join(&name), reference)?;
            arguments.extend(["--reference".to_owned(), name]);
        }
        Ok(Files {
            record: record.into(),
            arguments,
        })
    }

    /// The case, and the size of a code's step where it is to be written as codes.
    fn make(&self) -> (Case, Option<f64>) {
        let mut cases = self.parts.iter().map(|task| match self.parts.len() {
            1 => Case::draw(&task.plan, task.seed),
            _ => without_chain(task),
        });
        let mut case = cases.next().expect("a record has an axis");
        case.columns.extend(cases.flat_map(|other| other.columns));
        let step = self.change.apply(&mut case);
        (case, step)
    }
}

fn without_chain(task: &Task) -> Case {
    (task.seed..)
        .map(|seed| Case::draw(&task.plan, seed))
        .find(|case| case.scene.chain.is_none())
        .expect("three cases of four have no chain")
}

fn write(path: &Path, columns: &[Vec<f64>]) -> io::Result<()> {
    let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    npy::write(path, &columns)
}

/// The nearest codes with steps of this size.
fn codes(samples: &[f64], step: f64) -> Vec<i32> {
    let code = |sample: &f64| (sample / step).round() as i32;
    samples.iter().map(code).collect()
}
