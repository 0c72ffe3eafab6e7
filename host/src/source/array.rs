//! An array file as a [`Source`]: chooses the columns, places the rows in time, cuts the part
//! that is wanted and marks what is no number.

use std::collections::VecDeque;
use std::ops::Range;

use super::options::{ArrayOptions, Selector};
use super::stamps::{self, Stamps};
use super::table::Table;
use super::{Block, Chunk, Column, Gap, Source, SourceError, Values};
use crate::signal::{Axis, Signal, Unit};

/// Rows read at a time: some hundred kilobytes, whatever the length of the file.
const ROWS: usize = 8192;

/// Rows that are looked at for the sampling rate where only stamps give it.
const ROWS_FOR_RATE: usize = 65_536;

/// An array file with what was said about it.
pub struct ArraySource {
    signal: Signal,
    table: Box<dyn Table>,
    /// Stamps of the rows, if the last selected column is the time.
    stamps: Option<Stamps>,
    /// Batches read ahead to find the rate.
    ahead: VecDeque<Vec<Values>>,
    /// Rows read so far.
    row: u64,
    /// Samples to deliver, as indices since the start of the file.
    part: Range<u64>,
    /// Index that the next sample should have; `None` before the first.
    expected: Option<u64>,
    ready: VecDeque<Chunk>,
}

impl ArraySource {
    /// Puts the user's options onto a table.
    ///
    /// # Errors
    /// If the rate is not known, a column does not exist, integers come without unit or
    /// scale, or the part asked for lies outside of the file.
    pub fn new(mut table: Box<dyn Table>, options: &ArrayOptions) -> Result<Self, SourceError> {
        let name = table.name().to_owned();
        let bad = |message: String, remedy: &str| SourceError {
            place: name.clone(),
            message,
            remedy: remedy.to_owned(),
        };
        let time = options
            .time
            .as_ref()
            .map(|time| find(&*table, time))
            .transpose()?;
        let mut columns = if options.columns.is_empty() {
            (0..table.width())
                .filter(|&column| Some(column) != time)
                .collect::<Vec<_>>()
        } else {
            let columns = options.columns.iter();
            columns
                .map(|column| find(&*table, column))
                .collect::<Result<_, _>>()?
        };
        if columns.is_empty() {
            return Err(bad(
                "no column is left for an axis".into(),
                "choose one with --columns",
            ));
        }
        let axes = axes(&*table, &columns, options)?;
        columns.extend(time);
        table.select(&columns)?;
        let mut ahead = VecDeque::new();
        let rate_hz = match (options.rate_hz, time) {
            (Some(rate_hz), _) if rate_hz.is_finite() && rate_hz > 0.0 => rate_hz,
            (Some(rate_hz), _) => {
                return Err(bad(
                    format!("a rate of {rate_hz} samples a second"),
                    "--rate takes a number above zero",
                ));
            }
            (None, Some(_)) => rate_from_stamps(&mut *table, &mut ahead)?,
            (None, None) => {
                return Err(bad(
                    "the file does not say how fast it was sampled".into(),
                    "give --rate HZ, or --time COLUMN if a column holds the time in seconds",
                ));
            }
        };
        let part = part(
            &name,
            table.rows().filter(|_| time.is_none()),
            rate_hz,
            options,
        )?;
        Ok(Self {
            signal: Signal {
                name,
                rate_hz,
                axes,
                start: None,
            },
            table,
            stamps: time.map(|_| Stamps::new(1.0 / rate_hz)),
            ahead,
            row: 0,
            part,
            expected: None,
            ready: VecDeque::new(),
        })
    }

    /// Reads a batch and turns it into chunks; false at the end.
    fn refill(&mut self) -> Result<bool, SourceError> {
        let mut columns = match self.ahead.pop_front() {
            Some(columns) => columns,
            None => self.table.read(ROWS)?,
        };
        let rows = columns.first().map_or(0, Values::len) as u64;
        if rows == 0 {
            return Ok(false);
        }
        let first_row = self.row;
        self.row += rows;
        // Runs of rows without a gap: first row in the batch, index of its sample.
        let mut runs = vec![];
        match &mut self.stamps {
            None => runs.push((0, first_row)),
            Some(stamps) => {
                let times = columns.pop().map(floats).unwrap_or_default();
                let mut next = None;
                for (row, &time_s) in times.iter().enumerate() {
                    let index = stamps
                        .place(time_s)
                        .map_err(|error| error.at(self.table.place(first_row + row as u64)))?;
                    if next != Some(index) {
                        runs.push((row, index));
                    }
                    next = Some(index + 1);
                }
            }
        }
        let ends = runs.iter().skip(1).map(|run| run.0).chain([rows as usize]);
        for (&(from, index), to) in runs.iter().zip(ends) {
            self.deliver(&columns, from..to, index);
        }
        Ok(runs.last().is_some_and(|&(_, index)| index < self.part.end))
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
        let rows = self.table.rows().filter(|_| self.stamps.is_none())?;
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
                return Ok(None);
            }
        }
        Ok(self.ready.pop_front())
    }
}

/// The number of the column that `selector` means.
fn find(table: &dyn Table, selector: &Selector) -> Result<usize, SourceError> {
    let by_name = table.header().and_then(|header| {
        let wanted = selector.to_string();
        header.iter().position(|name| *name == wanted)
    });
    let by_number = match selector {
        Selector::Number(number) if *number < table.width() => Some(*number),
        _ => None,
    };
    by_name.or(by_number).ok_or_else(|| SourceError {
        place: table.name().to_owned(),
        message: format!("there is no column `{selector}`"),
        remedy: match table.header() {
            Some(names) => format!("the columns are {}", names.join(", ")),
            None if table.width() == 1 => "the only column is 0".into(),
            None => format!("the columns are 0 to {}", table.width() - 1),
        },
    })
}

fn axes(
    table: &dyn Table,
    columns: &[usize],
    options: &ArrayOptions,
) -> Result<Vec<Axis>, SourceError> {
    let bad = |message: String, remedy: &str| SourceError {
        place: table.name().to_owned(),
        message,
        remedy: remedy.to_owned(),
    };
    if table.is_integer() && options.unit.is_none() && options.scales.is_empty() {
        return Err(bad(
            "the data are integers and nothing says what a count is worth".into(),
            "give --scale UNIT_PER_COUNT and --unit, or --unit counts",
        ));
    }
    if options.scales.len() > 1 && options.scales.len() != columns.len() {
        return Err(bad(
            format!(
                "{} scales for {} columns",
                options.scales.len(),
                columns.len()
            ),
            "give --scale once, or once for each column",
        ));
    }
    if let Some(scale) = options.scales.iter().find(|scale| !scale.is_normal()) {
        return Err(bad(
            format!("a scale of {scale}"),
            "a scale is a number other than zero",
        ));
    }
    let scale = |axis: usize| {
        options
            .scales
            .get(axis)
            .or(options.scales.first())
            .copied()
            .unwrap_or(1.0)
    };
    let name = |column: usize| match table.header() {
        Some(names) if !names[column].is_empty() => names[column].clone(),
        _ => column.to_string(),
    };
    let axis = |(axis, &column): (usize, &usize)| Axis {
        name: name(column),
        unit: options.unit.unwrap_or(Unit::MetrePerSecondSquared),
        scale: scale(axis),
        zero: 0.0,
        chain: options.chain.clone(),
    };
    Ok(columns.iter().enumerate().map(axis).collect())
}

/// Reads ahead and takes the rate from the stamps, which are the last selected column.
fn rate_from_stamps(
    table: &mut dyn Table,
    ahead: &mut VecDeque<Vec<Values>>,
) -> Result<f64, SourceError> {
    let mut times = Vec::new();
    while times.len() < ROWS_FOR_RATE {
        let batch = table.read(ROWS)?;
        let Some(stamps) = batch.last().filter(|stamps| !stamps.is_empty()) else {
            break;
        };
        times.extend(floats(stamps.clone()));
        ahead.push_back(batch);
    }
    let period_s = stamps::period_s(&times).map_err(|message| SourceError {
        place: table.name().to_owned(),
        message,
        remedy: "give --rate HZ together with --time, or in its place".into(),
    })?;
    Ok(1.0 / period_s)
}

/// The samples between `--from` and `--to`.
fn part(
    name: &str,
    rows: Option<u64>,
    rate_hz: f64,
    options: &ArrayOptions,
) -> Result<Range<u64>, SourceError> {
    let index = |seconds: Option<f64>| seconds.map(|seconds| (seconds * rate_hz).round());
    let from = index(options.from_s).unwrap_or(0.0);
    let to = index(options.to_s).unwrap_or(f64::INFINITY);
    let limit = rows.map_or(f64::INFINITY, |rows| rows as f64);
    // Written so that NaN is refused as well.
    let sound = from >= 0.0 && from < to && from < limit;
    if !sound {
        return Err(SourceError {
            place: name.to_owned(),
            message: "no sample lies between --from and --to".into(),
            remedy: match rows {
                Some(_) => format!("the file covers 0 to {} s", limit / rate_hz),
                None => "--from comes before --to, both in seconds from the start".into(),
            },
        });
    }
    // Saturates where there is no end.
    Ok(from as u64..to as u64)
}

fn floats(values: Values) -> Vec<f64> {
    match values {
        Values::Floats(floats) => floats,
        Values::Codes(codes) => codes.into_iter().map(f64::from).collect(),
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
mod tests {
    use super::super::text::TextTable;
    use super::*;

    fn open(text: &'static str, options: &ArrayOptions) -> Result<ArraySource, SourceError> {
        ArraySource::new(
            Box::new(TextTable::open("t.csv", Box::new(text.as_bytes()))?),
            options,
        )
    }

    fn drain(mut source: ArraySource) -> Result<Vec<Chunk>, SourceError> {
        let mut chunks = Vec::new();
        while let Some(chunk) = source.next_chunk()? {
            chunks.push(chunk);
        }
        Ok(chunks)
    }

    #[test]
    fn stamps_give_rate_and_gaps() {
        let options = ArrayOptions {
            time: Some(Selector::Name("t".into())),
            ..Default::default()
        };
        let regular = open("t,x\n0,1\n0.5,2\n1,3\n", &options).expect("good file");
        assert_eq!(regular.signal().rate_hz, 2.0);
        let options = ArrayOptions {
            rate_hz: Some(2.0),
            ..options
        };
        let source = open("t,x\n0,1\n0.5,2\n1,3\n2.5,4\n", &options).expect("good file");
        assert_eq!(source.signal().axes[0].name, "x");
        let chunks = drain(source).expect("good stamps");
        let [Chunk::Samples(one), Chunk::Gap(gap), Chunk::Samples(two)] = &chunks[..] else {
            panic!("{chunks:?}");
        };
        assert_eq!((one.first, one.len(), two.first, two.len()), (0, 3, 5, 1));
        assert_eq!((gap.from, gap.to), (3, Some(5)));

        let source = open("t,x\n0,1\n0.5,2\n1,3\n1,4\n", &options).expect("good start");
        let error = drain(source).expect_err("time stands still");
        assert!(
            error
                .to_string()
                .starts_with("t.csv:5: time 1 s does not lie after"),
            "{error}"
        );
    }

    #[test]
    fn cuts_and_marks() {
        let options = ArrayOptions {
            rate_hz: Some(10.0),
            from_s: Some(0.1),
            to_s: Some(0.5),
            ..Default::default()
        };
        let source = open("0\n1\nnan\nnan\n4\n5\n", &options).expect("good file");
        let chunks = drain(source).expect("good rows");
        let [Chunk::Samples(block)] = &chunks[..] else {
            panic!("{chunks:?}")
        };
        assert_eq!((block.first, block.len()), (1, 4));
        assert_eq!(block.columns[0].invalid, [1..3]);
    }

    #[test]
    fn refuses_what_it_cannot_know() {
        let rate = ArrayOptions {
            rate_hz: Some(1.0),
            ..Default::default()
        };
        let check = |options: &ArrayOptions, message: &str| {
            let error = open("1 2\n3 4\n", options).map(|_| ()).expect_err(message);
            assert!(error.to_string().contains(message), "{error}");
        };
        check(&ArrayOptions::default(), "give --rate HZ");
        check(
            &ArrayOptions {
                columns: vec![Selector::Number(2)],
                ..rate.clone()
            },
            "there is no column `2`; the columns are 0 to 1",
        );
        check(
            &ArrayOptions {
                scales: vec![1.0; 3],
                ..rate.clone()
            },
            "3 scales for 2 columns",
        );
        check(
            &ArrayOptions {
                scales: vec![0.0],
                ..rate.clone()
            },
            "a scale of 0",
        );
        check(
            &ArrayOptions {
                from_s: Some(3.0),
                to_s: Some(2.0),
                ..rate
            },
            "--from and --to",
        );
    }
}
