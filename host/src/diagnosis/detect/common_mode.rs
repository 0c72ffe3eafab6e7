//! What axes have in common: noise that reaches several of them, each with a gain of its own.
//!
//! The cross-spectra of what is left of the axes after all else is taken out. Independent axes have
//! a squared coherence above `c` in a bin of `n` averages with probability `(1 - c)^(n - 1)` (G. C.
//! Carter, Proc. IEEE 75 (1987), eq. 34); over all bins together the real part of the normalised
//! cross-spectrum, weighed by the averages, is normal.

use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Finding;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::p_value;
use crate::model::common_mode::KIND;
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
    /// Its gain relative to the first axis; needs three axes.
    pub gain: Option<f64>,
    /// Standard deviation of the gain's logarithm.
    pub gain_log_sd: f64,
    /// Probability of as much between independent axes.
    pub p_value: f64,
}

/// What axes share with the first one at a family-wise `level`; `residuals` are what is left of
/// each, NaN where missing.
pub fn shared(residuals: &[Vec<f32>], rate_hz: f64, level: f64) -> Shared {
    let count = residuals.len();
    if count < 2 {
        return Shared::default();
    }
    let mut cascade = CrossCascade::new(count);
    let length = residuals.iter().map(Vec::len).min().unwrap_or(0);
    for first in (0..length).step_by(BLOCK) {
        let end = (first + BLOCK).min(length);
        let blocks: Vec<Vec<f64>> = residuals
            .iter()
            .map(|axis| axis[first..end].iter().map(|&v| f64::from(v)).collect())
            .collect();
        let columns: Vec<&[f64]> = blocks.iter().map(Vec::as_slice).collect();
        if cascade.push(first as u64, &columns).is_err() {
            return Shared::default();
        }
    }
    let pair = |a: usize, b: usize| cascade.cross(a, b, rate_hz, PER_OCTAVE);
    let pairs = (count * (count - 1) / 2) as f64;
    let axes: Vec<Common> = (1..count)
        .filter_map(|axis| {
            let bins = pair(0, axis);
            let p_value = p_value::searched(chance(&bins), pairs);
            if p_value >= level {
                return None;
            }
            // With a third axis: S_1k = g_k C, S_jk = g_j g_k C, so g_k = S_jk / S_1j.
            let other = (1..count).find(|&other| other != axis);
            let gain = other.map(|other| {
                let (near, far) = (pair(other, axis), pair(0, other));
                let sum = |bins: &[CrossBin]| -> (f64, f64) {
                    // One weight for both, that of the first pair's own noise.
                    let (mut sum, mut variance) = (0.0, 0.0);
                    for (bin, reference) in bins.iter().zip(&far) {
                        let own = reference.density.norm() / reference.coherence.sqrt();
                        let weight = reference.averages / own;
                        let power = bin.density.norm_sqr() / bin.coherence;
                        sum += weight * bin.density.re;
                        variance += weight * weight * power / (2.0 * bin.averages);
                    }
                    (sum, variance / (sum * sum))
                };
                let ((near, a), (far, b)) = (sum(&near), sum(&far));
                (near / far, (a + b).sqrt())
            });
            Some(Common {
                axis,
                gain: gain.map(|gain| gain.0),
                gain_log_sd: gain.map_or(f64::INFINITY, |gain| gain.1),
                p_value,
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
    let enough = || bins.iter().filter(|bin| bin.averages > 2.0);
    let in_one = enough()
        .map(|bin| ((bin.averages - 1.0) * (-bin.coherence).ln_1p()).exp())
        .fold(1.0, f64::min);
    let (mut sum, mut variance) = (0.0, 0.0);
    for bin in enough() {
        sum += bin.averages * normalised(bin);
        variance += 0.5 * bin.averages;
    }
    let together = p_value::two_sided(sum / variance.sqrt());
    p_value::searched(in_one, enough().count() as f64).min(together) * 2.0
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
        check: KIND.check(&[common.gain.unwrap_or(f64::NAN)]),
        ..Finding::new(&estimate, common.p_value)
    }
}
