//! The coefficients of the likelihood fit while the record grows.

use std::time::{Duration, Instant};

use super::{Noise, NoiseRow};
use crate::bins::record::{AxisRecord, Record};
use crate::fit::design::Design;
use crate::fit::likelihood::terms::{self, LikelihoodFit, LikelihoodValue};
use crate::model::Coefficient;
use crate::signal::{Axis, Signal};
use crate::spectrum::{Estimate, Settings};

/// Between two fits at least.
const PERIOD: Duration = Duration::from_secs(2);

/// Pause after a fit, as a multiple of the time that it took: receiving goes first.
const PAUSE: u32 = 20;

/// The last fit of every axis.
#[derive(Default)]
pub struct Noises {
    /// A row for each coefficient.
    pub rows: Vec<NoiseRow>,
    due: Option<Instant>,
    /// The fits are those of the whole recording.
    done: bool,
}

impl Noises {
    /// Fits every axis anew, if it is time for that, or once more when the recording has come to its `last`
    /// sample.
    pub fn keep_up(&mut self, signal: &Signal, record: &Record, last: bool) {
        let due = last || self.due.is_none_or(|due| Instant::now() >= due);
        if due && !self.done {
            self.fit(signal, record);
            self.done = last;
        }
    }

    fn fit(&mut self, signal: &Signal, record: &Record) {
        let begin = Instant::now();
        let fits: Vec<Option<LikelihoodFit>> = signal
            .axes
            .iter()
            .zip(record.axes())
            .map(|(axis, record)| fit(signal.rate_hz, axis, record))
            .collect();
        let durations_s = record
            .axes()
            .iter()
            .map(|axis| axis.cascade().samples() as f64 / signal.rate_hz);
        let fits: Vec<(f64, Option<LikelihoodFit>)> = durations_s.zip(fits).collect();
        let cell = |one: Coefficient, (duration_s, fit): &(f64, Option<LikelihoodFit>)| {
            let value = fit.as_ref()?.coefficients.get(one);
            Noise::of(value, *duration_s)
        };
        self.rows = Coefficient::ALL
            .into_iter()
            .rev()
            .map(|one| NoiseRow {
                symbol: one.symbol(),
                cells: fits.iter().map(|fit| cell(one, fit)).collect(),
            })
            .collect();
        self.due = Some(begin + PERIOD.max(PAUSE * begin.elapsed()));
    }
}

fn fit(rate_hz: f64, axis: &Axis, record: &AxisRecord) -> Option<LikelihoodFit> {
    let cascade = record.cascade();
    let estimate = Estimate::new(cascade, rate_hz, &Settings::default());
    let design = Design::new(rate_hz, axis.chain.as_ref());
    terms::fit(cascade, &estimate, axis.scale, &design)
}

impl Noise {
    /// What a fit to a record of `duration_s` seconds says of a coefficient; `None` where it sets not even a
    /// bound.
    pub fn of(value: &LikelihoodValue, duration_s: f64) -> Option<Self> {
        match (value.value, value.hi) {
            (Some(best), Some(hi)) => Some(Self::Value(best, 0.5 * (hi - value.lo) / best)),
            _ => value.upper.map(|bound| Self::Below {
                bound,
                more_s: value
                    .record_longer_by
                    .map(|factor| (factor - 1.0) * duration_s),
            }),
        }
    }
}
