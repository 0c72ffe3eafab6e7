//! Comma-separated, semicolon-separated or whitespace text as a table.
//!
//! An optional header line names the columns; `#` starts a comment; an empty cell of separated
//! text and `nan` in any spelling stand for a missing value.

use std::io::BufRead;

use super::table::Table;
use super::{SourceError, Values};

/// Longest line that is believed, bytes. A binary file without line ends stops here.
const LONGEST_LINE: usize = 1 << 16;

/// An open text file.
pub struct TextTable {
    name: String,
    reader: Box<dyn BufRead>,
    separator: Separator,
    header: Option<Vec<String>>,
    width: usize,
    selected: Vec<usize>,
    line: Vec<u8>,
    /// Number of the line in `line`, from 1.
    number: u64,
    /// Whether `line` holds a row that was not returned yet.
    pending: bool,
    /// Lines of the rows that the last reading returned, and the first of those rows.
    lines: Vec<u64>,
    first_row: u64,
    rows: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Separator {
    Mark(char),
    Whitespace,
}

impl TextTable {
    /// Reads as far as the first row of numbers.
    ///
    /// # Errors
    /// If there is none, or the text is not text.
    pub fn open(name: &str, reader: Box<dyn BufRead>) -> Result<Self, SourceError> {
        let mut table = Self {
            name: name.to_owned(),
            reader,
            separator: Separator::Whitespace,
            header: None,
            width: 0,
            selected: Vec::new(),
            line: Vec::new(),
            number: 0,
            pending: false,
            lines: Vec::new(),
            first_row: 0,
            rows: 0,
        };
        let no_rows = |table: &Self| SourceError {
            place: table.name.clone(),
            message: "the file holds no row of numbers".into(),
            remedy: "expected one sample a line, one column per axis".into(),
        };
        if !table.advance()? {
            return Err(no_rows(&table));
        }
        table.separator = separator_of(&table.text()?);
        let first: Vec<String> = cells(&table.text()?, table.separator)
            .map(|(_, cell)| cell.to_owned())
            .collect();
        table.width = first.len();
        if first.iter().all(|cell| number(cell).is_none()) {
            table.header = Some(first.iter().map(|cell| unquoted(cell).to_owned()).collect());
            if !table.advance()? {
                return Err(no_rows(&table));
            }
        }
        table.pending = true;
        table.selected = (0..table.width).collect();
        Ok(table)
    }

    fn place_at(&self, line: u64, column: Option<usize>) -> String {
        match column {
            Some(column) => format!("{}:{line}:{column}", self.name),
            None => format!("{}:{line}", self.name),
        }
    }

    /// Reads the next line with something on it; false at the end.
    fn advance(&mut self) -> Result<bool, SourceError> {
        loop {
            self.line.clear();
            let mut limited = std::io::Read::take(&mut self.reader, LONGEST_LINE as u64);
            let length =
                limited
                    .read_until(b'\n', &mut self.line)
                    .map_err(|error| SourceError {
                        place: format!("{}:{}", self.name, self.number + 1),
                        message: format!("cannot be read: {error}"),
                        remedy: String::new(),
                    })?;
            if length == 0 {
                return Ok(false);
            }
            self.number += 1;
            if length == LONGEST_LINE {
                return Err(SourceError {
                    place: self.place_at(self.number, None),
                    message: format!("a line of more than {LONGEST_LINE} bytes"),
                    remedy: "expected one sample a line, one column per axis".into(),
                });
            }
            if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                self.line.drain(..3);
            }
            if let Some(comment) = self.line.iter().position(|&byte| byte == b'#') {
                self.line.truncate(comment);
            }
            while self.line.last().is_some_and(u8::is_ascii_whitespace) {
                self.line.pop();
            }
            if !self.line.is_empty() {
                return Ok(true);
            }
        }
    }

    fn text(&self) -> Result<String, SourceError> {
        self.str().map(str::to_owned)
    }

    fn str(&self) -> Result<&str, SourceError> {
        std::str::from_utf8(&self.line).map_err(|error| SourceError {
            place: self.place_at(self.number, Some(error.valid_up_to() + 1)),
            message: "this is not text".into(),
            remedy: "array files are .npy, or text with one sample a line".into(),
        })
    }

    /// Adds the row in `line` to `columns`.
    fn row(&self, columns: &mut [Vec<f64>], every: &mut Vec<f64>) -> Result<(), SourceError> {
        every.clear();
        for (at, cell) in cells(self.str()?, self.separator) {
            every.push(number(cell).ok_or_else(|| SourceError {
                place: self.place_at(self.number, Some(at + 1)),
                message: format!("`{}` where a number was expected", shortened(cell)),
                remedy:
                    "correct the cell, or leave it empty (`nan`) to mark a missing sample".into(),
            })?);
        }
        if every.len() != self.width {
            return Err(SourceError {
                place: self.place_at(self.number, None),
                message: format!(
                    "{} columns, where the lines before have {}",
                    every.len(),
                    self.width
                ),
                remedy: "complete the line, or delete it".into(),
            });
        }
        for (values, &column) in columns.iter_mut().zip(&self.selected) {
            values.push(every[column]);
        }
        Ok(())
    }
}

impl Table for TextTable {
    fn name(&self) -> &str {
        &self.name
    }

    fn header(&self) -> Option<&[String]> {
        self.header.as_deref()
    }

    fn width(&self) -> usize {
        self.width
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
            .and_then(|at| self.lines.get(at as usize));
        known.map_or_else(
            || format!("{}: row {row}", self.name),
            |&line| self.place_at(line, None),
        )
    }

    fn select(&mut self, columns: &[usize]) -> Result<(), SourceError> {
        self.selected = columns.to_vec();
        Ok(())
    }

    fn read(&mut self, most: usize) -> Result<Vec<Values>, SourceError> {
        let mut columns = vec![Vec::new(); self.selected.len()];
        let mut every = Vec::with_capacity(self.width);
        self.first_row = self.rows;
        self.lines.clear();
        while self.lines.len() < most && (self.pending || self.advance()?) {
            self.pending = false;
            self.row(&mut columns, &mut every)?;
            self.lines.push(self.number);
            self.rows += 1;
        }
        Ok(columns.into_iter().map(Values::Floats).collect())
    }
}

fn separator_of(line: &str) -> Separator {
    [',', ';']
        .into_iter()
        .find(|&mark| line.contains(mark))
        .map_or(Separator::Whitespace, Separator::Mark)
}

/// The cells of a line with the byte at which each begins.
fn cells(line: &str, separator: Separator) -> impl Iterator<Item = (usize, &str)> {
    let split: Box<dyn Iterator<Item = &str>> = match separator {
        Separator::Mark(mark) => Box::new(line.split(mark).map(str::trim)),
        Separator::Whitespace => Box::new(line.split_whitespace()),
    };
    split.map(move |cell| (cell.as_ptr() as usize - line.as_ptr() as usize, cell))
}

fn unquoted(cell: &str) -> &str {
    cell.trim_matches('"').trim()
}

/// The number in a cell; NaN where it is empty.
fn number(cell: &str) -> Option<f64> {
    let cell = unquoted(cell);
    match cell {
        "" | "NA" | "N/A" => Some(f64::NAN),
        _ => cell.parse().ok(),
    }
}

fn shortened(cell: &str) -> String {
    match cell.char_indices().nth(24) {
        Some((end, _)) => format!("{}...", &cell[..end]),
        None => cell.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &'static str) -> Result<TextTable, SourceError> {
        TextTable::open("t.csv", Box::new(text.as_bytes()))
    }

    fn values(columns: Vec<Values>) -> Vec<Vec<f64>> {
        columns
            .into_iter()
            .map(|column| match column {
                Values::Floats(floats) => floats,
                Values::Codes(codes) => codes.into_iter().map(f64::from).collect(),
            })
            .collect()
    }

    #[test]
    fn header_comments_and_separators() {
        for text in [
            "# made by hand\n\"t\", x ,y\n0,1,2 # first\n\n1,3,-4e1\n",
            "t;x;y\r\n0;1;2\r\n1;3;-40\r\n",
            "\u{feff}t x\ty\n 0 1   2\n1 3 -40",
        ] {
            let mut table = table(text).expect("good text");
            assert_eq!(
                table.header(),
                Some(&["t".to_owned(), "x".into(), "y".into()][..])
            );
            table.select(&[2, 1]).expect("columns exist");
            assert_eq!(values(table.read(1).expect("row")), [[2.0], [1.0]]);
            assert_eq!(values(table.read(9).expect("row")), [[-40.0], [3.0]]);
            assert_eq!(values(table.read(9).expect("end")), [[0.0; 0], []]);
        }
    }

    #[test]
    fn missing_values_and_no_header() {
        let mut table = table("1,2\n,nan\n").expect("good text");
        assert_eq!(table.header(), None);
        let columns = values(table.read(9).expect("rows"));
        assert_eq!(columns[0][0], 1.0);
        assert!(columns[0][1].is_nan() && columns[1][1].is_nan());
    }

    #[test]
    fn errors_name_line_and_column() {
        let read = |text| {
            let mut table = table(text)?;
            table.read(100)
        };
        for (text, message) in [
            ("", "t.csv: the file holds no row of numbers"),
            ("a,b\n", "no row of numbers"),
            ("1,2\n3,x4\n", "t.csv:2:3: `x4` where a number was expected"),
            ("1.5,oops\n", "t.csv:1:5: `oops`"),
            (
                "1 2\n3\n",
                "t.csv:2: 1 columns, where the lines before have 2",
            ),
        ] {
            let error = read(text).expect_err(text);
            assert!(error.to_string().contains(message), "{error}");
        }
    }
}
