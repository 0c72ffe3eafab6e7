//! A column behind lags of any length and any start, measured in a slow record.
//!
//! What follows a column behind a lag is not settled as the record begins: the column was elsewhere before. What that leaves is an
//! exponential of the lag's own time constant and of any size, fitted together with the gain; without it a strong course of
//! lag 48 s was found with one of 39 s.

use std::f64::consts::TAU;
use std::sync::Arc;

use rayon::prelude::*;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::axis::profile::Profile;
use crate::diagnosis::detect::slow_change::SlowChange;
use crate::diagnosis::record::bridge::block_means;
use crate::diagnosis::record::reading::Reading;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::statistic::matched_filter::{
    Half, Projection, Seam, Transform, Transformer, held_out_gain,
};
use crate::diagnosis::statistic::p_value;
use crate::model::follows::{Follows, Leader};
use crate::model::random::Generator;
use crate::model::warmup::Settling;

/// What follows the covariate.
pub struct Following {
    /// The covariate behind its lag, times a gain.
    pub change: SlowChange,
    /// The lag, seconds.
    pub lag_s: f64,
    /// How it settles from where it was as the record began, where there is a lag.
    pub settling: Option<Wave>,
}

/// A slow record and the column that it may follow.
pub struct Lags<'a> {
    record: Transform,
    density: Vec<f64>,
    /// What is free where it closes.
    seam: Seam,
    transformer: Transformer,
    reading: &'a Reading,
    /// Samples of the column that a sample of the slow record is a mean over.
    factor: usize,
    /// Samples a second of the column.
    rate_hz: f64,
    /// First-order lags that are tried, samples of the column: none, and up to an eighth of its length.
    trials: Vec<f64>,
}

impl<'a> Lags<'a> {
    /// Of the `values` of an axis, and the `reading` that they may follow.
    pub fn new(axis: &AxisState, values: &[f64], reading: &'a Reading) -> Self {
        /// Shortest lag that is tried, samples of the slow record: a shorter one is as good as none until it is refined.
        const SHORTEST: f64 = 4.0;
        let factor = axis.drift_factor();
        let (record, density) = axis.slow(values, factor);
        let longest = reading.column.len() as f64 / 8.0;
        let lags = std::iter::successors(Some(SHORTEST * factor as f64), |lag| Some(2.0 * lag));
        let lags = lags.take_while(|lag| *lag < longest);
        Self {
            transformer: Transformer::new(record.len()),
            seam: axis.seam(record.rate_hz()),
            record,
            density,
            trials: std::iter::once(0.0).chain(lags).collect(),
            reading,
            factor,
            rate_hz: axis.rate_hz,
        }
    }

    fn wave(&self, lag: f64) -> Transform {
        // A lag of means is not the mean of what lags: it would be late by half of what they are over.
        self.closed(&behind(&self.reading.column, lag, 0.0))
    }

    /// The transform of a course, one value a sample, on the ring of the slow record.
    fn closed(&self, course: &[f64]) -> Transform {
        let means = block_means(course, self.factor);
        let mut wave = self.transformer.transform(&means, self.record.rate_hz());
        wave.close(&self.density, &self.seam);
        wave
    }

    fn at(&self, lag: f64) -> Projection {
        Projection::new(&self.record, &self.density, &self.wave(lag), Half::Both)
    }

    /// Probability of as large a statistic at the best of all lags.
    pub fn p_value(&self, z: f64) -> f64 {
        p_value::searched(p_value::two_sided(z), self.trials.len() as f64)
    }

    /// The best of the lags that are tried.
    pub fn best(&self) -> Option<(Projection, f64)> {
        let all = self.trials.par_iter().map(|&lag| (self.at(lag), lag));
        let all: Vec<_> = all.collect();
        all.into_iter().max_by(larger)
    }

    /// Whitens by walk and flicker fitted anew beside the column; its statistic there, and its gain, nats.
    pub fn beside_walk(&mut self, axis: &AxisState) -> Option<(f64, f64)> {
        let profile = Profile::new(axis, &self.record, &self.density);
        let joints = self.trials.par_iter();
        let joints: Vec<_> = joints.map(|&lag| profile.fit(&self.wave(lag))).collect();
        let joint = joints
            .into_iter()
            .max_by(|a, b| a.z.abs().total_cmp(&b.z.abs()))?;
        self.density = profile.density(&joint);
        self.record.close(&self.density, &self.seam);
        Some((joint.z, joint.nats))
    }

    /// The column behind a lag of any start, as it fits best.
    fn place(&self, lag: f64) -> Place {
        let mut wave = self.wave(lag);
        let settling = (lag > 0.0).then(|| self.settling(lag));
        let start = settling.as_ref().map(|settling| {
            let alone = self.onto(&self.record, settling);
            let part = self.onto(&wave, settling).size();
            wave.add_scaled(-part, settling);
            (alone, part)
        });
        Place {
            lag,
            gain: self.onto(&self.record, &wave),
            start,
        }
    }

    fn onto(&self, record: &Transform, wave: &Transform) -> Projection {
        Projection::new(record, &self.density, wave, Half::Both)
    }

    /// What is left, behind a lag, of any other level of the column before the record.
    fn settling(&self, lag: f64) -> Transform {
        let mut values = vec![0.0; self.reading.column.len()];
        Settling::new(1.0, lag).add_to(&mut values);
        self.closed(&values)
    }

    /// The top between the lags that are tried.
    pub fn refined(&self, lag: f64) -> Option<Place> {
        /// By how much the log-likelihood is larger with a short lag than without, at least, nats: two standard deviations of
        /// two numbers that are none (chi-squared), a choice.
        const TWO_SIGMA: f64 = 3.09;
        if lag > 0.0 {
            return self.climbed(self.place(lag));
        }
        let none = self.place(0.0);
        let refined = self.climbed(self.place(self.factor as f64))?;
        Some(if refined.nats() - none.nats() > TWO_SIGMA {
            refined
        } else {
            none
        })
    }

    /// The top that lies uphill of a lag.
    fn climbed(&self, mut top: Place) -> Option<Place> {
        /// First step of a lag's logarithm, half an octave, and the smallest.
        const STEPS: [f64; 2] = [0.35, 1e-5];
        let mut step = STEPS[0];
        while step > STEPS[1] {
            let moved =
                [f64::exp(step), f64::exp(-step)].map(|factor| self.place(top.lag * factor));
            let best = moved
                .into_iter()
                .max_by(|a, b| a.nats().total_cmp(&b.nats()))?;
            if best.nats() > top.nats() {
                top = best;
            } else {
                step *= 0.5;
            }
        }
        Some(top)
    }

    /// Gain in log-likelihood with `waves` as they are, nats.
    pub fn gain_of(&self, waves: &[Wave]) -> Option<f64> {
        let mut values = vec![0.0; self.reading.column.len()];
        // Taken out of nothing: of the other sign.
        waves.iter().for_each(|wave| wave.take_out(&mut values));
        let gain = self.onto(&self.record, &self.closed(&values)).gain(-1.0);
        gain.is_finite().then_some(gain)
    }

    /// What follows the column at a place that was found.
    pub fn following(&self, place: &Place) -> Following {
        let lag = place.lag;
        let mean = self.reading.column.iter().sum::<f64>() / self.reading.column.len() as f64;
        let full = behind(&self.reading.column, lag, mean);
        let full: Vec<f32> = full.into_iter().map(|value| value as f32).collect();
        let amplitude = place.settling();
        let mut whole = self.wave(lag);
        if let Some(amplitude) = amplitude {
            whole.add_scaled(amplitude / place.gain.size(), &self.settling(lag));
        }
        let z = place.gain.z();
        let change = SlowChange {
            wave: Wave::Follows {
                gain: place.gain.size(),
                column: Arc::new(full),
                absorbs_hz: self.absorbs_hz(place),
            },
            z,
            gain_nats: place.nats(),
            size_sd: place.gain.size_sd(),
            time_log_sd: self.log_sd(place),
            p_value: self.p_value(z),
            nats: held_out_gain(&self.record, &self.density, &whole),
        };
        Following {
            change,
            lag_s: lag / self.rate_hz,
            settling: amplitude.map(|amplitude| Wave::WarmUp {
                amplitude,
                samples: lag,
            }),
        }
    }

    /// The highest frequency at which what is left of the reading's noise is heard behind lag and gain, hertz: the sensor does not
    /// follow it, and it stays in what is left.
    fn absorbs_hz(&self, place: &Place) -> f64 {
        /// Its density over that of the noise from which it is: a choice. Half as much makes the noise half again as loud.
        const HEARD: f64 = 0.5;
        let square = place.gain.size().powi(2);
        let is_heard = |k: &usize| {
            let turn = TAU * self.record.frequency(*k) / self.rate_hz;
            let lagged = 1.0 + (turn * place.lag).powi(2);
            square * self.reading.density(turn, self.rate_hz) / lagged > HEARD * self.density[*k]
        };
        let last = (1..self.density.len()).rev().find(is_heard);
        last.map_or(0.0, |k| self.record.frequency(k))
    }

    /// Standard deviation of the logarithm of the lag: the log-likelihood falls as a parabola in it.
    fn log_sd(&self, top: &Place) -> f64 {
        /// Step of the logarithm for the second difference.
        const STEP: f64 = 0.1;
        if top.lag <= 0.0 {
            return f64::INFINITY;
        }
        let nats = |factor: f64| self.place(top.lag * factor).nats();
        let sides = nats(STEP.exp()) + nats((-STEP).exp());
        let bend = (2.0 * top.nats() - sides) / (STEP * STEP);
        bend.max(1e-9).recip().sqrt()
    }
}

/// A lag, and what fits best behind it.
pub struct Place {
    /// The lag, samples.
    lag: f64,
    /// The column behind it, without what the settling explains of it.
    pub gain: Projection,
    /// The settling by itself, and how much of it the column behind the lag holds; `None` without a lag.
    start: Option<(Projection, f64)>,
}

impl Place {
    /// Gain in log-likelihood, nats.
    pub fn nats(&self) -> f64 {
        let start = self.start.map_or(0.0, |(alone, _)| alone.z());
        0.5 * (self.gain.z().powi(2) + start.powi(2))
    }

    /// Size of the settling, unit of the signal.
    fn settling(&self) -> Option<f64> {
        self.start
            .map(|(alone, part)| alone.size() - part * self.gain.size())
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
