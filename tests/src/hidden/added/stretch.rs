//! A part of one axis of a real record, and its law.

use std::sync::Arc;

use super::list::Recording;
use crate::hidden::draw::Draw;
use crate::hidden::noise::base::Base;
use crate::hidden::noise::chain::Chain;
use crate::hidden::noise::measured::Measured;
use crate::hidden::scene::Scene;
use crate::hidden::wide::scene::SHORTEST;

/// Samples of the longest stretch.
const LONGEST: usize = 1 << 18;

/// Stretches that are drawn until one has all of its samples and more than one value.
const TRIES: usize = 100;

/// A part of one axis of a real record.
#[derive(Debug, Clone)]
pub struct Stretch {
    /// What settles it, with the list.
    pub seed: u64,
    /// The record's name.
    pub record: String,
    /// Its axis, from 0.
    pub axis: usize,
    /// First sample in the record.
    pub from: usize,
    /// The samples.
    pub samples: Vec<f64>,
    /// Size of a code, where all numbers are multiples of one.
    pub code: Option<f64>,
    /// Its rate, length and law.
    pub scene: Scene,
}

impl Stretch {
    /// Draws the stretch of this seed: every record alike, any of its axes, lengths log-uniform. None where no
    /// stretch of the record has all of its samples.
    pub fn draw(recordings: &[Recording], seed: u64) -> Option<Self> {
        let mut draw = Draw::new(seed, "stretch");
        (0..TRIES).find_map(|_| Self::try_one(recordings, seed, &mut draw))
    }

    fn try_one(recordings: &[Recording], seed: u64, draw: &mut Draw) -> Option<Self> {
        let recording = recordings.get(draw.index(recordings.len().max(1)))?;
        let axis = draw.index(recording.axes.len());
        let all = &recording.axes[axis];
        let longest = all.len().min(LONGEST);
        if longest < SHORTEST {
            return None;
        }
        let count = draw.log_uniform(SHORTEST as f64, longest as f64 + 1.0) as usize;
        let from = draw.index(all.len() - count + 1);
        let mut samples = all[from..from + count].to_vec();
        if !samples.iter().all(|sample| sample.is_finite()) {
            return None;
        }
        let measured = Measured::of(&samples, recording.rate_hz)?;
        let (n, k) = measured.ends();
        let code = code(&samples);
        if let Some(code) = code {
            // Codes count from the lowest.
            let lowest = samples.iter().copied().fold(f64::INFINITY, f64::min);
            samples.iter_mut().for_each(|sample| *sample -= lowest);
            round(&mut samples, code);
        }
        let mean = samples.iter().sum::<f64>() / count as f64;
        let base = Base {
            r: 0.0,
            k,
            b: 0.0,
            n,
            q: 0.0,
            mean,
        };
        Some(Self {
            seed,
            record: recording.name.clone(),
            axis,
            from,
            samples,
            code,
            scene: Scene {
                rate_hz: recording.rate_hz,
                samples: count,
                axes: vec![base],
                target: 0,
                chain: Chain::None,
                declared: true,
                relative: true,
                missing: 0.0,
                code: 0.0,
                measured: Some(Arc::new(measured)),
            },
        })
    }
}

impl Stretch {
    /// Share that rounding to codes has of the density at the top of the band; nothing where there are no codes.
    pub fn rounding(&self) -> f64 {
        let top_hz = 0.5 * self.scene.rate_hz;
        self.code.map_or(0.0, |code| {
            code * code / 12.0 / self.scene.rate_hz / self.scene.density(0, top_hz)
        })
    }

    /// Lets `samples` repeat themselves where the bare stretch does, as a slower sensor's do.
    pub fn repeat(&self, samples: &mut [f64]) {
        for i in 1..samples.len() {
            if self.samples[i] == self.samples[i - 1] {
                samples[i] = samples[i - 1];
            }
        }
    }

    /// Gives `samples` that an envelope changes what rounding to codes took from them, drawn evenly: codes that are made
    /// smaller and rounded once more fall together more often than those of a converter do.
    pub fn unround(&self, samples: &mut [f64], envelope: &[f64], draw: &mut Draw) {
        let Some(code) = self.code else {
            return;
        };
        for (sample, factor) in samples.iter_mut().zip(envelope) {
            if *factor != 1.0 {
                *sample += code * draw.uniform(-0.5, 0.5);
            }
        }
    }

    /// Puts `samples` on the grid of the codes, where there are codes.
    pub fn round(&self, samples: &mut [f64]) {
        if let Some(code) = self.code {
            round(samples, code);
        }
    }
}

fn round(samples: &mut [f64], code: f64) {
    for sample in samples {
        *sample = (*sample / code).round() * code;
    }
}

/// The smallest difference between two of the numbers, where all are multiples of it from the smallest on.
fn code(samples: &[f64]) -> Option<f64> {
    /// Share of a code that a number may be off: what few decimals leave of it.
    const OFF: f64 = 0.01;
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let differences = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let range = sorted.last()? - sorted[0];
    // What arithmetic makes of one number is one number.
    let plain = differences.filter(|one| *one > 1e-9 * range);
    let rough = plain.fold(f64::INFINITY, f64::min);
    let code = range / (range / rough).round();
    let is_multiple = |value: &f64| {
        let codes = (value - sorted[0]) / code;
        (codes - codes.round()).abs() < OFF
    };
    (code.is_finite() && sorted.iter().all(is_multiple)).then_some(code)
}
