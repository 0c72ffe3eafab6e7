//! Text with commas, semicolons, tabs or blanks between its cells, as a table.
//!
//! Lines with names may stand ahead; `#` starts a comment; an empty cell and `nan` in any spelling
//! stand for a missing value. How a file is written shows in its first lines ([`way`], [`shape`]).

mod cells;
mod lines;
mod shape;
mod way;

use std::collections::VecDeque;
use std::io::BufRead;

use super::options::Decimal;
use super::table::Table;
use super::{SourceError, Values};
use cells::{number, reader};
use lines::{Line, Lines};
use shape::Shape;

/// Lines that are looked at before the first is read: enough for fractions with a leading zero to
/// show, one in ten, and few enough to be read at once.
const LOOKED_AT: usize = 256;

/// An open text file.
pub struct TextTable {
    name: String,
    lines: Lines,
    shape: Shape,
    /// Lines that were looked at and not read yet.
    ahead: VecDeque<Line>,
    selected: Vec<usize>,
    /// Lines of the rows that the last reading returned, and the first of those rows.
    numbers: Vec<u64>,
    first_row: u64,
    rows: u64,
    /// Fewest bytes of the last cell of any row so far.
    shortest: usize,
    notes: Vec<String>,
}

impl TextTable {
    /// Reads as far as it takes to see how the file is written.
    ///
    /// # Errors
    /// If it holds no row of numbers, could be read in two ways, or is not text.
    pub fn open(
        name: &str,
        reader: Box<dyn BufRead>,
        decimal: Option<Decimal>,
    ) -> Result<Self, SourceError> {
        let mut lines = Lines::new(name, reader);
        let mut ahead = Vec::new();
        while ahead.len() < LOOKED_AT
            && let Some(line) = lines.next()?
        {
            ahead.push(line);
        }
        let whole = ahead.iter().take_while(|line| line.is_whole).count();
        // A last line that was cut off shows nothing, but where it is the only one.
        let shape = Shape::of(name, &ahead[..whole], decimal)
            .or_else(|_| Shape::of(name, &ahead, decimal))?;
        let ahead = ahead.into_iter();
        let ahead = ahead.filter(|line| line.number >= shape.first).collect();
        Ok(Self {
            name: name.to_owned(),
            lines,
            selected: (0..shape.width).collect(),
            shape,
            ahead,
            numbers: Vec::new(),
            first_row: 0,
            rows: 0,
            shortest: usize::MAX,
            notes: Vec::new(),
        })
    }

    /// The next line that is no comment, `None` at the end.
    fn line(&mut self) -> Result<Option<Line>, SourceError> {
        loop {
            let line = match self.ahead.pop_front() {
                Some(line) => line,
                None => match self.lines.next()? {
                    Some(line) => line,
                    None => return Ok(None),
                },
            };
            if line.comment.is_none() {
                return Ok(Some(line));
            }
        }
    }

    /// Whether the row of a line without an end is not all there: a cell is missing or no number, or
    /// the last is shorter than in any row before.
    fn is_cut(&self, cells: &csv::StringRecord) -> bool {
        let last = cells.get(self.shape.width - 1);
        cells
            .iter()
            .any(|cell| number(cell, self.shape.decimal).is_none())
            || last.is_none_or(|last| last.len() < self.shortest)
    }

    /// Adds the row in `cells` to `columns`.
    fn row(
        &self,
        line: u64,
        cells: &csv::StringRecord,
        columns: &mut [Vec<f64>],
    ) -> Result<(), SourceError> {
        let place = || format!("{}:{line}", self.name);
        let width = self.shape.width;
        // A separator behind the last cell is no cell.
        let is_spare = cells.len() == width + 1 && cells.get(width) == Some("");
        if cells.len() != width && !is_spare {
            return Err(SourceError {
                place: place(),
                message: format!(
                    "{} columns, where the lines before have {width}",
                    cells.len()
                ),
                remedy: "complete the line, or delete it".into(),
            });
        }
        for (values, &column) in columns.iter_mut().zip(&self.selected) {
            let cell = cells.get(column).unwrap_or_default();
            values.push(number(cell, self.shape.decimal).ok_or_else(|| {
                SourceError {
                    place: place(),
                    message: format!(
                        "`{}` in column {} where a number was expected",
                        shortened(cell),
                        self.called(column)
                    ),
                    remedy: match self.shape.decimal {
                        Decimal::Point if number(cell, Decimal::Comma).is_some() => {
                            "give --decimal comma if the commas are decimal"
                        }
                        _ => "correct the cell, or leave it empty (`nan`) to mark a missing sample",
                    }
                    .into(),
                }
            })?);
        }
        Ok(())
    }

    /// Number of a column, and its name where it has one.
    fn called(&self, column: usize) -> String {
        let name = self.shape.names.as_ref().map(|names| &names[column]);
        name.map_or(column.to_string(), |name| format!("{column} ({name})"))
    }
}

impl Table for TextTable {
    fn name(&self) -> &str {
        &self.name
    }

    fn header(&self) -> Option<&[String]> {
        self.shape.names.as_deref()
    }

    fn width(&self) -> usize {
        self.shape.width
    }

    fn rows(&self) -> Option<u64> {
        None
    }

    fn is_integer(&self) -> bool {
        false
    }

    fn place(&self, row: u64) -> String {
        let known = row
            .checked_sub(self.first_row)
            .and_then(|at| self.numbers.get(at as usize));
        known.map_or_else(
            || format!("{}: row {row}", self.name),
            |line| format!("{}:{line}", self.name),
        )
    }

    fn select(&mut self, columns: &[usize]) -> Result<(), SourceError> {
        self.selected = columns.to_vec();
        Ok(())
    }

    fn read(&mut self, most: usize) -> Result<Vec<Values>, SourceError> {
        let mut text = String::new();
        let mut numbers = Vec::new();
        let mut is_whole = true;
        while numbers.len() < most
            && let Some(line) = self.line()?
        {
            text.push_str(&self.shape.separator.joined(&line.text));
            text.push('\n');
            numbers.push(line.number);
            is_whole = line.is_whole;
        }
        let mut columns = vec![Vec::with_capacity(numbers.len()); self.selected.len()];
        let mut cells = csv::StringRecord::new();
        let mut reader = reader(self.shape.separator, text.as_bytes());
        for (at, &line) in numbers.iter().enumerate() {
            reader
                .read_record(&mut cells)
                .map_err(|error| SourceError {
                    place: format!("{}:{line}", self.name),
                    message: error.to_string(),
                    remedy: "correct the line, or delete it".into(),
                })?;
            let is_last = at + 1 == numbers.len() && !is_whole;
            if is_last && self.rows + at as u64 > 0 && self.is_cut(&cells) {
                self.notes.push(format!(
                    "line {line} is cut off by the end of the file and left out"
                ));
                break;
            }
            self.row(line, &cells, &mut columns)?;
            let last = cells.get(self.shape.width - 1).map_or(0, str::len);
            self.shortest = self.shortest.min(last);
        }
        self.first_row = self.rows;
        self.rows += columns.first().map_or(0, Vec::len) as u64;
        self.numbers = numbers;
        Ok(columns.into_iter().map(Values::Floats).collect())
    }

    fn notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }
}

fn shortened(cell: &str) -> String {
    match cell.char_indices().nth(24) {
        Some((end, _)) => format!("{}...", &cell[..end]),
        None => cell.to_owned(),
    }
}

#[cfg(test)]
mod tests;
