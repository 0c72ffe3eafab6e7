//! Runs a recording to its end while showing how it goes.

use std::collections::VecDeque;

use inm_allan::Statistic;

use super::noise::Noises;
use super::{Cell, Observed, Row, Screen};
use crate::bins::point;
use crate::bins::record::Record;
use crate::bins::taus::Taus;
use crate::source::{Chunk, SourceError};

/// News that stay on the screen.
const NEWS: usize = 4;

/// Runs `source` to its end: every chunk goes to `record`, if there is one, and `screen` shows
/// the state now and then.
///
/// # Errors
/// What ends the source early; `record` holds everything up to there.
pub fn watch(
    source: &mut dyn Observed,
    mut record: Option<&mut Record>,
    screen: &mut Screen,
) -> Result<(), SourceError> {
    let mut news = VecDeque::new();
    let mut noise = Noises::default();
    let result = loop {
        let chunk = match source.next_chunk() {
            Ok(Some(chunk)) => chunk,
            Ok(None) => break Ok(()),
            Err(error) => break Err(error),
        };
        match &chunk {
            Chunk::Samples(_) => {}
            Chunk::Gap(gap) => note(
                &mut news,
                format!("gap after sample {}: {}", gap.from, gap.cause),
            ),
            Chunk::News(text) => note(&mut news, text.clone()),
        }
        if let Some(record) = &mut record {
            record.push(chunk);
        }
        if screen.is_due() {
            if let Some(record) = &record
                && noise.is_due()
            {
                noise.fit(source, record);
            }
            show(source, record.as_deref(), &news, &noise, screen);
        }
    };
    if let Some(record) = &record {
        noise.fit(source, record);
    }
    show(source, record.as_deref(), &news, &noise, screen);
    result
}

fn note(news: &mut VecDeque<String>, text: String) {
    if news.len() == NEWS {
        news.pop_front();
    }
    news.push_back(text);
}

fn show(
    source: &dyn Observed,
    record: Option<&Record>,
    news: &VecDeque<String>,
    noise: &Noises,
    screen: &mut Screen,
) {
    let mut snapshot = source.snapshot();
    snapshot.news = news.iter().cloned().collect();
    let axes = &source.signal().axes;
    snapshot.axes = axes
        .iter()
        .map(|axis| format!("{}, {}", axis.name, axis.unit))
        .collect();
    if let Some(record) = record {
        snapshot.table = table(source, record);
        snapshot.noise.clone_from(&noise.rows);
    }
    // A terminal that went away is no reason to stop a recording.
    let _ = screen.show(&snapshot.render());
}

/// The Allan table at octaves of the averaging time.
fn table(source: &dyn Observed, record: &Record) -> Vec<Row> {
    let signal = source.signal();
    let mut rows: Vec<Row> = Vec::new();
    let count = signal.axes.len();
    for (axis, (description, record)) in signal.axes.iter().zip(record.axes()).enumerate() {
        let factors = Taus::Octave.factors(record.count() / 2);
        let estimates = record.estimates(Statistic::Allan, &factors);
        let points = point::points(
            Statistic::Allan,
            &estimates,
            signal.rate_hz,
            description.scale,
        );
        for point in points {
            let cell = Cell {
                adev: point.deviation(),
                relative: 0.5 * (point.hi - point.lo) / point.deviation(),
            };
            let row = match rows.iter().position(|row| row.tau_s == point.tau_s) {
                Some(row) => row,
                None => {
                    rows.push(Row {
                        tau_s: point.tau_s,
                        cells: vec![None; count],
                    });
                    rows.len() - 1
                }
            };
            rows[row].cells[axis] = Some(cell);
        }
    }
    rows.sort_by(|a, b| a.tau_s.total_cmp(&b.tau_s));
    rows
}
