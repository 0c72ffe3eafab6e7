//! Thermal: the level follows the temperature, or another column of the same file, behind a lag.

mod lags;
#[cfg(test)]
mod tests;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::axis::profile::Noise;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::slow_change::{MeasuredAgain, SlowChange};
use crate::diagnosis::explanation::{Candidate, Change, Explanation};
use crate::diagnosis::record::reading::Reading;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::thermal::KIND;
use lags::{Following, Lags};

/// What follows the covariate, if it is not known yet.
pub fn find(look: &Look<'_>, noise: Noise) -> Option<Following> {
    let reading = look.context.covariate?;
    if !look.is_open(KIND) || look.axis.has(KIND) {
        return None;
    }
    follows(look.axis, reading, look.level(), noise)
}

/// What is to be done about it.
pub fn proposal(found: Following) -> Option<Proposal> {
    let Following {
        change,
        lag_s,
        settling,
    } = found;
    let Wave::Follows { gain, .. } = change.wave else {
        return None;
    };
    let gain = Value::normal(gain, change.size_sd);
    let lag_s = Value::log_normal(lag_s, change.time_log_sd);
    let waves: Vec<Wave> = std::iter::once(change.wave).chain(settling).collect();
    Some(Proposal::Explain(Box::new(Candidate {
        held_out_nats: Some(change.nats),
        ..Candidate::new(
            Estimate::new(KIND, [gain, lag_s]),
            change.p_value,
            // A size of each, and the lag.
            1.0 + waves.len() as f64,
            Change::Waves(waves),
        )
    })))
}

/// Whether the level follows `reading`, one value a sample, with the lag behind it in seconds.
fn follows(axis: &AxisState, reading: &Reading, level: f64, noise: Noise) -> Option<Following> {
    let mut lags = Lags::new(axis, &axis.filled, reading);
    let mut best = lags.best()?;
    let mut beside_walk = None;
    if noise == Noise::Anew && lags.p_value(best.0.z()) >= level {
        // Walk and flicker may have been taken for it.
        beside_walk = Some(lags.beside_walk(axis)?);
        best = lags.best()?;
    }
    let place = lags.refined(best.1)?;
    let of_projection = |z: f64| (z, 0.5 * z * z);
    let (z, gain_nats) = beside_walk.unwrap_or(of_projection(place.gain.z()));
    let p_value = lags.p_value(z);
    if p_value >= level || !z.is_finite() {
        return None;
    }
    let found = lags.following(&place);
    let change = SlowChange {
        z,
        gain_nats,
        p_value,
        ..found.change
    };
    Some(Following { change, ..found })
}

/// What follows the covariate as it is `known`, measured in `values`, where it is; what it gains there, and what it gains
/// as it is known, nats.
pub fn measured_again(
    look: &Look<'_>,
    values: &[f64],
    known: &Explanation,
) -> Option<MeasuredAgain> {
    let reading = look.context.covariate?;
    if look.axis.absorbed_hz().is_some() {
        // Where it moves most nothing is said of the noise any more.
        return None;
    }
    let lags = Lags::new(look.axis, values, reading);
    let known_gain = lags.gain_of(known.waves())?;
    let place = lags.refined(lags.best()?.1)?;
    let found = lags.following(&place);
    let absorbs = found.change.wave.absorbs_hz() > Some(0.0);
    Some(MeasuredAgain {
        proposal: proposal(found)?,
        gained_nats: place.nats() - known_gain,
        absorbs_more: absorbs,
    })
}
