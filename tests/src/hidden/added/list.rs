//! Which records there are, and their samples.

use std::io;
use std::path::{Path, PathBuf};

use inm_host::internals::source::{Chunk, Source, SourceError, Values};
use inm_host::{ArrayOptions, Selector, Unit, open};
use serde::Deserialize;

/// A record as the list has it.
#[derive(Debug, Deserialize)]
struct Entry {
    name: String,
    /// From the folder of the list.
    file: PathBuf,
    /// Samples a second.
    rate: f64,
    /// Numbers of the columns that are axes.
    columns: Vec<usize>,
    /// Size of a number in the file.
    #[serde(default = "one")]
    scale: f64,
    /// Seconds from the file's beginning.
    from: Option<f64>,
    to: Option<f64>,
}

fn one() -> f64 {
    1.0
}

/// A record that somebody measured.
#[derive(Debug)]
pub struct Recording {
    /// What the list calls it.
    pub name: String,
    /// Samples a second.
    pub rate_hz: f64,
    /// An axis each, NaN where a sample is missing.
    pub axes: Vec<Vec<f64>>,
}

/// Why the records cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ListError {
    /// The list.
    #[error("{}: {source}", path.display())]
    Unreadable {
        /// Its path.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// What is in it.
    #[error(
        "{}: {source}; expected a list of {{\"name\", \"file\", \"rate\", \"columns\"}}, and \"scale\", \"from\", \"to\" where needed",
        path.display()
    )]
    Malformed {
        /// Its path.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// A record that it names.
    #[error("record `{name}`: {source}")]
    Record {
        /// What the list calls it.
        name: String,
        /// Why.
        source: SourceError,
    },
}

/// All records of the list at `path`, a JSON array.
///
/// # Errors
/// If it or a record cannot be read.
pub fn read(path: &Path) -> Result<Vec<Recording>, ListError> {
    let text = std::fs::read(path).map_err(|source| ListError::Unreadable {
        path: path.to_owned(),
        source,
    })?;
    let entries: Vec<Entry> =
        serde_json::from_slice(&text).map_err(|source| ListError::Malformed {
            path: path.to_owned(),
            source,
        })?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let recording = |entry: Entry| {
        recording(&entry, folder).map_err(|source| ListError::Record {
            name: entry.name,
            source,
        })
    };
    entries.into_iter().map(recording).collect()
}

fn recording(entry: &Entry, folder: &Path) -> Result<Recording, SourceError> {
    let options = ArrayOptions {
        rate_hz: Some(entry.rate),
        columns: entry.columns.iter().map(|&n| Selector::Number(n)).collect(),
        unit: Some(Unit::MetrePerSecondSquared),
        scales: vec![entry.scale],
        from_s: entry.from,
        to_s: entry.to,
        ..ArrayOptions::default()
    };
    let path = folder.join(&entry.file);
    let mut source = open(&path.to_string_lossy(), &options)?;
    Ok(Recording {
        name: entry.name.clone(),
        rate_hz: entry.rate,
        axes: columns(source.as_mut(), entry)?,
    })
}

fn columns(source: &mut dyn Source, entry: &Entry) -> Result<Vec<Vec<f64>>, SourceError> {
    let mut axes: Vec<Vec<f64>> = vec![Vec::new(); entry.columns.len()];
    let mut begin = None;
    while let Some(chunk) = source.next_chunk()? {
        // Gaps show in the numbers of the samples.
        let Chunk::Samples(block) = chunk else {
            continue;
        };
        let begin = *begin.get_or_insert(block.first);
        for (axis, column) in axes.iter_mut().zip(&block.columns) {
            let first = axis.len().max((block.first - begin) as usize);
            axis.resize(first, f64::NAN);
            match &column.values {
                Values::Codes(codes) => {
                    axis.extend(codes.iter().map(|&code| f64::from(code) * entry.scale));
                }
                Values::Floats(floats) => {
                    axis.extend(floats.iter().map(|float| float * entry.scale));
                }
            }
            for invalid in &column.invalid {
                axis[first + invalid.start..first + invalid.end].fill(f64::NAN);
            }
        }
    }
    Ok(axes)
}
