//! The files that `inm live` records into: none of them was there before.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use jiff::Timestamp;

use crate::capture::{CaptureError, Header, Writer};
use crate::link::Connect;
use crate::source::SourceError;
use crate::source::board::{BoardSource, Plan, Stop};

/// Where recordings go.
#[derive(Debug)]
pub(super) enum Captures {
    /// Nowhere: only their statistics are kept.
    None,
    /// The first to this file, which must not exist yet; those behind it beside it, with a number.
    Named {
        /// The file.
        path: PathBuf,
        /// A recording has gone to it.
        used: bool,
    },
    /// The current folder, under the moment at which each begins.
    Dated,
}

impl Captures {
    /// Starts a board, and the next file.
    ///
    /// # Errors
    /// What the link or the file says.
    pub fn start(
        &mut self,
        connect: Box<dyn Connect>,
        plan: Plan,
        stop: Stop,
    ) -> Result<BoardSource, SourceError> {
        let base = match self {
            Self::None => return BoardSource::start(connect, plan, None, stop),
            Self::Named { path, used: false } => {
                let source = BoardSource::start(connect, plan, Some(&*path), stop)?;
                *self = Self::Named {
                    path: std::mem::take(path),
                    used: true,
                };
                return Ok(source);
            }
            Self::Named { path, .. } => path.clone(),
            Self::Dated => dated(Timestamp::now()),
        };
        let create = |header: &Header| first_free(&base, |path| Writer::create(path, header));
        BoardSource::start_into(connect, plan, Some(create), stop)
    }
}

/// The name of a recording that begins at `moment`: as text it sorts by time, and no clock is set back
/// in it.
fn dated(moment: Timestamp) -> PathBuf {
    PathBuf::from(moment.strftime("inm-%Y%m%dT%H%M%SZ.inmcap").to_string())
}

/// Creates the file `base`, or the first beside it that is not there yet.
fn first_free<T>(
    base: &Path,
    create: impl Fn(&Path) -> Result<T, CaptureError>,
) -> Result<T, CaptureError> {
    let mut number = 1;
    loop {
        match create(&numbered(base, number)) {
            Err(CaptureError::Io { source, .. }) if source.kind() == ErrorKind::AlreadyExists => {
                number += 1;
            }
            done => return done,
        }
    }
}

/// `run.inmcap`, `run-2.inmcap`, `run-3.inmcap`.
fn numbered(base: &Path, number: u32) -> PathBuf {
    if number == 1 {
        return base.to_owned();
    }
    let mut name = base.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{number}"));
    if let Some(extension) = base.extension() {
        name.push(".");
        name.push(extension);
    }
    base.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use super::*;

    #[test]
    fn a_date_is_a_name_that_sorts() {
        let at = |text: &str| dated(text.parse().expect("a moment"));
        let first = at("2026-11-23T09:05:07.9Z");
        assert_eq!(first, Path::new("inm-20261123T090507Z.inmcap"));
        assert!(first < at("2026-11-23T10:00:00Z"));
    }

    #[test]
    fn what_is_there_is_never_taken() {
        let folder = tempfile::tempdir().expect("a folder");
        let base = folder.path().join("run.1.inmcap");
        let create = |path: &Path| {
            File::create_new(path).map_err(|source| CaptureError::Io {
                path: path.to_owned(),
                doing: "creating the capture",
                source,
            })?;
            Ok(path.file_name().unwrap_or_default().to_owned())
        };
        let names = [(); 3].map(|()| first_free(&base, create).expect("created"));
        assert_eq!(names, ["run.1.inmcap", "run.1-2.inmcap", "run.1-3.inmcap"]);
        let nowhere = folder.path().join("missing/run.inmcap");
        first_free(&nowhere, create).expect_err("no such folder");
    }
}
