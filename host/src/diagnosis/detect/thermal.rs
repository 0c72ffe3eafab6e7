//! Thermal: the level follows the temperature, or another column of the same file, behind a lag.

pub mod reading;

use std::sync::Arc;

use rayon::prelude::*;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::axis::profile::{Noise, Profile};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::slow_change::{MeasuredAgain, SlowChange};
use crate::diagnosis::explanation::{Candidate, Change, Explanation};
use crate::diagnosis::record::bridge::block_means;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::matched_filter::{
    Half, Projection, Transform, Transformer, held_out_gain,
};
use crate::diagnosis::statistic::p_value;
use crate::model::follows::{Follows, Leader};
use crate::model::thermal::KIND;

/// What follows the covariate, with its lag in seconds, if it is not known yet.
pub fn find(look: &Look<'_>, noise: Noise) -> Option<(SlowChange, f64)> {
    let column = look.context.covariate?;
    if !look.is_open(KIND) || look.axis.has(KIND) {
        return None;
    }
    follows(look.axis, column, look.level(), noise)
}

/// What is to be done about it.
pub fn proposal((change, lag_s): (SlowChange, f64)) -> Option<Proposal> {
    let Wave::Follows { gain, .. } = change.wave else {
        return None;
    };
    let gain = Value::normal(gain, change.size_sd);
    let lag_s = Value::log_normal(lag_s, change.time_log_sd);
    Some(Proposal::Explain(Box::new(Candidate {
        held_out_nats: Some(change.nats),
        ..Candidate::new(
            Estimate::new(KIND, [gain, lag_s]),
            change.p_value,
            2.0,
            Change::Waves(vec![change.wave]),
        )
    })))
}

/// A settling that is as slow as the lag behind a covariate, which was not at rest as the record began: it
/// belongs to what follows the covariate.
pub fn with_settling_lag(look: &Look<'_>, time_s: f64, settling: &Wave) -> Option<Proposal> {
    /// Largest ratio of the two times: a choice. Lags are first looked for in octaves.
    const ALIKE: f64 = 2.0;
    let place = look.place_of(KIND)?;
    let Explanation {
        effect,
        p_value,
        freedom,
        held_out_nats,
        ..
    } = look.axis.explanations()[place].clone();
    let lag_s = Follows::of_temperature(&effect.plain()).lag_s;
    if (time_s / lag_s).ln().abs() >= ALIKE.ln() {
        return None;
    }
    let mut waves = look.axis.explanations()[place].waves().to_vec();
    waves.push(settling.clone());
    Some(Proposal::Explain(Box::new(Candidate {
        held_out_nats,
        amends: Some(place),
        ..Candidate::new(effect, p_value, freedom, Change::Waves(waves))
    })))
}

/// Whether the level follows `column`, one value a sample, with the lag behind it in seconds.
fn follows(
    axis: &AxisState,
    column: &[f64],
    level: f64,
    noise: Noise,
) -> Option<(SlowChange, f64)> {
    let mut lags = Lags::new(axis, &axis.filled, column);
    let mut best = lags.best()?;
    let mut beside_walk = None;
    if noise == Noise::Anew && lags.p_value(best.0.z()) >= level {
        // Walk and flicker may have been taken for it.
        beside_walk = Some(lags.beside_walk(axis)?);
        best = lags.best()?;
    }
    let (projection, lag) = lags.refined(best)?;
    let of_projection = |z: f64| (z, 0.5 * z * z);
    let (z, gain_nats) = beside_walk.unwrap_or(of_projection(projection.z()));
    let p_value = lags.p_value(z);
    if p_value >= level || !z.is_finite() {
        return None;
    }
    let found = lags.change((projection, lag));
    let change = SlowChange {
        z,
        gain_nats,
        p_value,
        ..found
    };
    Some((change, lag / axis.rate_hz))
}

/// What follows the covariate as it is `known`, measured in `values`, where it is; what it gains there, and what it gains
/// as it is known, nats.
pub fn measured_again(
    look: &Look<'_>,
    values: &[f64],
    known: &Explanation,
) -> Option<MeasuredAgain> {
    let column = look.context.covariate?;
    let [Wave::Follows { gain, .. }] = known.waves() else {
        return None;
    };
    let rate_hz = look.axis.rate_hz;
    let lags = Lags::new(look.axis, values, column);
    let lag_s = Follows::of_temperature(&known.effect.plain()).lag_s;
    let known_gain = lags.at(lag_s * rate_hz).gain(*gain);
    let (projection, lag) = lags.refined(lags.best()?)?;
    let change = lags.change((projection, lag));
    let gain = change.gain_nats;
    Some((proposal((change, lag / rate_hz))?, gain, known_gain))
}

/// A slow record and the column that it may follow.
struct Lags<'a> {
    record: Transform,
    density: Vec<f64>,
    transformer: Transformer,
    column: &'a [f64],
    /// Samples of the column that a sample of the slow record is a mean over.
    factor: usize,
    /// First-order lags that are tried, samples of the column: none, and up to an eighth of its length.
    trials: Vec<f64>,
}

impl<'a> Lags<'a> {
    fn new(axis: &AxisState, values: &[f64], column: &'a [f64]) -> Self {
        /// Shortest lag that is tried, samples of the slow record: a shorter one is as good as none until it is refined.
        const SHORTEST: f64 = 4.0;
        let factor = axis.drift_factor();
        let (record, density) = axis.slow(values, factor);
        let longest = column.len() as f64 / 8.0;
        let lags = std::iter::successors(Some(SHORTEST * factor as f64), |lag| Some(2.0 * lag));
        let lags = lags.take_while(|lag| *lag < longest);
        Self {
            transformer: Transformer::new(record.len()),
            record,
            density,
            trials: std::iter::once(0.0).chain(lags).collect(),
            column,
            factor,
        }
    }

    fn wave(&self, lag: f64) -> Transform {
        // A lag of means is not the mean of what lags: it would be late by half of what they are over.
        let lagged = block_means(&behind(self.column, lag, 0.0), self.factor);
        let mut wave = self.transformer.transform(&lagged, self.record.rate_hz());
        wave.close(&self.density);
        wave
    }

    fn at(&self, lag: f64) -> Projection {
        Projection::new(&self.record, &self.density, &self.wave(lag), Half::Both)
    }

    /// Probability of as large a statistic at the best of all lags.
    fn p_value(&self, z: f64) -> f64 {
        p_value::searched(p_value::two_sided(z), self.trials.len() as f64)
    }

    /// The best of the lags that are tried.
    fn best(&self) -> Option<(Projection, f64)> {
        let all = self.trials.par_iter().map(|&lag| (self.at(lag), lag));
        let all: Vec<_> = all.collect();
        all.into_iter().max_by(larger)
    }

    /// Whitens by walk and flicker fitted anew beside the column; its statistic there, and its gain, nats.
    fn beside_walk(&mut self, axis: &AxisState) -> Option<(f64, f64)> {
        let profile = Profile::new(axis, &self.record, &self.density);
        let joints = self.trials.par_iter();
        let joints: Vec<_> = joints.map(|&lag| profile.fit(&self.wave(lag))).collect();
        let joint = joints
            .into_iter()
            .max_by(|a, b| a.z.abs().total_cmp(&b.z.abs()))?;
        self.density = profile.density(&joint);
        self.record.close(&self.density);
        Some((joint.z, joint.nats))
    }

    /// The top between the lags that are tried.
    fn refined(&self, best: (Projection, f64)) -> Option<(Projection, f64)> {
        /// By how much the square of the statistic is larger with a short lag than without, at least: two standard
        /// deviations of a lag that is none, a choice.
        const TWO_SIGMA: f64 = 4.0;
        if best.1 > 0.0 {
            return self.climbed(best);
        }
        let short = self.factor as f64;
        let refined = self.climbed((self.at(short), short))?;
        let gain = refined.0.z().powi(2) - best.0.z().powi(2);
        Some(if gain > TWO_SIGMA { refined } else { best })
    }

    /// The top that lies uphill of a lag.
    fn climbed(&self, (mut projection, mut lag): (Projection, f64)) -> Option<(Projection, f64)> {
        /// First step of a lag's logarithm, half an octave, and the smallest.
        const STEPS: [f64; 2] = [0.35, 1e-5];
        let mut step = STEPS[0];
        while lag > 0.0 && step > STEPS[1] {
            let moved = [f64::exp(step), f64::exp(-step)]
                .map(|factor| (self.at(lag * factor), lag * factor));
            let best = moved.into_iter().max_by(larger)?;
            if best.0.z().abs() > projection.z().abs() {
                (projection, lag) = best;
            } else {
                step *= 0.5;
            }
        }
        Some((projection, lag))
    }

    /// The column behind a lag that was found.
    fn change(&self, (projection, lag): (Projection, f64)) -> SlowChange {
        let mean = self.column.iter().sum::<f64>() / self.column.len() as f64;
        let full = behind(self.column, lag, mean);
        let full: Vec<f32> = full.into_iter().map(|value| value as f32).collect();
        let z = projection.z();
        SlowChange {
            wave: Wave::Follows {
                gain: projection.size(),
                column: Arc::new(full),
            },
            z,
            gain_nats: 0.5 * z * z,
            size_sd: projection.size_sd(),
            time_log_sd: self.log_sd(projection, lag),
            p_value: self.p_value(z),
            nats: held_out_gain(&self.record, &self.density, &self.wave(lag)),
        }
    }

    /// Standard deviation of the logarithm of the lag: the square of the statistic falls as a parabola in it.
    fn log_sd(&self, top: Projection, lag: f64) -> f64 {
        /// Step of the logarithm for the second difference.
        const STEP: f64 = 0.1;
        if lag <= 0.0 {
            return f64::INFINITY;
        }
        let square = |lag: f64| self.at(lag).z().powi(2);
        let sides = square(lag * STEP.exp()) + square(lag * (-STEP).exp());
        let bend = (2.0 * top.z().powi(2) - sides) / (2.0 * STEP * STEP);
        bend.max(1e-9).recip().sqrt()
    }
}

fn larger(a: &(Projection, f64), b: &(Projection, f64)) -> std::cmp::Ordering {
    a.0.z().abs().total_cmp(&b.0.z().abs())
}

/// A column behind a first-order lag of so many samples, about `reference`.
fn behind(column: &[f64], lag: f64, reference: f64) -> Vec<f64> {
    let follows = Follows {
        leader: Leader::Temperature,
        gain: 1.0,
        lag_s: lag,
    };
    let mut lagged = vec![0.0; column.len()];
    // In samples: one a second.
    follows.follower(1.0, reference).add_to(column, &mut lagged);
    lagged
}

#[cfg(test)]
mod tests;
