//! Motions sample by sample: each stretch's noise about its own level.

use super::envelope::Envelope;
use super::level::Level;
use crate::model::random::Generator;
use crate::model::unnamed::Band;

/// One stretch.
pub(super) struct Passing {
    /// The level about which it moves.
    level: Level,
    /// Mean of its noise, which is taken out, as it comes up and fades.
    mean: f64,
    /// Factor on what is left of its noise.
    factor: f64,
    noise: Box<dyn Generator>,
}

/// Samples that are made at once: a choice.
const BLOCK: usize = 4096;

impl Passing {
    /// About a `level`, with the noise of a `band` as it is `drawn` the first time, the second, and so on.
    ///
    /// What turns while it lasts had the energy that was measured: it is drawn until it has that, but for a tenth, and
    /// sized by what is left. Slower noise, which has lost the most of it with its mean, is drawn once.
    pub fn new(level: Level, band: &Band, drawn: impl Fn(u64) -> Box<dyn Generator>) -> Self {
        /// Draws at most, and how far the energy may be from what was measured: choices. One of 14 draws of noise that turns
        /// a few times is as near; of 32 there is none in one case of ten, and the nearest is taken.
        const DRAWS: u64 = 32;
        const NEAR: f64 = 0.1;
        let envelope = level.envelope;
        let told = band.amplitude.powi(2) * envelope.length() as f64;
        let is_told = band.width_hz < band.f_hz && told > 0.0;
        let draws = if is_told { DRAWS } else { 1 };
        let off = |left: f64| (left / told).ln().abs();
        let mut nearest: Option<(u64, [f64; 2])> = None;
        for draw in 0..draws {
            let (mean, left) = left(&envelope, drawn(draw));
            if nearest.is_none_or(|(_, [_, before])| off(left) < off(before)) {
                nearest = Some((draw, [mean, left]));
            }
            if off(left) < NEAR {
                break;
            }
        }
        let (draw, [mean, left]) = nearest.unwrap_or_default();
        Self {
            level,
            mean,
            factor: if is_told && left > 0.0 {
                (told / left / envelope.mean_square()).sqrt()
            } else {
                envelope.mean_square().sqrt().recip()
            },
            noise: drawn(draw),
        }
    }

    fn add_to(&mut self, first: u64, samples: &mut [f64]) {
        let end = first + samples.len() as u64;
        let (from, to) = (self.level.from.max(first), self.level.to().min(end));
        if from < to {
            let part = &mut samples[(from - first) as usize..(to - first) as usize];
            let mut number = from - self.level.from;
            for block in part.chunks_mut(BLOCK) {
                let mut noise = vec![0.0; block.len()];
                self.noise.add_to(&mut noise);
                for (sample, noise) in block.iter_mut().zip(noise) {
                    let own = self.factor * self.level.envelope.at(number);
                    *sample += own * (noise - self.mean);
                    number += 1;
                }
            }
        }
        self.level.add_to(first, samples);
    }
}

/// The mean of some `noise` as it comes up and fades, and the energy of what is left without that, over the envelope's mean square.
fn left(envelope: &Envelope, mut noise: Box<dyn Generator>) -> (f64, f64) {
    // Sums of the noise times the envelope, times its square, and of the square of both.
    let (mut once, mut twice, mut squares, mut number) = (0.0, 0.0, 0.0, 0);
    while number < envelope.length() {
        let count = (envelope.length() - number).min(BLOCK as u64);
        let mut block = vec![0.0; count as usize];
        noise.add_to(&mut block);
        for value in block {
            let e = envelope.at(number);
            once += e * value;
            twice += e * e * value;
            squares += (e * value).powi(2);
            number += 1;
        }
    }
    let length = envelope.length() as f64;
    let mean = once / (length * envelope.mean());
    let square = envelope.mean_square();
    let left = squares - 2.0 * mean * twice + mean * mean * length * square;
    (mean, left / square)
}

/// All of them.
pub(super) struct Moved {
    pub(super) stretches: Vec<Passing>,
    pub(super) index: u64,
}

impl Generator for Moved {
    fn add_to(&mut self, samples: &mut [f64]) {
        for one in &mut self.stretches {
            one.add_to(self.index, samples);
        }
        self.index += samples.len() as u64;
    }
}
