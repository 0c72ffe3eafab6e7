//! Where the lines of a log go, and how long it is followed.

use std::fs::File;
use std::io::Write;

use anyhow::Context;
use serde::Serialize;

use super::super::output;

/// Longest duration, seconds: a century, which is for ever and still a time.
pub(super) const LONGEST_S: f64 = 3.2e9;

/// Where entries go.
pub(super) enum Sink {
    /// The terminal, in words.
    Text,
    /// The terminal, as JSON.
    Json,
    /// A file as JSON, and the terminal in words.
    Both(String, File),
}

impl Sink {
    /// Where `--json` says.
    ///
    /// # Errors
    /// The file cannot be created.
    pub(super) fn open(json: Option<&str>) -> anyhow::Result<Self> {
        Ok(match json {
            None => Self::Text,
            Some("-") => Self::Json,
            Some(path) => {
                let file =
                    File::create(path).with_context(|| format!("{path}: cannot be created"))?;
                Self::Both(path.to_owned(), file)
            }
        })
    }

    /// Writes an entry as JSON, and the same in words.
    ///
    /// # Errors
    /// The file or the terminal cannot be written.
    pub(super) fn write(&mut self, entry: &impl Serialize, words: &str) -> anyhow::Result<()> {
        let json = format!("{}\n", serde_json::to_string(entry)?);
        if let Self::Both(path, file) = self {
            file.write_all(json.as_bytes())
                .with_context(|| format!("{path}: cannot be written"))?;
        }
        match self {
            Self::Json => output::say(&json)?,
            Self::Text | Self::Both(..) => output::say(words)?,
        }
        Ok(())
    }
}
