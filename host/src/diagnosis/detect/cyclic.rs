//! Cyclic: the noise grows and shrinks at a period.
//!
//! Where the plainest movement of the noise's power is a cycle, a cosine is fitted to it. It is named only if
//! nothing is left: noise that is switched has harmonics, noise whose strength wanders has neighbouring
//! frequencies, and noise whose corner swings does so by more at some frequencies than at others.

use std::f64::consts::TAU;
use std::ops::Range;

use super::Detector;
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::slow_change::LEAST_GAIN;
use crate::diagnosis::detect::strength::bursts_stand_out;
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::envelope::{Envelope, of_share};
use crate::diagnosis::record::powers::{BLOCK, Powers};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::steady::strength::{LEFT, Wander, wander};
use crate::diagnosis::steady::swing::Swing;
use crate::diagnosis::steady::tiles::strengths;
use crate::model::cyclic::KIND;
use crate::model::{burst, outliers, rounding};

/// Blocks of the shortest period: its harmonics, by which it is known for a cosine, have four.
const LEAST_BLOCKS: f64 = 8.0;

/// Level at which harmonics speak against it: noise that is switched is not to be named even where its harmonics
/// are hardly seen, at the cost of one true cosine in a hundred.
const HARMONICS: f64 = 0.01;

/// Share of the density that noise without a memory has where the swing is looked for, at least: a choice. The rest does not
/// swing, and is known no better than the fit.
const SHORT: f64 = 0.5;

/// Looks for one cosine that explains how the strength moves.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let axis = look.axis;
    // On a coarse grid noise seems to change wherever its level lies within a step.
    if !look.is_open(KIND) || axis.has(rounding::KIND) {
        return Ok(Vec::new());
    }
    if let Some(place) = look.place_of(KIND) {
        return Ok(again(axis, place).into_iter().collect());
    }
    let found = cyclic(axis, look.level());
    let found = found.filter(|one| evenness(axis, &one.swing) >= look.level());
    Ok(found.into_iter().map(|one| proposal(axis, &one)).collect())
}

/// The swing that is known, where it is known better beside what was found since: which part of the noise swings, the model
/// of the spectrum says.
fn again(axis: &AxisState, place: usize) -> Option<Proposal> {
    let one = &axis.explanations()[place];
    let known = one.envelope()?;
    let Short { density, share } = Short::new(axis)?;
    let powers = Powers {
        powers: axis.powers_as_measured(&density).powers,
        counts: axis.powers_by(&density, |_| 1.0).counts,
    };
    let fit = Swing::new(&powers, known.period, share)?;
    let gain = fit.score(&powers) - Swing::known(&powers, known, share).score(&powers);
    if gain.is_nan() || gain <= LEAST_GAIN {
        return None;
    }
    let (swing, sd) = fit.named()?;
    let found = Cyclic {
        swing,
        sd,
        held_nats: held_out(&powers, known.period, share),
        p_value: one.p_value,
    };
    Some(Proposal::Explain(Box::new(Candidate {
        amends: Some(place),
        supersedes: Vec::new(),
        ..candidate(axis, &found)
    })))
}

fn proposal(axis: &AxisState, found: &Cyclic) -> Proposal {
    Proposal::Explain(Box::new(candidate(axis, found)))
}

fn candidate(axis: &AxisState, found: &Cyclic) -> Candidate {
    let Cyclic { swing, sd, .. } = found;
    let rate_hz = axis.rate_hz;
    // Loud parts of it may have been taken for them.
    let mut supersedes = vec![outliers::KIND];
    if !bursts_stand_out(axis, swing.power_sd()) {
        supersedes.push(burst::KIND);
    }
    let effect = Estimate::new(
        KIND,
        [
            Value::normal(swing.depth, sd.depth),
            Value::normal(swing.period / rate_hz, sd.period / rate_hz),
            Value::normal(swing.phase_rad, sd.phase_rad),
        ],
    );
    Candidate {
        held_out_nats: found.held_nats,
        supersedes,
        ..Candidate::new(effect, found.p_value, 3.0, Change::Strength(*swing))
    }
}

/// A cosine of the strength.
#[derive(Debug, Clone, PartialEq)]
pub struct Cyclic {
    /// It.
    pub swing: Envelope,
    /// Standard deviations of its three numbers.
    pub sd: Envelope,
    /// Gain in log-likelihood of the odd blocks when fitted to the even ones.
    pub held_nats: Option<f64>,
    /// Probability of as plain a cycle in steady noise.
    pub p_value: f64,
}

/// The cosine that explains how the power of the noise moves at a `level`, if one does and nothing is left.
fn cyclic(axis: &AxisState, level: f64) -> Option<Cyclic> {
    let powers = axis.powers();
    // A cycle between two ordinates is plainer as a slow movement: that one is asked about once the cosine is out.
    let Wander { cyclic, .. } = wander(&powers)?;
    if cyclic.p_value >= level || cyclic.period < LEAST_BLOCKS * BLOCK as f64 {
        return None;
    }
    let Short { density, share } = Short::new(axis)?;
    let powers = axis.powers_by(&density, |_| 1.0);
    let (swing, _) = Swing::new(&powers, cyclic.period, share)?.named()?;
    let factor = |index| of_share(share, swing.factor(index).powi(2)).sqrt();
    let left = axis.powers_by(&density, factor);
    // Powers that swing scatter by more than their degrees of freedom say: these are known once it is out.
    let powers = Powers {
        powers: powers.powers.clone(),
        counts: left.counts.clone(),
    };
    let fit = Swing::new(&powers, cyclic.period, share)?;
    let known_sd = share * swing.power_sd();
    let moves = wander(&left)?;
    let harmonics = fit.harmonics(&left);
    let are_left = harmonics.p_value < HARMONICS && harmonics.sd > LEFT * known_sd;
    if are_left
        || [moves.cyclic, moves.slow]
            .iter()
            .any(|one| one.counts(level, known_sd))
    {
        return None;
    }
    let (swing, sd) = fit.named()?;
    Some(Cyclic {
        swing,
        sd,
        held_nats: held_out(&powers, cyclic.period, share),
        p_value: cyclic.p_value,
    })
}

/// What whitens only where most of the noise is without a memory.
struct Short {
    /// Two-sided density of each ordinate, infinite elsewhere.
    density: Vec<f64>,
    /// The share that such noise has there in the mean.
    share: f64,
}

impl Short {
    fn new(axis: &AxisState) -> Option<Self> {
        let seen = axis.whitened();
        let mut density = seen.density.clone();
        let (mut sum, mut count) = (0.0, 0);
        for (k, one) in density.iter_mut().enumerate() {
            let share = axis.short_share(seen.transform.frequency(k.max(1)));
            if share < SHORT {
                *one = f64::INFINITY;
            } else if one.is_finite() {
                sum += share;
                count += 1;
            }
        }
        (count > 0).then(|| Self {
            density,
            share: sum / f64::from(count),
        })
    }
}

/// Gain in log-likelihood of the odd blocks for a cosine that is fitted to the even ones, over one power for all.
fn held_out(powers: &Powers, period: f64, share: f64) -> Option<f64> {
    let half = |parity: usize| {
        let mut half = powers.clone();
        let others = half.counts.iter_mut().skip(1 - parity).step_by(2);
        others.for_each(|count| *count = 0.0);
        half
    };
    let (even, odd) = (half(0), half(1));
    let fit = Swing::new(&even, period, share)?;
    let gain = fit.score(&odd) - Swing::steady(&even).score(&odd);
    gain.is_finite().then_some(gain)
}

/// Probability of swings that differ as much from one octave to the next where all noise without a memory swings alike, but for
/// [`LEFT`] of the swing: of that of the whole noise, so that an octave which is little of it may be off by more.
fn evenness(axis: &AxisState, swing: &Envelope) -> f64 {
    /// Ordinates of the lowest octave.
    const LEAST: usize = 64;
    let seen = axis.whitened();
    let periods = seen.transform.len() as f64 / swing.period;
    let power_in = |band: &Range<usize>| -> f64 {
        let known = seen.density[band.clone()].iter();
        known.filter(|one| one.is_finite()).sum()
    };
    let all = power_in(&(1..seen.top));
    let (mut square, mut swings, mut weights, mut bands) = (0.0, 0.0, 0.0, 0.0);
    let mut top = seen.top - 1;
    // Moments that follow the swing.
    while top >= 2 * LEAST && top as f64 >= 2.0 * LEAST_BLOCKS * periods {
        let band = top / 2..top;
        let short = axis.mean_short_share(&band, seen.transform.frequency(1));
        let strengths = strengths(&seen, band.clone());
        top /= 2;
        // A band of as many ordinates as there are moments sees a frequency by the share of them that it keeps
        // when it is moved by it.
        let kept = 1.0 - periods / strengths.len() as f64;
        if let Some([mean, variance]) = swing_of_band(axis, swing, &strengths) {
            let expected = kept * short;
            let variance = variance + (LEFT * mean).powi(2) * all / power_in(&band);
            square += mean * mean / variance;
            swings += expected * mean / variance;
            weights += expected * expected / variance;
            bands += 1.0;
        }
    }
    if bands < 2.0 {
        return 1.0;
    }
    p_value::chi_squared(square - swings * swings / weights, bands - 1.0)
}

/// Mean of the swing's cosine over the strengths of a band, by their weight, and its variance.
fn swing_of_band(axis: &AxisState, swing: &Envelope, strengths: &[f64]) -> Option<[f64; 2]> {
    let samples = axis.ring_len() as f64 / strengths.len() as f64;
    let cosines = strengths
        .iter()
        .enumerate()
        .filter_map(|(moment, strength)| {
            let at = moment as f64 * samples;
            let angle = TAU * (at / swing.period).fract() + swing.phase_rad;
            axis.usable(at as usize).then_some((*strength, angle.cos()))
        });
    let [sum, with] = cosines
        .clone()
        .fold([0.0; 2], |[sum, with], (strength, cosine)| {
            [sum + strength, with + strength * cosine]
        });
    let mean = with / sum;
    // A strength is exponential: its square is twice its variance.
    let variances = cosines.map(|(strength, cosine)| 0.5 * (strength * (cosine - mean)).powi(2));
    let variance = variances.sum::<f64>() / (sum * sum);
    (variance > 0.0 && variance.is_finite()).then_some([mean, variance])
}

#[cfg(test)]
mod tests;
