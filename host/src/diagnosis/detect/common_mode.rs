//! What axes have in common: noise that reaches several of them, each with a gain of its own.
//!
//! The cross-spectra of what is left of the axes after all else is taken out. Independent axes have
//! a squared coherence above `c` in a bin of `n` averages with probability `(1 - c)^(n - 1)` (G. C.
//! Carter, Proc. IEEE 75 (1987), eq. 34); over all bins together the real part of the normalised
//! cross-spectrum, weighed by the averages, is normal. What two axes share in one half of the record they have to share
//! in the other: slow courses that look alike once are not shared.

use std::ops::Range;

use crate::diagnosis::held_out::ENOUGH_NATS;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::{Finding, Gain};
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::p_value;
use crate::model::common_mode::KIND;
use crate::numeric::order::median;
use crate::spectrum::CrossCascade;
use crate::spectrum::cross::CrossBin;

/// Tests that it makes: its share of the family's level.
pub const TESTS: u32 = 1;

/// Bands an octave: a choice. What axes share in a narrower band is diluted in it; more bands would
/// have fewer averages each.
const PER_OCTAVE: f64 = 2.0;

/// Samples handed over at a time: half a mebibyte an axis.
const BLOCK: usize = 1 << 16;

/// Noise that the axes of a record share.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shared {
    /// Axes that share something with the first one.
    pub axes: Vec<Common>,
    /// Correlation of all axes, one row each, 0 where nothing is shared; `None` where nothing is at all.
    /// Over the whole band, so that it is that of the white noise.
    pub correlation: Option<Vec<Vec<f64>>>,
}

/// What one axis has in common with the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Common {
    /// Number of the axis, from 0.
    pub axis: usize,
    /// Its gain relative to the first axis; needs three axes, and something that the third shares with both.
    pub gain: Option<f64>,
    /// Standard deviation of the gain's logarithm.
    pub gain_log_sd: f64,
    /// Probability of as much between independent axes.
    pub p_value: f64,
    /// Gain in log-likelihood of each half of the record, by what the other half shares, nats.
    pub held_out_nats: f64,
    /// Largest share of the two axes' power that is shared, in any band.
    pub share: f64,
}

/// Most that a gain's logarithm may scatter for the gain to be given: with three of these on either side it is not zero.
const KNOWN: f64 = 1.0 / 3.0;

/// What axes share with the first one at a family-wise `level`; `residuals` are what is left of
/// each, NaN where missing.
pub fn shared(residuals: &[Vec<f32>], rate_hz: f64, level: f64) -> Shared {
    let count = residuals.len();
    if count < 2 {
        return Shared::default();
    }
    let length = residuals.iter().map(Vec::len).min().unwrap_or(0);
    let whole = spectra(residuals, 0..length);
    let halves = [0..length / 2, length / 2..length].map(|half| spectra(residuals, half));
    let (Some(whole), [Some(first), Some(second)]) = (whole, halves) else {
        return Shared::default();
    };
    let pair = |a: usize, b: usize| whole.cross(a, b, rate_hz, PER_OCTAVE);
    let pairs = (count * (count - 1) / 2) as f64;
    let axes: Vec<Common> = (1..count)
        .filter_map(|axis| {
            let bins = pair(0, axis);
            let p_value = p_value::searched(chance(&bins), pairs);
            if p_value >= level {
                return None;
            }
            let halves = [&first, &second].map(|half| half.cross(0, axis, rate_hz, PER_OCTAVE));
            let held_out_nats = nats(&halves[0], &halves[1]) + nats(&halves[1], &halves[0]);
            if held_out_nats <= ENOUGH_NATS {
                return None;
            }
            // With a third axis: S_1k = g_k C, S_jk = g_j g_k C, so g_k = S_jk / S_1j.
            let other = (1..count).find(|&other| other != axis);
            let gain = other.map(|other| gain(&pair(other, axis), &pair(0, other)));
            let gain = gain.filter(|(_, log_sd)| *log_sd < KNOWN);
            Some(Common {
                axis,
                gain: gain.map(|gain| gain.0),
                gain_log_sd: gain.map_or(f64::INFINITY, |gain| gain.1),
                p_value,
                held_out_nats,
                share: share(&bins),
            })
        })
        .collect();
    let shares = |axis: usize| axis == 0 || axes.iter().any(|one| one.axis == axis);
    let correlation = |a: usize, b: usize| match (a == b, shares(a) && shares(b)) {
        (true, _) => 1.0,
        (_, true) => correlation(&pair(a, b)),
        _ => 0.0,
    };
    let row = |a: usize| (0..count).map(|b| correlation(a, b)).collect();
    Shared {
        correlation: (!axes.is_empty()).then(|| (0..count).map(row).collect()),
        axes,
    }
}

/// Cross-spectra of a stretch of the axes; `None` where there are none.
fn spectra(residuals: &[Vec<f32>], stretch: Range<usize>) -> Option<CrossCascade> {
    let mut cascade = CrossCascade::new(residuals.len());
    for first in stretch.clone().step_by(BLOCK) {
        let end = (first + BLOCK).min(stretch.end);
        let blocks: Vec<Vec<f64>> = residuals
            .iter()
            .map(|axis| axis[first..end].iter().map(|&v| f64::from(v)).collect())
            .collect();
        let columns: Vec<&[f64]> = blocks.iter().map(Vec::as_slice).collect();
        cascade.push(first as u64, &columns).ok()?;
    }
    Some(cascade)
}

/// Quotient of two cross-spectra over all bands, with the standard deviation of its logarithm.
fn gain(near: &[CrossBin], far: &[CrossBin]) -> (f64, f64) {
    let own = [near, far].map(|bins| bins.iter().map(own_power).collect::<Vec<f64>>());
    let ratios = own[0].iter().zip(&own[1]).map(|(near, far)| near / far);
    let usual = median(&mut ratios.collect::<Vec<f64>>()).unwrap_or(1.0);
    // One weight for both: a band in which either pair is all but silent would be all of the quotient if the other's power did not
    // count.
    let powers = own[0].iter().zip(&own[1]);
    let weights = powers
        .zip(far)
        .map(|((near, far), bin)| bin.averages / near.max(usual * far));
    let weights: Vec<f64> = weights.collect();
    let sum = |bins: &[CrossBin], own: &[f64]| -> (f64, f64) {
        let (mut sum, mut variance) = (0.0, 0.0);
        for ((bin, own), weight) in bins.iter().zip(own).zip(&weights) {
            sum += weight * bin.density.re;
            variance += (weight * own).powi(2) / (2.0 * bin.averages);
        }
        (sum, variance / (sum * sum))
    };
    let ((near, a), (far, b)) = (sum(near, &own[0]), sum(far, &own[1]));
    (near / far, (a + b).sqrt())
}

/// Geometric mean of the densities of a pair of axes in a band.
fn own_power(bin: &CrossBin) -> f64 {
    bin.density.norm() / bin.coherence.sqrt()
}

/// Gain in log-likelihood of the axes' spectra in one half of a record by the correlation that they have in the other:
/// one correlation in all bands, or that of the plainest band alone, whichever is rarer by chance there. For `n` products
/// and a correlation `r` where `c` is expected it is `n (2 (c r - c^2) / (1 - c^2) - ln(1 - c^2))`, that of two complex
/// normal numbers.
fn nats(fitted: &[CrossBin], held: &[CrossBin]) -> f64 {
    /// Correlation that is expected at most: a choice.
    const MOST: f64 = 0.999;
    /// Distance of two bands that are the same, in `ln f`: less than that of neighbours, half an octave.
    const SAME: f64 = 0.25;
    let plainest = enough(fitted).min_by(|a, b| in_band(a).total_cmp(&in_band(b)));
    let Some(plainest) = plainest else {
        return 0.0;
    };
    let gain = |bin: &CrossBin, expected: f64| {
        // Copies of one axis share all of it, and there is no logarithm of nothing.
        let expected = expected.clamp(-MOST, MOST);
        let square = expected * expected;
        let product = expected * normalised(bin) - square;
        bin.averages * (2.0 * product / (1.0 - square) - (-square).ln_1p())
    };
    let bands = enough(fitted).count() as f64;
    if p_value::searched(in_band(plainest), bands) < together(fitted) {
        let same = |bin: &&CrossBin| (bin.f_hz / plainest.f_hz).ln().abs() < SAME;
        return enough(held)
            .find(same)
            .map_or(0.0, |bin| gain(bin, normalised(plainest)));
    }
    let all = correlation(fitted);
    enough(held).map(|bin| gain(bin, all)).sum()
}

/// Largest share of the power of two axes that is shared, in any band, where they have equal parts in it: at least, with
/// two standard deviations taken off.
fn share(bins: &[CrossBin]) -> f64 {
    let least = |bin: &CrossBin| normalised(bin).abs() - 2.0 * (2.0 * bin.averages).sqrt().recip();
    enough(bins).map(least).fold(0.0, f64::max)
}

/// Bands of more than two averages.
fn enough(bins: &[CrossBin]) -> impl Iterator<Item = &CrossBin> {
    bins.iter().filter(|bin| bin.averages > 2.0)
}

/// Probability of as much coherence in a band by chance.
fn in_band(bin: &CrossBin) -> f64 {
    ((bin.averages - 1.0) * (-bin.coherence).ln_1p()).exp()
}

/// Probability of as much in all bands together by chance.
fn together(bins: &[CrossBin]) -> f64 {
    let (mut sum, mut variance) = (0.0, 0.0);
    for bin in enough(bins) {
        sum += bin.averages * normalised(bin);
        variance += 0.5 * bin.averages;
    }
    p_value::two_sided(sum / variance.sqrt())
}

/// Correlation over all bins: their normalised cross-spectra, weighed by the averages.
fn correlation(bins: &[CrossBin]) -> f64 {
    let (mut sum, mut averages) = (0.0, 0.0);
    for bin in bins {
        sum += bin.averages * normalised(bin);
        averages += bin.averages;
    }
    sum / averages
}

/// Real part of the cross-spectrum over the root of the axes' own.
fn normalised(bin: &CrossBin) -> f64 {
    bin.density.re / bin.density.norm() * bin.coherence.sqrt()
}

/// Probability of as much in common by chance: in one band, or over all together.
fn chance(bins: &[CrossBin]) -> f64 {
    let in_one = enough(bins).map(in_band).fold(1.0, f64::min);
    let in_one = p_value::searched(in_one, enough(bins).count() as f64);
    in_one.min(together(bins)) * 2.0
}

/// What is shared, as a finding of one axis.
pub fn finding(common: &Common) -> Finding {
    let gain = common
        .gain
        .map(|gain| Value::normal(gain, gain.abs() * common.gain_log_sd));
    let estimate = Estimate {
        kind: KIND,
        values: vec![gain],
    };
    Finding {
        gain: Gain {
            heldout_nats: Some(common.held_out_nats),
            // Of the deviation, when the shared power goes.
            allan_change_percent: Some(100.0 * (1.0 - (1.0 - common.share).max(0.0).sqrt())),
            ..Gain::default()
        },
        check: KIND.check(&[common.gain.unwrap_or(f64::NAN)]),
        ..Finding::new(&estimate, common.p_value)
    }
}

#[cfg(test)]
mod tests;
