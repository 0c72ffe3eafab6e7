//! What can be wrong with a capture file.

use std::io;
use std::path::PathBuf;

use inm_protocol::VERSION;

/// Why a capture cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The operating system refused.
    #[error("{}: {doing}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
        /// What the system said.
        #[source]
        source: io::Error,
    },
    /// The first line is not that of a capture.
    #[error("{}: not a capture: the first line is not `{}`", path.display(), super::MAGIC)]
    NotACapture {
        /// The file.
        path: PathBuf,
    },
    /// The header line does not hold what it should.
    #[error("{}: line 2 (the header): {source}", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// What the JSON reader found.
        #[source]
        source: serde_json::Error,
    },
    /// The file ends inside its header.
    #[error("{}: the file ends at byte {at}, inside its header: nothing was recorded", path.display())]
    CutHeader {
        /// The file.
        path: PathBuf,
        /// Its length.
        at: u64,
    },
    /// Written under another protocol version.
    #[error(
        "{}: line 2: written with protocol version {theirs}, this program reads versions 1 to {VERSION}",
        path.display()
    )]
    Protocol {
        /// The file.
        path: PathBuf,
        /// Version in its header.
        theirs: u8,
    },
    /// A number in the header that no recording can have.
    #[error("{}: line 2: `{field}` is {found}, expected {expected}", path.display())]
    Number {
        /// The file.
        path: PathBuf,
        /// The field.
        field: String,
        /// Its value.
        found: String,
        /// What it may be.
        expected: &'static str,
    },
    /// The header's signal chain cannot be read.
    #[error("{}: line 2: axis {axis}: {source}", path.display())]
    Chain {
        /// The file.
        path: PathBuf,
        /// Name of the axis.
        axis: String,
        /// What is wrong with it.
        #[source]
        source: crate::chain::ChainError,
    },
}

impl CaptureError {
    /// What to do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Io { source, .. } if source.kind() == io::ErrorKind::StorageFull => {
                "free some space and record again; the file keeps all that was written before"
            }
            Self::Io { source, .. } if source.kind() == io::ErrorKind::AlreadyExists => {
                "choose another name; a recording never overwrites one"
            }
            Self::Io { .. } => "check the path and its permissions",
            Self::NotACapture { .. } => "arrays are recognised by their ending: .npy, .csv, .txt",
            Self::Header { .. } | Self::Number { .. } | Self::Chain { .. } => {
                "the header was edited or damaged; restore line 2 from another capture of the \
                 same board"
            }
            Self::CutHeader { .. } => "record again",
            Self::Protocol { .. } => "use the inm release named as `inm` in the header",
        }
    }
}
