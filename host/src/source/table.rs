//! What array files have in common: rows of numbers in columns, read in order.

use super::{SourceError, Values};

/// Rows of numbers, read once from first to last.
pub trait Table {
    /// File name, for messages.
    fn name(&self) -> &str;

    /// Names from a header line; `None` where columns only have numbers.
    fn header(&self) -> Option<&[String]>;

    /// Number of columns.
    fn width(&self) -> usize;

    /// Rows in all, where that is known ahead.
    fn rows(&self) -> Option<u64>;

    /// Whether the elements are integers, so that a unit or a scale must be given.
    fn is_integer(&self) -> bool;

    /// Where row `row` stands, as a person would look it up.
    fn place(&self, row: u64) -> String;

    /// Chooses the columns that [`Self::read`] returns, in their order. Called once, before.
    ///
    /// # Errors
    /// If the layout of the file does not allow it.
    fn select(&mut self, columns: &[usize]) -> Result<(), SourceError>;

    /// The next rows, at most `most`: one column of values for each selected one. Empty
    /// columns mean the end.
    ///
    /// # Errors
    /// With the place, if the file cannot be read or does not hold what it should.
    fn read(&mut self, most: usize) -> Result<Vec<Values>, SourceError>;

    /// What was noticed while reading and was not told before, in words.
    fn notes(&mut self) -> Vec<String> {
        Vec::new()
    }
}
