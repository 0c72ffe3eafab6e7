//! The Allan table at octaves of the averaging time.

use inm_allan::Statistic;

use super::{Cell, Row};
use crate::bins::point;
use crate::bins::record::Record;
use crate::bins::taus::Taus;
use crate::signal::Signal;

/// A row for each averaging time that the record has, shortest first.
pub fn table(signal: &Signal, record: &Record) -> Vec<Row> {
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
