//! Noise whose power moves in time all along the record, not in single stretches.

use crate::diagnosis::record::powers::{BLOCK, Powers};
use crate::diagnosis::statistic::{matched_filter, p_value};
use crate::fft;

/// Ordinates that count as slow, and the share of all up to which sums of them are looked at, one
/// over this: choices.
const SLOW: usize = 16;
const SHARE: usize = 8;

/// Standard deviation that is left of a movement whose course is known, over its own, up to which the course is right: a
/// hundredth of its energy, as for a [line](crate::diagnosis::detect::lines). Of a strong one any imperfection shows.
pub const LEFT: f64 = 0.1;

/// A movement of the power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Movement {
    /// Its period, or for what has none the shortest that shows it best, samples.
    pub period: f64,
    /// Standard deviation of the power that moves, over its mean.
    pub sd: f64,
    /// Probability of as much in steady noise.
    pub p_value: f64,
}

impl Movement {
    /// Whether it is more than chance at a `level`, and more than what noise that is known to move by the standard deviation
    /// `known_sd` may leave.
    pub fn counts(&self, level: f64, known_sd: f64) -> bool {
        self.p_value < level && self.sd > LEFT * known_sd
    }
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
    let (mut slow, mut sum, mut cutoffs) = ((1.0, SLOW, 0.0), 0.0, 0.0);
    let mut cutoff = SLOW;
    for k in 1..=length / 2 / SHARE {
        sum += 2.0 * power(k);
        if k == cutoff {
            cutoffs += 1.0;
            let tail = p_value::chi_squared(sum, 2.0 * k as f64);
            if tail < slow.0 {
                slow = (tail, k, sum);
            }
            cutoff *= 4;
        }
    }
    let period = |k: usize| (length * BLOCK) as f64 / k as f64;
    // A small relative change of a power of `n` degrees of freedom moves the normal number by that, over the root of 2 / n.
    let unit = (2.0 / whole_block).sqrt();
    let sd = |power: f64| unit * (power * variance / length as f64).max(0.0).sqrt();
    Some(Wander {
        cyclic: Movement {
            period: period(strongest),
            sd: sd(2.0 * highest),
            p_value: p_value::searched((-highest).exp(), (last - SLOW) as f64),
        },
        slow: Movement {
            period: period(slow.1),
            sd: sd(slow.2 - 2.0 * slow.1 as f64),
            p_value: p_value::searched(slow.0, cutoffs),
        },
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::diagnosis::axis::AxisState;
    use crate::diagnosis::explanation::{Candidate, Change};
    use crate::diagnosis::record::envelope::Envelope;
    use crate::diagnosis::result::estimate::Estimate;
    use crate::model::burst;
    use crate::model::random::{Gaussian, Seed};

    /// Probability of as much in steady noise, in white noise whose deviation swings: as it is, and with the swing
    /// explained.
    fn both(seed: u64) -> [f64; 2] {
        let envelope = Envelope {
            depth: 0.4,
            period: 3000.0 + 37.0 * seed as f64,
            phase_rad: 0.3 * seed as f64,
        };
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let values = (0..100_000).map(|n| envelope.factor(n) * noise.draw());
        let values = Arc::new(values.collect());
        let mut axis = AxisState::new(values, 1000.0, None).expect("long enough");
        let least = |axis: &AxisState| {
            let Wander { cyclic, slow } = wander(&axis.powers()).expect("long enough");
            cyclic.p_value.min(slow.p_value)
        };
        let before = least(&axis);
        // Whatever the effect: what counts is the change.
        let change = Change::Strength(envelope);
        let candidate = Candidate::new(Estimate::of_law(burst::KIND), 0.0, 0.0, change);
        axis.accept(candidate).expect("nothing is fitted anew");
        [before, least(&axis)]
    }

    #[test]
    fn what_an_explanation_says_of_the_strength_is_seen_no_more() {
        let all: Vec<[f64; 2]> = (0..30).map(both).collect();
        for (seed, [before, _]) in all.iter().enumerate() {
            assert!(*before < 1e-12, "seed {seed}: {before:e}");
        }
        // The smaller of two probabilities is below 1 % in 2 % of records: of 30, five or more with a
        // probability of 3e-4.
        let seen = all.iter().filter(|[_, after]| *after < 0.01).count();
        assert!(seen < 5, "{seen} of seeds 0 to 29");
    }
}
