//! Thermal: the level follows the temperature, or another column beside the record, behind a lag.

use std::sync::Arc;

use rayon::prelude::*;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::axis::profile::{Noise, Profile};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::slow_change::SlowChange;
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
    /// Largest ratio of the two times.
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

/// Whether the level follows `column`, one value a sample, `lag` samples behind at most some.
pub fn follows(
    axis: &AxisState,
    column: &[f64],
    level: f64,
    noise: Noise,
) -> Option<(SlowChange, f64)> {
    let factor = axis.drift_factor();
    let (mut record, mut density) = axis.slow(&axis.filled, factor);
    let transformer = Transformer::new(record.len());
    let rate_hz = axis.rate_hz / factor as f64;
    let means = block_means(column, factor);
    // First-order lags from none to an eighth of the record.
    let mut lags = vec![0.0];
    let mut lag = 4.0;
    while lag < means.len() as f64 / 8.0 {
        lags.push(lag);
        lag *= 2.0;
    }
    let lagged = |lag: f64| behind(&means, lag, 0.0);
    let open = |lag: f64| transformer.transform(&lagged(lag), rate_hz);
    let wave = |lag: f64, density: &[f64]| {
        let mut wave = open(lag);
        wave.close(density);
        wave
    };
    let trials = lags.len() as f64;
    let p_of = |z: f64| p_value::searched(p_value::two_sided(z), trials);
    let at = |lag: f64, record: &Transform, density: &[f64]| {
        Projection::new(record, density, &wave(lag, density), Half::Both)
    };
    let larger =
        |a: &(Projection, f64), b: &(Projection, f64)| a.0.z().abs().total_cmp(&b.0.z().abs());
    let first = |record: &Transform, density: &[f64]| {
        let all = lags.par_iter().map(|&lag| (at(lag, record, density), lag));
        let all: Vec<_> = all.collect();
        all.into_iter().max_by(larger)
    };
    let (mut projection, mut lag) = first(&record, &density)?;
    let mut told = None;
    if noise == Noise::Anew && p_of(projection.z()) >= level {
        // Walk and flicker may have been taken for it.
        let profile = Profile::new(axis, &record, &density);
        let joints = lags.par_iter();
        let joints: Vec<_> = joints
            .map(|&lag| profile.fit(&wave(lag, &density)))
            .collect();
        let joint = joints
            .into_iter()
            .max_by(|a, b| a.z.abs().total_cmp(&b.z.abs()))?;
        let beside = profile.density(&joint);
        told = Some(joint.z);
        density = beside;
        record.close(&density);
        (projection, lag) = first(&record, &density)?;
    }
    // The top between the steps.
    let mut step = 0.35;
    while lag > 0.0 && step > 5e-3 {
        let best = [f64::exp(step), f64::exp(-step)]
            .map(|factor| (at(lag * factor, &record, &density), lag * factor))
            .into_iter()
            .max_by(larger)?;
        if best.0.z().abs() > projection.z().abs() {
            (projection, lag) = best;
        } else {
            step *= 0.5;
        }
    }
    let z = told.unwrap_or(projection.z());
    let p_value = p_of(z);
    if p_value >= level || !z.is_finite() {
        return None;
    }
    // The square of z falls as a parabola in the logarithm of the lag.
    let lag_log_sd = if lag > 0.0 {
        let h = 0.1_f64;
        let square = |lag: f64| at(lag, &record, &density).z().powi(2);
        let top = projection.z().powi(2);
        let bend = (2.0 * top - square(lag * h.exp()) - square(lag * (-h).exp())) / (2.0 * h * h);
        bend.max(1e-9).recip().sqrt()
    } else {
        f64::INFINITY
    };
    let mean = column.iter().sum::<f64>() / column.len() as f64;
    let full = behind(column, lag * factor as f64, mean);
    let full: Vec<f32> = full.into_iter().map(|value| value as f32).collect();
    Some((
        SlowChange {
            wave: Wave::Follows {
                gain: projection.size(),
                column: Arc::new(full),
            },
            z,
            size_sd: projection.size_sd(),
            time_log_sd: lag_log_sd,
            p_value,
            nats: held_out_gain(&record, &density, &wave(lag, &density)),
        },
        lag * factor as f64 / axis.rate_hz,
    ))
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
