//! One axis: rounds until nothing is left that has a name, without what gains nothing.

use std::cell::{Cell, OnceCell};
use std::sync::Arc;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::values::CodeFindings;
use crate::diagnosis::held_out::Halves;
use crate::diagnosis::held_out::laws::Ordinates;
use crate::diagnosis::record::samples::AxisSamples;
use crate::diagnosis::rounds::{self, Accepted, Options, Outcome};
use crate::diagnosis::run::{LEAST, Progress, Refused, Step};
use crate::diagnosis::statistic::ramp;
use crate::diagnosis::views::Before;
use crate::fit::likelihood::Fit;
use crate::fit::likelihood::ramp::Ramp;
use crate::signal::Axis;
use crate::source::Values;

/// Effects that may be refused before the rest is taken as it is.
const MOST_REFUSED: usize = 4;

/// An axis whose effects are taken out, and how it came to that.
pub(crate) struct Explained {
    /// What is left, with its model.
    pub axis: AxisState,
    /// Mean of the record, in the unit of the signal.
    pub mean: f64,
    /// Fit of the five terms alone.
    pub base_fit: Fit,
    /// The record before anything was taken out, where views are wanted.
    pub before: Option<Before>,
    /// Its slope, where it has one; unit of the signal a second.
    pub base_slope: f64,
    /// What was found.
    pub outcome: Outcome,
    /// Gain of each effect in log-likelihood on data that it was not fitted to.
    pub nats: Vec<Option<f64>>,
}

/// Explains the record of an axis.
///
/// # Errors
/// [`Refused`] where it holds too little.
pub(crate) fn explain(
    signal: &Axis,
    record: AxisSamples,
    rate_hz: f64,
    options: &Options,
    progress: &Progress<'_>,
) -> Result<Explained, Refused> {
    let declared = matches!(record.raw(), Values::Codes(_)).then_some(signal.scale);
    let (measured, mean) = record.centred(signal.scale);
    let good = measured.iter().filter(|value| value.is_finite()).count();
    if good < LEAST {
        return Err(Refused::TooShort {
            axis: signal.name.clone(),
            samples: good,
        });
    }
    let mean = mean - signal.zero * signal.scale;
    let measured = Arc::new(measured);
    let refusal = || refusal(signal, &measured);
    let begin = || AxisState::new(Arc::clone(&measured), rate_hz, signal.chain.as_ref());
    let (values, mut first) = rayon::join(
        || CodeFindings::new(declared, options.level(), &measured, mean),
        begin,
    );
    let latest = Cell::new(None);
    let found = |effect| {
        latest.set(Some(effect));
        progress(&signal.name, Step::Found(effect));
    };
    let mut refused: Vec<&'static str> = Vec::new();
    let mut begun: Option<(Option<Before>, f64)> = None;
    loop {
        let mut axis = first.take().or_else(begin).ok_or_else(refusal)?;
        let base_fit = axis.fit.clone();
        let look = || {
            let begun = begun.take();
            let begun =
                begun.unwrap_or_else(|| (Before::new(&axis, options), slope(ramp::ramp(&axis))));
            axis.powers();
            begun
        };
        let (_, (before, base_slope)) = rayon::join(|| axis.lines(options.level()), look);
        latest.set(None);
        let Some(outcome) = rounds::run(&mut axis, options, &values, &refused, &found) else {
            // What was taken out last left nothing that can be fitted: the rest is told without it.
            let spoils = latest.take().filter(|_| refused.len() <= MOST_REFUSED);
            refused.push(spoils.ok_or_else(|| Refused::Unfitted {
                axis: signal.name.clone(),
            })?);
            begun = Some((before, base_slope));
            continue;
        };
        let nats = held_out(&axis, &outcome.accepted);
        // What gains nothing on data that it was not fitted to is no effect.
        let losers = outcome.accepted.iter().zip(&nats);
        let losers: Vec<&'static str> = losers
            .filter(|(_, nats)| nats.is_some_and(|nats| nats <= 0.0))
            .map(|(one, _)| one.effect)
            .collect();
        if losers.is_empty() || refused.len() > MOST_REFUSED {
            return Ok(Explained {
                axis,
                mean,
                base_fit,
                before,
                base_slope,
                outcome,
                nats,
            });
        }
        refused.extend(losers);
        begun = Some((before, base_slope));
    }
}

/// Why there is no spectrum of these samples.
fn refusal(signal: &Axis, measured: &[f64]) -> Refused {
    let axis = signal.name.clone();
    let mut there = measured.iter().filter(|value| value.is_finite());
    let first = there.next();
    if there.all(|value| Some(value) == first) {
        Refused::Constant { axis }
    } else {
        Refused::Broken { axis }
    }
}

/// Slope of a ramp that was told from none.
pub(crate) fn slope(ramp: Option<Ramp>) -> f64 {
    let told = ramp.filter(Ramp::identified);
    told.map_or(0.0, |ramp| ramp.per_s.abs())
}

/// Gain of each effect on data that it was not fitted to. The halves are made where they are needed.
fn held_out(axis: &AxisState, accepted: &[Accepted]) -> Vec<Option<f64>> {
    let halves = OnceCell::new();
    let ordinates = OnceCell::new();
    let nats = accepted.iter().map(|one| {
        if one.nats.is_some() || one.changes_nothing() {
            return one.nats;
        }
        match one.law {
            Some(law) => {
                let ordinates = ordinates.get_or_init(|| Ordinates::new(axis));
                ordinates.as_ref()?.nats(law)
            }
            None => {
                let halves = halves.get_or_init(|| Halves::new(axis));
                halves.as_ref()?.nats(one)
            }
        }
    });
    nats.collect()
}
