//! Warm-up: the level settles exponentially from the start.
//!
//! Whitened on the record's slow copy, where each settling is compared with the noise at all frequencies at
//! once.

use rayon::prelude::*;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::axis::profile::{Noise, Profile};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::slow_change::{MeasuredAgain, SlowChange};
use crate::diagnosis::detect::{telegraph, thermal};
use crate::diagnosis::explanation::{Candidate, Change, Explanation};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::matched_filter::{
    Half, Projection, Settling, Transform, Transformer, held_out_gain,
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
    if let Some(lag) = thermal::with_settling_lag(look, time_s, &change.wave) {
        return Some(lag);
    }
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
    let (record, density) = look.axis.slow(values, factor);
    let settling = Settlings::new(record, density);
    let known_gain = settling.at(samples / factor as f64).gain(*amplitude);
    let change = settling.change(factor);
    let gain = change.gain_nats;
    Some((proposal(look, change)?, gain, known_gain))
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
    let (record, density) = axis.slow(&axis.filled, factor);
    let mut settling = Settlings::new(record, density);
    let mut z = settling.best().0;
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
        settling.record.close(&density);
        settling.density = density;
    }
    let p_value = settling.p_value(z);
    (p_value < level).then(|| {
        let change = settling.change(factor);
        SlowChange {
            z,
            gain_nats,
            p_value,
            ..change
        }
    })
}

/// A slow record and what it settles by.
struct Settlings {
    record: Transform,
    density: Vec<f64>,
    transformer: Transformer,
}

impl Settlings {
    fn new(record: Transform, density: Vec<f64>) -> Self {
        Self {
            transformer: Transformer::new(record.len()),
            record,
            density,
        }
    }

    fn wave(&self, samples: f64) -> Transform {
        let settling = Settling {
            samples,
            len: self.record.len(),
        };
        let mut wave = self.transformer.waveform(&settling, self.record.rate_hz());
        wave.close(&self.density);
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
        let length = self.record.len() as f64;
        [(length / 512.0).max(8.0), length / 1.5]
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
            if moved.0.abs() > best.0.abs() && moved.1 < longest * 1.2 && moved.1 > shortest * 0.8 {
                best = moved;
            } else {
                step *= 0.5;
            }
        }
        best
    }

    /// The settling that fits best, one sample of the record standing for `factor`.
    fn change(&self, factor: usize) -> SlowChange {
        let (z, samples) = self.best();
        let projection = self.at(samples);
        // The square of z falls as a parabola in the logarithm of the time constant.
        let h = 0.05_f64;
        let [later, sooner] = [h.exp(), (-h).exp()].map(|by| self.at(samples * by));
        let side = later.z().powi(2) + sooner.z().powi(2);
        let bend = (2.0 * z * z - side) / (2.0 * h * h);
        let time_log_sd = bend.max(1e-9).recip().sqrt();
        // The size goes with the time constant.
        let slope = (later.size() - sooner.size()) / (2.0 * h);
        SlowChange {
            wave: Wave::WarmUp {
                amplitude: projection.size(),
                samples: samples * factor as f64,
            },
            z,
            gain_nats: 0.5 * z * z,
            size_sd: projection.size_sd().hypot(slope * time_log_sd),
            time_log_sd,
            p_value: self.p_value(z),
            nats: held_out_gain(&self.record, &self.density, &self.wave(samples)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    const LENGTH: usize = 1 << 15;
    const RATE_HZ: f64 = 100.0;

    /// White noise of deviation 1, a walk whose steps have this one, and a settling.
    fn axis(seed: u64, walk: f64, amplitude: f64) -> AxisState {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let mut level = 0.0;
        let values = (0..LENGTH).map(|n| {
            level += walk * noise.draw();
            level + noise.draw() + amplitude * (-(n as f64) / 3000.0).exp()
        });
        AxisState::new(Arc::new(values.collect()), RATE_HZ, None).expect("long enough")
    }

    #[test]
    fn walk_settles_by_chance_alone() {
        // At 2 % of 30 records five or more have a probability of 3e-4.
        for walk in [0.0, 1e-3, 1e-2] {
            let alarms = (0..30)
                .filter(|&seed| warm_up(&axis(seed, walk, 0.0), 0.02, Noise::Anew).is_some());
            let alarms: Vec<u64> = alarms.collect();
            assert!(alarms.len() < 5, "walk {walk}: seeds {alarms:?}");
        }
    }

    #[test]
    fn a_settling_taken_for_walk_is_found_beside_it() {
        let level = 2e-4;
        let mut hidden = 0;
        for seed in 100..108 {
            let axis = axis(seed, 0.0, 1.0);
            hidden += u32::from(warm_up(&axis, level, Noise::Fitted).is_none());
            let found = warm_up(&axis, level, Noise::Anew);
            let found = found.unwrap_or_else(|| panic!("seed {seed}: nothing"));
            let Wave::WarmUp { amplitude, .. } = found.wave else {
                panic!("seed {seed}: another waveform");
            };
            // Four deviations: once in 16 000.
            assert!(
                (amplitude - 1.0).abs() < 4.0 * found.size_sd,
                "seed {seed}: {amplitude} within {}",
                found.size_sd
            );
        }
        assert!(hidden > 0, "the walk hides none of them");
    }

    #[test]
    fn a_settling_as_quick_as_the_level_switches_is_a_dwell() {
        use crate::diagnosis::detect::trial::{self, Trial, noise};
        use crate::model::telegraph;
        for (dwell_s, is_found) in [(2.0, true), (15.0, false)] {
            let mut values = noise(0);
            trial::add(&mut values, &trial::settling(4.0, 30.0));
            let mut trial = Trial::new(values);
            trial.know(telegraph::KIND, [1.0, dwell_s], trial::steps(&[]));
            let found = trial.look(|look| find(look, Noise::Anew));
            assert_eq!(found.is_some(), is_found, "seed 0, {dwell_s} s");
        }
    }
}
