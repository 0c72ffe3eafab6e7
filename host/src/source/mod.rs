//! One [`Source`] over everything that samples come from: a serial port, a capture, an array
//! file, a simulation, the virtual board.
//!
//! A source says first what it is ([`Signal`]), then yields [`Chunk`]s in the order of the
//! sample index until it ends. Everything behind it (bins, fits, reports) sees only this.

pub mod array;
pub mod assemble;
pub mod audit;
pub mod board;
pub mod capture;
mod columns;
mod error;
mod excluding;
pub mod frames;
mod grid;
mod header;
mod interruption;
pub mod npy;
pub mod open;
pub mod options;
pub mod part;
mod stamps;
pub mod table;
pub mod text;
mod told;

pub use error::SourceError;

use crate::clocks::Clocks;
use crate::signal::Signal;

/// Consecutive samples of all axes, or the news that some are missing.
#[derive(Debug, Clone, PartialEq)]
pub enum Chunk {
    /// Samples without a gap between them.
    Samples(Block),
    /// Samples that should be here and are not.
    Gap(Gap),
    /// Anything else worth telling, in words; it does not touch the samples.
    News(String),
}

/// Consecutive samples of all axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Index of the first sample since the start of the record, in data periods.
    pub first: u64,
    /// One column per axis, all of the same length.
    pub columns: Vec<Column>,
}

impl Block {
    /// Samples an axis.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Index of the sample that would follow.
    pub fn end(&self) -> u64 {
        self.first + self.len() as u64
    }
}

/// Samples of one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The samples; those named in `invalid` hold a place, not a value.
    pub values: Values,
    /// Ranges within the block that must not be used (clipped, torn, NaN), ascending and
    /// disjoint. They are gaps for this axis alone.
    pub invalid: Vec<std::ops::Range<usize>>,
}

/// Raw values before scaling: integers stay integers, so that the bins can be exact.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Converter codes or integer array elements, in counts.
    Codes(Vec<i32>),
    /// Floating-point data, in the unit of the file.
    Floats(Vec<f64>),
}

impl Values {
    /// Number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::Codes(codes) => codes.len(),
            Self::Floats(floats) => floats.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Samples that are missing from all axes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Gap {
    /// Index of the first missing sample.
    pub from: u64,
    /// Index of the next sample that is there; `None` where the number of missing samples is
    /// not known (the record starts a new count).
    pub to: Option<u64>,
    /// Why, in words.
    pub cause: String,
}

/// Where samples come from.
pub trait Source {
    /// What is known about the record; the same from first to last chunk.
    fn signal(&self) -> &Signal;

    /// Samples an axis in the whole record, where that is known ahead.
    fn expected_len(&self) -> Option<u64> {
        None
    }

    /// What the board's own bins prove of the samples so far; `None` where no board is behind
    /// them.
    fn proof(&self) -> Option<audit::Proof> {
        None
    }

    /// The data rate so far by the clocks that were there; `None` where no board has stamped the samples, or too
    /// few.
    fn clocks(&self) -> Option<Clocks> {
        None
    }

    /// The next chunk, `None` at the end.
    ///
    /// # Errors
    /// Whatever stops the record: the message names file or port, place and remedy. Chunks
    /// already delivered stay valid.
    fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError>;
}
