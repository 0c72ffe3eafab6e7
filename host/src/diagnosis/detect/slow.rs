//! Slow deterministic changes of the level: settling from the start, and what follows a covariate.
//! Seen on the record's slow copy, where each waveform is compared with the noise at all
//! frequencies at once.

use std::sync::Arc;

use rayon::prelude::*;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::residual::{Wave, block_means};
use crate::diagnosis::statistic::matched_filter::{
    Half, Projection, Settling, Transformer, Whole, held_out_gain,
};
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::statistic::profile::{Noise, Profile};

/// A waveform that is in the record.
pub struct SlowChange {
    /// It.
    pub wave: Wave,
    /// Its size over its standard deviation.
    pub z: f64,
    /// Standard deviation of its size.
    pub size_sd: f64,
    /// Standard deviation of the logarithm of its time constant, where it has one.
    pub time_log_sd: f64,
    /// Probability of as large a statistic without it.
    pub p_value: f64,
    /// Gain in log-likelihood on ordinates that it was not fitted to.
    pub nats: f64,
}

/// Time constants of a settling tried an octave.
const PER_OCTAVE: f64 = 3.0;

/// Exponential settling from the start.
pub fn warm_up(axis: &AxisState, level: f64, noise: Noise) -> Option<SlowChange> {
    let factor = axis.drift_factor();
    let (record, density) = axis.slow(&axis.filled, factor);
    let mut settling = Settlings::new(record, density);
    let mut z = settling.best().0;
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
        z = joint.z;
        settling.record.close(&density);
        settling.density = density;
    }
    let p_value = settling.p_value(z);
    (p_value < level).then(|| {
        let change = settling.change(factor);
        SlowChange {
            z,
            p_value,
            ..change
        }
    })
}

/// A slow record and what it settles by.
struct Settlings {
    record: Whole,
    density: Vec<f64>,
    transformer: Transformer,
}

impl Settlings {
    fn new(record: Whole, density: Vec<f64>) -> Self {
        Self {
            transformer: Transformer::new(record.len()),
            record,
            density,
        }
    }

    fn wave(&self, samples: f64) -> Whole {
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
        while step > 1e-3 {
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
            size_sd: projection.size_sd().hypot(slope * time_log_sd),
            time_log_sd,
            p_value: self.p_value(z),
            nats: held_out_gain(&self.record, &self.density, &self.wave(samples)),
        }
    }
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
    let lagged = |lag: f64| -> Vec<f64> {
        let keep = if lag > 0.0 { (-1.0 / lag).exp() } else { 0.0 };
        let mut state = means[0];
        means
            .iter()
            .map(|value| {
                state = keep * state + (1.0 - keep) * value;
                state
            })
            .collect()
    };
    let open = |lag: f64| transformer.transform(&lagged(lag), rate_hz);
    let wave = |lag: f64, density: &[f64]| {
        let mut wave = open(lag);
        wave.close(density);
        wave
    };
    let trials = lags.len() as f64;
    let p_of = |z: f64| p_value::searched(p_value::two_sided(z), trials);
    let at = |lag: f64, record: &Whole, density: &[f64]| {
        Projection::new(record, density, &wave(lag, density), Half::Both)
    };
    let larger =
        |a: &(Projection, f64), b: &(Projection, f64)| a.0.z().abs().total_cmp(&b.0.z().abs());
    let first = |record: &Whole, density: &[f64]| {
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
    let keep = if lag > 0.0 {
        (-1.0 / (lag * factor as f64)).exp()
    } else {
        0.0
    };
    let mean = column.iter().sum::<f64>() / column.len() as f64;
    let mut state = column[0];
    let full: Vec<f32> = column
        .iter()
        .map(|value| {
            state = keep * state + (1.0 - keep) * value;
            (state - mean) as f32
        })
        .collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::Seed;
    use crate::model::random::Gaussian;

    const LENGTH: usize = 1 << 15;
    const RATE_HZ: f64 = 100.0;

    /// White noise of deviation 1 beside a walk whose steps have this one, and a settling.
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
}
