//! The program in the folder of a record, so that nothing it says depends on where that is.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::record::Frozen;
use crate::hidden::case::Files;
use crate::hidden::judge::program::Failure;
use crate::hidden::judge::trial::each;

/// What to run where.
#[derive(Debug, Clone)]
pub struct Bench {
    /// `inm`; absolute, as the next two.
    pub inm: PathBuf,
    /// Where the records are.
    pub records: PathBuf,
    /// Where the answers go.
    pub answers: PathBuf,
}

impl Bench {
    /// Diagnoses the record called `name` into `NAME.json` and `NAME.model.json`.
    ///
    /// # Errors
    /// If the program does not start, or ends with another status than 0 or 1.
    pub fn diagnose(&self, name: &str, files: &Files) -> Result<(), Failure> {
        let output = Command::new(&self.inm)
            .current_dir(&self.records)
            .args(arguments(files))
            .arg("--json")
            .arg(self.answer(name))
            .arg("--model")
            .arg(self.answers.join(format!("{name}.model.json")))
            .stdin(Stdio::null())
            .output()
            .map_err(|source| Failure::Start {
                path: self.inm.clone(),
                source,
            })?;
        if matches!(output.status.code(), Some(0 | 1)) {
            return Ok(());
        }
        let said = String::from_utf8_lossy(&output.stderr);
        let said = said.lines().find(|line| !line.is_empty());
        // The number of a thread that panics differs from run to run.
        let said = said.filter(|line| !line.starts_with("thread"));
        let said = said.unwrap_or("it panicked").to_owned();
        Err(Failure::Status(output.status.to_string(), said))
    }

    /// The file with what is said of a record.
    pub fn answer(&self, name: &str) -> PathBuf {
        self.answers.join(format!("{name}.json"))
    }
}

/// Asks of all records, `at_once` at a time, and writes them just for that; `progress` hears of
/// every one. What came of each, in order.
pub fn ask(
    records: &[Frozen],
    bench: &Bench,
    at_once: usize,
    progress: &(dyn Fn(&Frozen, Duration) + Sync),
) -> Vec<Result<(), Failure>> {
    each(records, at_once, &|record: &Frozen| {
        let files = record.write(&bench.records)?;
        let start = Instant::now();
        let answered = bench.diagnose(record.name(), &files);
        progress(record, start.elapsed());
        fs::remove_file(bench.records.join(&files.record))?;
        answered
    })
}

/// What `inm` is told of a record, in the folder where it is.
pub fn arguments(files: &Files) -> Vec<String> {
    let record = files.record.display().to_string();
    let mut arguments = vec!["diagnose".to_owned(), record];
    arguments.extend(files.arguments.iter().cloned());
    arguments
}

/// Where what was said before stands in the repository.
pub fn frozen_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("frozen")
}

/// A path that holds in every folder.
///
/// # Errors
/// If there is nothing there.
pub fn absolute(path: &Path) -> io::Result<PathBuf> {
    let say = |error| io::Error::other(format!("{}: {error}", path.display()));
    path.canonicalize().map_err(say)
}
