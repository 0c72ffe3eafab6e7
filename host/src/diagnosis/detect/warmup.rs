//! Warm-up: the level settles exponentially from the start.
//!
//! Whitened on the record's slow copy, where each settling is compared with the noise at all frequencies at
//! once.

pub mod plain;
#[cfg(test)]
mod tests;
pub mod together;

use rayon::prelude::*;

use crate::diagnosis::axis::profile::{Noise, Profile};
use crate::diagnosis::axis::{AxisState, SPREAD};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::slow_change::{MeasuredAgain, SlowChange};
use crate::diagnosis::detect::telegraph;
use crate::diagnosis::explanation::{Candidate, Change, Explanation};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::matched_filter::{
    Half, Projection, Seam, Settling, Transform, Transformer, held_out_gain,
};
use crate::diagnosis::statistic::p_value;
use crate::model::warmup::KIND;

/// Time constants of a settling tried an octave: in white noise one halfway between two of them
/// loses 0.2 % of its statistic.
const PER_OCTAVE: f64 = 3.0;

/// Smallest step of a time constant's logarithm: of a settling a hundred thousand deviations large half a deviation is left
/// then, a tenth of it to what else is slow.
const FINEST: f64 = 1e-5;

/// The settling of an axis, if there is one that is not known yet.
pub fn find(look: &Look<'_>, noise: Noise) -> Option<SlowChange> {
    if !look.is_open(KIND) || look.axis.has(KIND) {
        return None;
    }
    let change = warm_up(look.axis, look.level(), noise)?;
    (change.is_seen(look.axis) && !is_dwelling(look.axis, &change)).then_some(change)
}

/// What is to be done about it.
pub fn proposal(look: &Look<'_>, change: SlowChange) -> Option<Proposal> {
    let Wave::WarmUp { amplitude, samples } = change.wave else {
        return None;
    };
    let time_s = samples / look.axis.rate_hz;
    let amplitude = Value::normal(amplitude, change.size_sd);
    let time_s = Value::log_normal(time_s, change.time_log_sd);
    Some(Proposal::Explain(Box::new(Candidate {
        held_out_nats: Some(change.nats),
        ..Candidate::new(
            Estimate::new(KIND, [amplitude, time_s]),
            change.p_value,
            2.0,
            Change::Waves(vec![change.wave]),
        )
    })))
}

/// The settling that is `known`, measured in `values`, where it is; what it gains there, and what it gains as it is known,
/// nats.
pub fn measured_again(
    look: &Look<'_>,
    values: &[f64],
    known: &Explanation,
) -> Option<MeasuredAgain> {
    let [Wave::WarmUp { amplitude, samples }] = known.waves() else {
        return None;
    };
    let factor = look.axis.drift_factor();
    let settling = Settlings::new(look.axis, values, factor);
    let known_gain = {
        let samples = samples / factor as f64;
        let size = amplitude / first_sample(samples, factor);
        settling.at(samples).gain(size)
    };
    let change = settling.change(factor)?;
    Some(MeasuredAgain {
        gained_nats: change.gain_nats - known_gain,
        proposal: proposal(look, change)?,
        absorbs_more: false,
    })
}

/// Whether a settling is as quick as the level switches: a dwell at the start.
fn is_dwelling(axis: &AxisState, change: &SlowChange) -> bool {
    /// Dwell times that make a settling of its own: a dwell lasts as long with the probability
    /// `e^-5`, 0.7 %.
    const DWELLS: f64 = 5.0;
    match (&change.wave, telegraph::levels(axis)) {
        (Wave::WarmUp { samples, .. }, Some(levels)) => {
            samples / axis.rate_hz < DWELLS * levels.dwell_s
        }
        _ => false,
    }
}

/// Exponential settling from the start.
pub fn warm_up(axis: &AxisState, level: f64, noise: Noise) -> Option<SlowChange> {
    let factor = axis.drift_factor();
    let mut settling = Settlings::new(axis, &axis.filled, factor);
    let (mut z, samples) = settling.best();
    let mut gain_nats = 0.5 * z * z;
    if noise == Noise::Anew && settling.p_value(z) >= level {
        // Walk and flicker may have been taken for it.
        let profile = Profile::new(axis, &settling.record, &settling.density);
        let times: Vec<f64> = settling.times().collect();
        let joints = times.into_par_iter();
        let joints: Vec<_> = joints
            .map(|samples| profile.fit(&settling.wave(samples)))
            .collect();
        let joint = joints
            .into_iter()
            .max_by(|a, b| a.z.abs().total_cmp(&b.z.abs()))?;
        let density = profile.density(&joint);
        (z, gain_nats) = (joint.z, joint.nats);
        settling.record.close(&density, &settling.seam);
        settling.density = density;
    } else if settling.p_value(z) < level && !settling.is_no_walk(axis, samples, level) {
        return None;
    }
    let p_value = settling.p_value(z);
    let change = (p_value < level).then(|| settling.change(factor))??;
    Some(SlowChange {
        z,
        gain_nats,
        p_value,
        ..change
    })
}

/// Size in the first sample of a settling that in means over `factor` samples, of which its time constant is so many, has
/// the size 1 half a mean before the first.
fn first_sample(samples: f64, factor: usize) -> f64 {
    let [whole, one] = [1.0, (factor as f64).recip()].map(|part| (-part / samples).exp_m1());
    (-0.5 / samples).exp() * factor as f64 * one / whole
}

/// A slow record and what it settles by.
struct Settlings {
    record: Transform,
    density: Vec<f64>,
    /// What is free where it closes.
    seam: Seam,
    transformer: Transformer,
    /// The shortest time constant.
    shortest: f64,
}

impl Settlings {
    /// Of `values` of an axis in means over `factor` samples. What begins within a converter's filter is its own beginning:
    /// one free sample and a step do not close the seam behind it.
    fn new(axis: &AxisState, values: &[f64], factor: usize) -> Self {
        let (record, density) = axis.slow(values, factor);
        let spread = if axis.is_filtered() { SPREAD } else { 0 };
        Self {
            transformer: Transformer::new(record.len()),
            shortest: [
                8.0,
                record.len() as f64 / 512.0,
                spread as f64 / factor as f64,
            ]
            .into_iter()
            .fold(0.0, f64::max),
            seam: axis.seam(record.rate_hz()),
            record,
            density,
        }
    }

    fn wave(&self, samples: f64) -> Transform {
        let settling = Settling::new(samples, self.record.len());
        let mut wave = self.transformer.waveform(&settling, self.record.rate_hz());
        wave.close(&self.density, &self.seam);
        wave
    }

    fn at(&self, samples: f64) -> Projection {
        Projection::new(&self.record, &self.density, &self.wave(samples), Half::Both)
    }

    fn z_at(&self, samples: f64) -> f64 {
        self.at(samples).z()
    }

    /// The shortest and the longest time constant.
    fn ends(&self) -> [f64; 2] {
        [self.shortest, self.record.len() as f64 / 1.5]
    }

    fn octaves(&self) -> f64 {
        let [shortest, longest] = self.ends();
        (longest / shortest).log2()
    }

    fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let [shortest, _] = self.ends();
        let count = (PER_OCTAVE * self.octaves()) as usize;
        (0..=count).map(move |step| shortest * (step as f64 / PER_OCTAVE).exp2())
    }

    /// Neighbouring time constants are as good as one: about one independent trial an octave.
    fn p_value(&self, z: f64) -> f64 {
        p_value::searched(p_value::chi_squared(z * z, 2.0), self.octaves())
    }

    /// Whether the one of so many `samples` is significant beside walk and flicker that are fitted anew with it and without it: where the record
    /// is too short to tell how strong these are, what they do looks like a settling in the noise that was fitted.
    fn is_no_walk(&self, axis: &AxisState, samples: f64, level: f64) -> bool {
        let profile = Profile::new(axis, &self.record, &self.density);
        self.p_value(profile.fit(&self.wave(samples)).z) < level
    }

    /// The largest statistic and its time constant.
    fn best(&self) -> (f64, f64) {
        let times: Vec<f64> = self.times().collect();
        let all = times.into_par_iter();
        let all: Vec<_> = all.map(|samples| (self.z_at(samples), samples)).collect();
        let larger = |a: &(f64, f64), b: &(f64, f64)| a.0.abs().total_cmp(&b.0.abs());
        let mut best = all.into_iter().max_by(larger).unwrap_or_default();
        let [shortest, longest] = self.ends();
        // The top between the steps.
        let mut step = 0.15;
        while step > FINEST {
            let moved = [f64::exp(step), f64::exp(-step)]
                .map(|factor| (self.z_at(best.1 * factor), best.1 * factor));
            let moved = moved.into_iter().max_by(larger).unwrap_or(best);
            if moved.0.abs() > best.0.abs() && moved.1 < longest * 1.2 && moved.1 >= shortest {
                best = moved;
            } else {
                step *= 0.5;
            }
        }
        best
    }

    /// The settling that fits best, one sample of the record standing for `factor`; `None` where that is the shortest: then it
    /// is something shorter.
    fn change(&self, factor: usize) -> Option<SlowChange> {
        let (z, samples) = self.best();
        if samples <= self.shortest {
            return None;
        }
        let projection = self.at(samples);
        let first = first_sample(samples, factor);
        // The square of z falls as a parabola in the logarithm of the time constant.
        let h = 0.05_f64;
        let [later, sooner] = [h.exp(), (-h).exp()].map(|by| self.at(samples * by));
        let side = later.z().powi(2) + sooner.z().powi(2);
        let bend = (2.0 * z * z - side) / (2.0 * h * h);
        let time_log_sd = bend.max(1e-9).recip().sqrt();
        // The size goes with the time constant.
        let slope = (later.size() - sooner.size()) / (2.0 * h);
        Some(SlowChange {
            wave: Wave::WarmUp {
                amplitude: first * projection.size(),
                samples: samples * factor as f64,
            },
            z,
            gain_nats: 0.5 * z * z,
            size_sd: first * projection.size_sd().hypot(slope * time_log_sd),
            time_log_sd,
            p_value: self.p_value(z),
            nats: held_out_gain(&self.record, &self.density, &self.wave(samples)),
        })
    }
}
