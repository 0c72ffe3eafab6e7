//! The program under test, as a process.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::answer::Answer;
use crate::hidden::case::Files;

/// Something that diagnoses a record: the program, or a stand-in for tests of the judge.
pub trait Diagnose: Sync {
    /// What it says of the record.
    ///
    /// # Errors
    /// If it fails; status 1 (something left unexplained) is no failure.
    fn diagnose(&self, files: &Files) -> Result<Outcome, Failure>;
}

/// An answer and how long it took.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What it says.
    pub answer: Answer,
    /// Wall-clock time of the process.
    pub time: Duration,
}

/// `inm`, built.
#[derive(Debug, Clone)]
pub struct Program(pub PathBuf);

impl Diagnose for Program {
    fn diagnose(&self, files: &Files) -> Result<Outcome, Failure> {
        self.diagnose_to(files, None)
    }
}

impl Program {
    /// `inm` beside the running test, in the target folder.
    ///
    /// # Panics
    /// If it has not been built.
    pub fn built() -> Self {
        let test = std::env::current_exe().expect("a test has a path");
        let folder = test.ancestors().nth(2).expect("target/PROFILE/deps/test");
        let path = folder.join(format!("inm{}", std::env::consts::EXE_SUFFIX));
        assert!(
            path.exists(),
            "{} is missing; run: cargo build -p inm-host",
            path.display()
        );
        Self(path)
    }

    /// What it says of a record; its last model goes to the file `model`, where one is wanted.
    ///
    /// # Errors
    /// As [`Diagnose::diagnose`].
    pub fn diagnose_to(&self, files: &Files, model: Option<&Path>) -> Result<Outcome, Failure> {
        let json = files.record.with_extension("json");
        let mut arguments = vec!["diagnose".into(), files.record.clone().into_os_string()];
        arguments.extend(files.arguments.iter().map(OsString::from));
        arguments.extend(["--json".into(), json.clone().into_os_string()]);
        if let Some(model) = model {
            arguments.extend(["--model".into(), model.as_os_str().to_owned()]);
        }
        let time = self.run(arguments)?;
        Ok(Outcome {
            answer: read(&json)?,
            time,
        })
    }

    /// Runs it to its end; how long that took.
    ///
    /// # Errors
    /// If it does not start, or ends with another status than 0 or 1.
    pub fn run(&self, arguments: Vec<OsString>) -> Result<Duration, Failure> {
        let start = Instant::now();
        let output = Command::new(&self.0)
            .args(arguments)
            .stdin(Stdio::null())
            .output()
            .map_err(|source| Failure::Start {
                path: self.0.clone(),
                source,
            })?;
        let time = start.elapsed();
        if !matches!(output.status.code(), Some(0 | 1)) {
            let said = String::from_utf8_lossy(&output.stderr);
            let said = said.lines().find(|line| !line.is_empty());
            let said = said.unwrap_or_default();
            return Err(Failure::Status(output.status.to_string(), said.to_owned()));
        }
        Ok(time)
    }
}

fn read(json: &Path) -> Result<Answer, Failure> {
    let text = std::fs::read(json)?;
    Ok(serde_json::from_slice(&text)?)
}

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// The program does not start.
    #[error("{} does not start: {source}", path.display())]
    Start {
        /// The program.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It ends with another status than 0 or 1.
    #[error("the program ended with {0}: {1}")]
    Status(String, String),
    /// It wrote no answer, or the record could not be written.
    #[error("the files of a case: {0}")]
    Files(#[from] std::io::Error),
    /// Its answer is not as documented.
    #[error("the JSON is not as documented: {0}")]
    Json(#[from] serde_json::Error),
}
