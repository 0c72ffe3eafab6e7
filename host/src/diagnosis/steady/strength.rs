//! Noise whose power moves in time all along the record, not in single stretches.

use crate::diagnosis::record::powers::{BLOCK, Powers};
use crate::diagnosis::statistic::{matched_filter, p_value};
use crate::fft;

/// Ordinates that count as slow, and the share of all up to which sums of them are looked at, one
/// over this: choices.
const SLOW: usize = 16;
const SHARE: usize = 8;

/// A movement of the power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Movement {
    /// Its period, or for what has none the shortest that shows it best, samples.
    pub period: f64,
    /// Probability of as much in steady noise.
    pub p_value: f64,
}

/// How the power of the noise moves in time all along the record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wander {
    /// The most significant cycle of the power.
    pub cyclic: Movement,
    /// Neighbouring moments that are stronger or weaker together.
    pub slow: Movement,
}

/// Looks for cycles and for wander of the power, in its periodogram. What single samples do, and
/// single blocks, makes it white.
pub fn wander(powers: &Powers) -> Option<Wander> {
    let length = matched_filter::smooth_len(powers.powers.len());
    if length < 8 * SLOW {
        return None;
    }
    let whole_block = powers.counts.iter().copied().fold(0.0, f64::max);
    // A power of chi-squared law to the third is normal (E. B. Wilson and M. M. Hilferty 1931).
    let mut normal: Vec<f64> = powers.powers[..length]
        .iter()
        .zip(&powers.counts)
        .map(|(&power, &count)| {
            let part = 2.0 / (9.0 * count.max(1.0));
            if count < 0.5 * whole_block {
                0.0
            } else {
                (power.cbrt() - (1.0 - part)) / part.sqrt()
            }
        })
        .collect();
    let mean = normal.iter().sum::<f64>() / length as f64;
    normal.iter_mut().for_each(|value| *value -= mean);
    let variance = normal.iter().map(|value| value * value).sum::<f64>() / length as f64;
    let plan = fft::real_forward(length);
    let mut ordinates = plan.make_output_vec();
    plan.process(&mut normal, &mut ordinates).ok()?;
    let power = |k: usize| ordinates[k].norm_sqr() / (length as f64 * variance);
    let last = length / 2 - 1;
    let (strongest, highest) = (SLOW + 1..=last)
        .map(|k| (k, power(k)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (mut slow, mut sum, mut cutoffs) = ((1.0, SLOW), 0.0, 0.0);
    let mut cutoff = SLOW;
    for k in 1..=length / 2 / SHARE {
        sum += 2.0 * power(k);
        if k == cutoff {
            cutoffs += 1.0;
            let tail = p_value::chi_squared(sum, 2.0 * k as f64);
            if tail < slow.0 {
                slow = (tail, k);
            }
            cutoff *= 4;
        }
    }
    let period = |k: usize| (length * BLOCK) as f64 / k as f64;
    Some(Wander {
        cyclic: Movement {
            period: period(strongest),
            p_value: p_value::searched((-highest).exp(), (last - SLOW) as f64),
        },
        slow: Movement {
            period: period(slow.1),
            p_value: p_value::searched(slow.0, cutoffs),
        },
    })
}
