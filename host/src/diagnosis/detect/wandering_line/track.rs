//! A tone followed through windows of a band, and its power where it was foretold.
//!
//! The windows with even numbers say where the tone is in those with odd ones, and the other way round: the likeliest
//! course of the frequency (A. J. Viterbi, IEEE Trans. Inf. Theory 13, 1967; for tones: R. L. Streit and R. F. Barrett,
//! IEEE Trans. ASSP 38, 1990), interpolated. What a window has at a frequency that it did not help to choose is
//! exponential for noise, whatever its spectrum, and steadier for a tone: the same score as for
//! [tiles](crate::diagnosis::steady::noise) tells the two apart. Had each window chosen its own largest, noise would
//! look steady too.

use std::f64::consts::TAU;

use realfft::num_complex::Complex64;

use super::band::Band;
use super::window::power;
use crate::diagnosis::statistic::p_value;
use crate::fft;

/// Cells of frequency for each window: twice as many as it has samples.
const FINE: usize = 2;

/// Deviation of the frequency from one even window to the next, cells: within a window a tone that is worth following
/// moves by less than one of its own width.
const STEP: f64 = 2.0;

/// Steps that are tried, cells: beyond, the cost of a step is 8 nats.
const REACH: usize = 8;

/// Parts of the record by which the scatter of the score is measured: a choice. What they have in common, such as a
/// slow change of the noise's strength, counts once for each.
const PARTS: usize = 16;

/// A tone as it was followed.
pub struct Track {
    /// Samples of the band in a window.
    pub length: usize,
    /// Frequency in each window, ordinates of the band, as the window itself and those beside it say.
    pub places: Vec<f64>,
    /// Power in each window where the others foretold it, over the noise's.
    pub powers: Vec<f64>,
    /// Whether each window is of measured samples.
    pub counts: Vec<bool>,
}

/// What the powers of a track say.
#[derive(Debug, Clone, Copy)]
pub struct Steadiness {
    /// Energy of the tone in a window over the noise's.
    pub energy: f64,
    /// Probability that noise is as steady.
    pub p_value: f64,
    /// How steady: 0 as noise is, 1 as a tone of this energy is.
    pub share: f64,
}

impl Track {
    /// Follows the strongest tone of a band through windows of `length` samples.
    pub fn new(band: &Band, length: usize, counts: Vec<bool>) -> Self {
        let cells = FINE * length;
        let windows: Vec<&[Complex64]> = band.values.chunks_exact(length).collect();
        let plan = fft::forward(cells);
        let periodograms: Vec<Vec<f64>> = windows
            .iter()
            .map(|window| {
                let mut padded = window.to_vec();
                padded.resize(cells, Complex64::ZERO);
                plan.process(&mut padded);
                padded
                    .iter()
                    .map(|one| one.norm_sqr() / length as f64)
                    .collect()
            })
            .collect();
        let mut powers = vec![0.0; windows.len()];
        let mut places = vec![0.0; windows.len()];
        for parity in 0..2 {
            let own: Vec<&Vec<f64>> = periodograms.iter().skip(parity).step_by(2).collect();
            let path = path(&own);
            for (step, &cell) in path.iter().enumerate() {
                places[2 * step + parity] = own_place(own[step], cell);
            }
            // Between two of them, or beside the last one.
            let at = |window: usize| {
                let before = (window as isize - parity as isize).div_euclid(2);
                let last = path.len() as isize - 1;
                let of = |step: isize| path[step.clamp(0, last) as usize] as f64;
                0.5 * (of(before) + of(before + 1))
            };
            for window in (1 - parity..windows.len()).step_by(2) {
                powers[window] = power(windows[window], at(window) / cells as f64);
            }
        }
        let ordinates = band.values.len() as f64 / cells as f64;
        places.iter_mut().for_each(|place| *place *= ordinates);
        Self {
            length,
            places,
            powers,
            counts,
        }
    }

    /// Powers of the windows that count.
    pub fn counted(&self) -> impl Iterator<Item = f64> {
        let pairs = self.powers.iter().zip(&self.counts);
        pairs
            .filter(|(_, counts)| **counts)
            .map(|(power, _)| *power)
    }

    /// How steady the tone is; `None` where there are too few windows, or no tone.
    pub fn steadiness(&self) -> Option<Steadiness> {
        /// Windows at least: a tone without noise among them has a probability of 3e-5 then.
        const LEAST: usize = 32;
        let powers: Vec<f64> = self.counted().collect();
        let count = powers.len() as f64;
        let mean = powers.iter().sum::<f64>() / count;
        let energy = mean - 1.0;
        if powers.len() < LEAST || energy <= 0.0 {
            return None;
        }
        // Over their own mean, which takes 1/8 off; see `steady::noise`.
        let scores: Vec<f64> = powers
            .iter()
            .map(|power| (-power / mean).exp() - 0.5)
            .collect();
        let score = (scores.iter().sum::<f64>() + 0.125) / count;
        let shape = 4.0 * count / 3.0;
        let z = score * (48.0 * count).sqrt();
        // Where the scores of parts scatter by more than chance, less is sure.
        let parts: Vec<f64> = scores
            .chunks(scores.len().div_ceil(PARTS))
            .map(|part| part.iter().sum::<f64>() / part.len() as f64)
            .collect();
        let middle = parts.iter().sum::<f64>() / parts.len() as f64;
        let squares: f64 = parts.iter().map(|one| (one - middle).powi(2)).sum();
        let scatter = squares / (parts.len() - 1) as f64 * 48.0 * count / parts.len() as f64;
        let z = z / scatter.sqrt().max(1.0);
        let p_value = if z < 0.0 {
            p_value::mean_square((1.0 + z / shape.sqrt()).max(0.0), 2.0 * shape)
        } else {
            1.0
        };
        // E e^{-P/m} of a tone of this energy: P is a quarter of a non-central chi-squared of two degrees.
        let s = mean.recip();
        let of_tone = (-energy * s / (1.0 + s)).exp() / (1.0 + s) - 0.5;
        Some(Steadiness {
            energy,
            p_value,
            share: score / of_tone,
        })
    }

    /// Gain in log-likelihood of a tone of this energy over noise alone, at frequencies that other windows foretold.
    pub fn nats(&self, energy: f64) -> f64 {
        let gain = |power: f64| log_bessel(2.0 * (power * energy).sqrt()) - energy;
        self.counted().map(gain).sum()
    }
}

/// The likeliest cells of windows with these periodograms, one after another.
fn path(periodograms: &[&Vec<f64>]) -> Vec<usize> {
    let Some(first) = periodograms.first() else {
        return Vec::new();
    };
    let cells = first.len();
    let reach = REACH.min(cells - 1) as isize;
    let cost = |step: isize| 0.5 * (step as f64 / STEP).powi(2);
    let mut value = (*first).clone();
    let mut came_from: Vec<Vec<u32>> = Vec::with_capacity(periodograms.len());
    for own in &periodograms[1..] {
        let mut next = vec![f64::NEG_INFINITY; cells];
        let mut from = vec![0; cells];
        for (cell, (next, from)) in next.iter_mut().zip(&mut from).enumerate() {
            for step in -reach..=reach {
                let before = cell as isize + step;
                if before < 0 || before >= cells as isize {
                    continue;
                }
                let one = value[before as usize] - cost(step);
                if one > *next {
                    (*next, *from) = (one, before as u32);
                }
            }
            *next += own[cell];
        }
        value = next;
        came_from.push(from);
    }
    let best = (0..cells).max_by(|&a, &b| value[a].total_cmp(&value[b]));
    let mut cell = best.unwrap_or(0);
    let mut path = vec![cell];
    for from in came_from.iter().rev() {
        cell = from[cell] as usize;
        path.push(cell);
    }
    path.reverse();
    path
}

/// The top of a periodogram about a cell, between cells: through three points, of their roots, as the top of a
/// window's own shape is rounder than a parabola of powers.
fn own_place(periodogram: &[f64], cell: usize) -> f64 {
    let cells = periodogram.len();
    let near = [cell.saturating_sub(1), cell, (cell + 1).min(cells - 1)];
    let cell = near
        .into_iter()
        .max_by(|&a, &b| periodogram[a].total_cmp(&periodogram[b]))
        .unwrap_or(cell);
    if cell == 0 || cell + 1 == cells {
        return cell as f64;
    }
    let [low, top, high] = [cell - 1, cell, cell + 1].map(|k| periodogram[k].sqrt());
    let bend = 2.0 * top - low - high;
    if bend <= 0.0 {
        return cell as f64;
    }
    cell as f64 + (0.5 * (high - low) / bend).clamp(-0.5, 0.5)
}

/// `ln I0(x)`, to a few parts in a thousand of a nat: its series, or its asymptote.
fn log_bessel(x: f64) -> f64 {
    if x > 20.0 {
        return x - 0.5 * (TAU * x).ln() + (1.0 + 1.0 / (8.0 * x)).ln();
    }
    let quarter = 0.25 * x * x;
    let terms = (1..80).scan(1.0, |term, k| {
        *term *= quarter / f64::from(k * k);
        Some(*term)
    });
    (1.0 + terms.sum::<f64>()).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of windows of these powers.
    fn steadiness(powers: Vec<f64>) -> Option<Steadiness> {
        let count = powers.len();
        let track = Track {
            length: 8,
            places: vec![0.0; count],
            powers,
            counts: vec![true; count],
        };
        track.steadiness()
    }

    #[test]
    fn a_tone_has_32_windows_and_more_power_than_noise() {
        assert!(steadiness(vec![20.0; 32]).is_some());
        assert!(steadiness(vec![20.0; 31]).is_none(), "too few windows");
        assert!(steadiness(vec![0.9; 64]).is_none(), "no tone");
    }

    #[test]
    fn where_parts_of_the_record_differ_less_is_sure() {
        let count = 64 * PARTS;
        let power = |is_high: bool| if is_high { 9.0 } else { 3.0 };
        let p_value = |powers: Vec<f64>| steadiness(powers).expect("a tone").p_value;
        // The same powers, window by window and part by part.
        let mixed = p_value((0..count).map(|n| power(n % 2 == 0)).collect());
        let apart = p_value((0..count).map(|n| power(n / 64 % 2 == 0)).collect());
        assert!(apart > 1e6 * mixed, "{apart:e} and {mixed:e}");
    }
}
