//! An array file as a [`Source`]: chooses the columns, places the rows in time, cuts the part
//! that is wanted and marks what is no number.

mod asked;
mod sizes;

use std::collections::VecDeque;
use std::ops::Range;

use self::asked::{part, rate};
use self::sizes::Sizes;
use super::options::ArrayOptions;
use super::stamps::{self, Stamps};
use super::table::Table;
use super::{Block, Chunk, Column, Gap, Source, SourceError, Values, columns};
use crate::signal::{LARGEST, Signal};

/// Rows read at a time: some hundred kilobytes, whatever the length of the file.
const ROWS: usize = 8192;

/// Opens a table anew.
pub type OpenTable<'a> = &'a dyn Fn() -> Result<Box<dyn Table>, SourceError>;

/// An array file with what was said about it.
pub struct ArraySource {
    signal: Signal,
    table: Box<dyn Table>,
    /// Where the rows lie, if a column holds the time.
    stamps: Option<Stamps>,
    /// The first batch, read ahead to be looked at.
    ahead: Option<Vec<Values>>,
    /// Rows read so far.
    row: u64,
    /// Samples to deliver, as indices since the start of the file.
    part: Range<u64>,
    /// Index that the next sample should have; `None` before the first.
    expected: Option<u64>,
    ready: VecDeque<Chunk>,
    /// Infinite numbers among the samples so far, and where the first one stands.
    infinite: (u64, Option<String>),
    sizes: Sizes,
}

impl ArraySource {
    /// Puts the user's options onto a table, which is opened twice if a column holds the time: where a
    /// row lies is known only from all of them.
    ///
    /// # Errors
    /// If the rate or a unit is not known, a column does not exist or is no axis, the time stamps
    /// cannot be followed, or the part asked for lies outside of the file.
    pub fn new(open: OpenTable<'_>, options: &ArrayOptions) -> Result<Self, SourceError> {
        let mut table = open()?;
        let time = options.time.as_ref();
        let column = time.map(|time| columns::find(&*table, &time.column));
        let column = column.transpose()?;
        let chosen = columns::choose(&*table, column, options)?;
        table.select(&chosen)?;
        let ahead = table.read(ROWS)?;
        if options.columns.is_empty() {
            columns::check(&*table, &chosen, &ahead)?;
        }
        let (axes, mut notes) = columns::axes(&*table, &chosen, options)?;
        let stamps = match (time, column) {
            (Some(time), Some(column)) => {
                let mut stamps = stamps::read(open()?, column, time.unit, options)?;
                notes.append(&mut stamps.notes);
                Some(stamps)
            }
            _ => None,
        };
        let rate_hz = match &stamps {
            Some(stamps) => stamps.rate_hz,
            None => rate(table.name(), options)?,
        };
        let rows = stamps.as_ref().map(|stamps| stamps.end);
        let part = part(table.name(), rows.or(table.rows()), rate_hz, options)?;
        Ok(Self {
            signal: Signal {
                name: table.name().to_owned(),
                rate_hz,
                axes,
                start: None,
            },
            table,
            stamps,
            ahead: Some(ahead),
            row: 0,
            part,
            expected: None,
            ready: notes.into_iter().map(Chunk::News).collect(),
            infinite: (0, None),
            sizes: Sizes::default(),
        })
    }

    /// Reads a batch and turns it into chunks; false at the end.
    fn refill(&mut self) -> Result<bool, SourceError> {
        let columns = match self.ahead.take() {
            Some(columns) => columns,
            None => self.table.read(ROWS)?,
        };
        self.look(&columns)?;
        let read = columns.first().map_or(0, Values::len) as u64;
        // A file that is still written to has more rows by now than were placed.
        let placed = self.stamps.as_ref().map_or(u64::MAX, |stamps| stamps.rows);
        let rows = self.row..placed.min(self.row + read);
        if rows.is_empty() {
            let notes = self.table.notes().into_iter().map(Chunk::News);
            self.ready.extend(notes);
            let infinite = self.infinite_words().map(Chunk::News);
            self.ready.extend(infinite);
            return Ok(false);
        }
        self.row = rows.end;
        let mut last = 0;
        for (run, index) in self.runs(&rows) {
            let from = (run.start - rows.start) as usize;
            self.deliver(&columns, from..(run.end - rows.start) as usize, index);
            last = index;
        }
        Ok(last < self.part.end)
    }

    /// Counts infinite numbers, and refuses those whose squares would overflow: no quantity is as
    /// large, and one of them among others would hide them all.
    fn look(&mut self, columns: &[Values]) -> Result<(), SourceError> {
        for (axis, values) in self.signal.axes.iter().zip(columns) {
            let Values::Floats(floats) = values else {
                continue;
            };
            let infinite = |value: &f64| value.is_infinite();
            if let Some(at) = floats.iter().position(infinite) {
                self.infinite.0 +=
                    floats[at..].iter().filter(|value| infinite(value)).count() as u64;
                let place = || {
                    let place = self.table.place(self.row + at as u64);
                    format!("{place}, column {}", axis.name)
                };
                self.infinite.1.get_or_insert_with(place);
            }
            let too_large = |value: &f64| value.is_finite() && value.abs() > LARGEST;
            if let Some(at) = floats.iter().position(too_large) {
                return Err(SourceError {
                    place: self.table.place(self.row + at as u64),
                    message: format!(
                        "{:e} in column {}; expected numbers up to {LARGEST:e}",
                        floats[at], axis.name
                    ),
                    remedy: "correct the cell, or mark the sample as missing (nan)".into(),
                });
            }
        }
        Ok(())
    }

    /// What there is to say of infinite numbers at the end, if there were any.
    fn infinite_words(&mut self) -> Option<String> {
        let (count, first) = std::mem::take(&mut self.infinite);
        first
            .map(|first| format!("{count} infinite numbers count as missing, the first in {first}"))
    }

    /// The parts of `rows` without a gap within, each with the index of its first.
    fn runs(&self, rows: &Range<u64>) -> Vec<(Range<u64>, u64)> {
        let Some(stamps) = &self.stamps else {
            return vec![(rows.clone(), rows.start)];
        };
        let begun = stamps.runs.partition_point(|&(row, _)| row <= rows.start);
        let mut runs = Vec::new();
        for (at, &(row, index)) in stamps.runs.iter().enumerate().skip(begun.saturating_sub(1)) {
            if row >= rows.end {
                break;
            }
            let next = stamps.runs.get(at + 1).map_or(rows.end, |&(row, _)| row);
            let first = row.max(rows.start);
            runs.push((first..next.min(rows.end), index + (first - row)));
        }
        runs
    }

    /// Queues the wanted part of the rows `rows` of a batch, whose first sample is `index`.
    fn deliver(&mut self, columns: &[Values], rows: Range<usize>, index: u64) {
        let end = (index + rows.len() as u64).min(self.part.end);
        let first = index.max(self.part.start);
        if first >= end {
            return;
        }
        if let Some(expected) = self.expected.filter(|&expected| expected < first) {
            self.ready.push_back(Chunk::Gap(Gap {
                from: expected,
                to: Some(first),
                cause: "the time stamps jump".into(),
            }));
        }
        let from = rows.start + (first - index) as usize;
        let to = rows.start + (end - index) as usize;
        self.sizes.take(columns, &(from..to));
        let columns = columns
            .iter()
            .map(|values| column(values, from..to))
            .collect();
        self.ready
            .push_back(Chunk::Samples(Block { first, columns }));
        self.expected = Some(end);
    }
}

impl Source for ArraySource {
    fn signal(&self) -> &Signal {
        &self.signal
    }

    fn expected_len(&self) -> Option<u64> {
        let rows = match &self.stamps {
            Some(stamps) => stamps.end,
            None => self.table.rows()?,
        };
        Some(self.part.end.min(rows).saturating_sub(self.part.start))
    }

    fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError> {
        while self.ready.is_empty() {
            let more = self.refill()?;
            if !more && self.ready.is_empty() {
                if self.expected.is_none() {
                    return Err(SourceError {
                        place: self.signal.name.clone(),
                        message: "no sample lies in the part that was asked for".into(),
                        remedy: "see --from and --to".into(),
                    });
                }
                self.sizes.check(&self.signal)?;
                return Ok(None);
            }
        }
        Ok(self.ready.pop_front())
    }
}

/// Part of a column, with the runs of it that are no numbers.
fn column(values: &Values, rows: Range<usize>) -> Column {
    match values {
        Values::Codes(codes) => Column {
            values: Values::Codes(codes[rows].to_vec()),
            invalid: Vec::new(),
        },
        Values::Floats(floats) => {
            let part = floats[rows].to_vec();
            let mut invalid: Vec<Range<usize>> = Vec::new();
            for (at, _) in part
                .iter()
                .enumerate()
                .filter(|(_, value)| !value.is_finite())
            {
                match invalid.last_mut() {
                    Some(run) if run.end == at => run.end = at + 1,
                    _ => invalid.push(at..at + 1),
                }
            }
            Column {
                values: Values::Floats(part),
                invalid,
            }
        }
    }
}

#[cfg(test)]
mod tests;
