//! Which lines of a text file are rows of numbers, how wide they are, and how their columns are named.

use super::super::options::Decimal;
use super::super::{SourceError, header};
use super::cells::{Separator, is_row, is_words};
use super::lines::Line;
use super::way::way;
use crate::plain::is_plain;

/// How a file is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Between cells.
    pub separator: Separator,
    /// Within numbers.
    pub decimal: Decimal,
    /// Cells of a row.
    pub width: usize,
    /// Names of the columns.
    pub names: Option<Vec<String>>,
    /// Number of the line with the first row.
    pub first: u64,
}

impl Shape {
    /// The shape of the file `name` that begins with `lines`.
    ///
    /// # Errors
    /// If it holds no row, or could be read in two ways.
    pub fn of(name: &str, lines: &[Line], decimal: Option<Decimal>) -> Result<Self, SourceError> {
        let texts: Vec<&Line> = lines.iter().filter(|line| line.comment.is_none()).collect();
        let (separator, decimal) = way(name, lines, decimal)?;
        let cells: Vec<Vec<String>> = texts
            .iter()
            .map(|line| separator.cells(&line.text))
            .collect();
        let row = cells.iter().position(|cells| is_row(cells, decimal));
        let words = cells
            .iter()
            .take_while(|cells| is_words(cells, decimal))
            .count();
        // Where no line is a row, the first that is not words will say so.
        let Some(first) = row.or_else(|| (words < cells.len()).then_some(words)) else {
            return Err(SourceError {
                place: name.to_owned(),
                message: "the file holds no row of numbers".into(),
                remedy: "expected one sample a line, one column per axis".into(),
            });
        };
        let width = cells[first].len();
        // A line above that is no words and as wide is a row with a bad cell.
        let bad = |cells: &&Vec<String>| cells.len() == width && !is_words(cells, decimal);
        let first = cells[..first]
            .iter()
            .position(|cells| bad(&cells))
            .unwrap_or(first);
        let mut shape = Self {
            separator,
            decimal,
            width,
            names: names(&cells[..first], decimal),
            first: texts[first].number,
        };
        if shape.names.is_none() {
            let above = |line: &&Line| line.number < shape.first;
            let comment = lines.iter().take_while(above).last();
            let comment = comment.and_then(|line| line.comment.as_ref());
            shape.names = comment.and_then(|text| shape.names_in(text));
        }
        let rows = cells[first..].iter().filter(|cells| cells.len() == width);
        shape.without_the_last_separator(rows);
        shape.check_names(name, texts[..first].last().map(|line| line.number))?;
        Ok(shape)
    }

    /// Names in a comment, as `numpy.savetxt` writes them.
    fn names_in(&self, comment: &str) -> Option<Vec<String>> {
        let cells = self.separator.cells(comment);
        let fits = cells.len() == self.width && is_words(&cells, self.decimal);
        // One word may be anything.
        let says = self.width > 1 || cells.iter().any(|cell| header::unit(cell).is_some());
        (fits && says).then_some(cells)
    }

    /// A separator behind the last cell of every row makes no column.
    fn without_the_last_separator<'a>(&mut self, mut rows: impl Iterator<Item = &'a Vec<String>>) {
        let spare = |names: &Vec<String>, width| {
            names.len() == width + 1 && names.last().is_some_and(String::is_empty)
        };
        let is_named = |names: &Vec<String>| {
            names.len() == self.width && names.last().is_some_and(|name| !name.is_empty())
        };
        let is_empty = |cells: &Vec<String>| cells.last().is_some_and(String::is_empty);
        if self.width > 1 && !self.names.as_ref().is_some_and(is_named) && rows.all(is_empty) {
            self.width -= 1;
        }
        if let Some(names) = self.names.as_mut().filter(|names| spare(names, self.width)) {
            names.pop();
        }
    }

    fn check_names(&mut self, name: &str, line: Option<u64>) -> Result<(), SourceError> {
        let place = || line.map_or(name.to_owned(), |line| format!("{name}:{line}"));
        // Columns without a name go by their number.
        let is_named = |one: &String| one.is_empty() || is_plain(one);
        if !self.names.iter().flatten().all(is_named) {
            return Err(SourceError {
                place: place(),
                message: "a column's name holds control characters".into(),
                remedy: "name the columns in plain text".into(),
            });
        }
        let Some(names) = self
            .names
            .as_ref()
            .filter(|names| names.len() != self.width)
        else {
            return Ok(());
        };
        if names.len() == 1 {
            // A title, or a remark.
            self.names = None;
            return Ok(());
        }
        Err(SourceError {
            place: place(),
            message: format!("{} names above rows of {} columns", names.len(), self.width),
            remedy: if names.len() * 2 == self.width {
                "if the commas within numbers are decimal, save with another separator between them"
            } else {
                "name every column, or put a # ahead of the line"
            }
            .into(),
        })
    }
}

/// Names above the rows, with the units below them.
fn names(above: &[Vec<String>], decimal: Decimal) -> Option<Vec<String>> {
    let (last, before) = above.split_last()?;
    if !is_words(last, decimal) {
        return None;
    }
    let are_units = last
        .iter()
        .all(|cell| cell.is_empty() || header::is_unit(cell));
    match before.last() {
        Some(names) if are_units && names.len() == last.len() => {
            let both = names
                .iter()
                .zip(last)
                .map(|(name, unit)| match unit.as_str() {
                    "" => name.clone(),
                    unit => format!("{name} [{}]", unit.trim_matches(['(', ')', '[', ']'])),
                });
            Some(both.collect())
        }
        _ => Some(last.clone()),
    }
}
