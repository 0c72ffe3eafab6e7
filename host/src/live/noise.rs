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
}

impl Noises {
    /// Whether it is time for another fit.
    pub fn is_due(&self) -> bool {
        self.due.is_none_or(|due| Instant::now() >= due)
    }

    /// Fits every axis anew.
    pub fn fit(&mut self, signal: &Signal, record: &Record) {
        let begin = Instant::now();
        let fits: Vec<Option<LikelihoodFit>> = signal
            .axes
            .iter()
            .zip(record.axes())
            .map(|(axis, record)| fit(signal.rate_hz, axis, record))
            .collect();
        let cell = |one: Coefficient, fit: &Option<LikelihoodFit>| {
            fit.as_ref().and_then(|fit| cell(fit.coefficients.get(one)))
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

fn cell(value: &LikelihoodValue) -> Option<Noise> {
    match (value.value, value.hi) {
        (Some(best), Some(hi)) => Some(Noise::Value(best, 0.5 * (hi - value.lo) / best)),
        _ => value.upper.map(Noise::Below),
    }
}
