//! What the header of a NumPy `.npy` file says, and why one is refused.

/// Element type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Signed integer.
    Signed,
    /// Unsigned integer.
    Unsigned,
    /// IEEE floating point: half, single or double.
    Float,
}

/// What the header says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// Element type.
    pub kind: Kind,
    /// Bytes an element: 1, 2, 4 or 8.
    pub size: usize,
    /// Whether the most significant byte comes first.
    pub big_endian: bool,
    /// Whether whole columns follow one another (Fortran order) instead of rows.
    pub by_column: bool,
    /// Number of rows.
    pub rows: u64,
    /// Number of columns; 1 for a vector.
    pub columns: usize,
    /// Byte at which the elements begin.
    pub data_start: u64,
}

/// Why a header is refused: what was found at which byte.
#[derive(Debug, thiserror::Error)]
#[error("byte {byte}: {message}")]
pub struct HeaderError {
    /// Place in the file.
    pub byte: u64,
    /// What was found and what was expected.
    pub message: String,
    /// What to do about it.
    pub remedy: &'static str,
}

/// The remedy for a header that NumPy would not write.
pub(super) const SAVE_AGAIN: &str = "save the array again with numpy.save";

impl Header {
    /// Byte after the last element.
    pub fn data_end(&self) -> u64 {
        let bytes = (self.columns as u64).saturating_mul(self.size as u64);
        self.data_start
            .saturating_add(self.rows.saturating_mul(bytes))
    }
}
