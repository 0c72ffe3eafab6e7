//! Lines of a few cycles in the record: what a thermostat, an air conditioner or the day makes of the level.
//!
//! So far down neighbours are few, and noise that wanders is steep: the search by neighbours alone begins at
//! [`LEAST_CYCLES`]. Here a line has to stand out of the fitted law, of the ordinates beside it, and of those below, where a
//! course that goes anywhere has the more.

use crate::diagnosis::axis::AxisState;
use crate::numeric::order::median;
use crate::spectrum::record_lines::LEAST_CYCLES;

/// Cycles at least: a choice. Fewer turns are a course of the level like any other.
pub const FEWEST: usize = 5;

/// Ordinates beside a line that are its own: between two it has 2 % of its power 2 away.
const OWN: usize = 2;

/// Ordinates on either side that it is held against.
const BESIDE: usize = 10;

/// Gain over the threshold of a known density that a line has to have: a choice. The law is known to a factor there, and the
/// median of sixteen ordinates to a third.
const SURE: f64 = 2.0;

/// Power of a line over the largest of those below it: a choice. A course has more there, and a line off the ordinates leaves
/// a thirtieth.
const OVER_SLOWER: f64 = 8.0;

/// A slow line.
pub struct Slow {
    /// About its frequency, hertz.
    pub f_hz: f64,
    /// Power over the floor.
    pub ratio: f64,
    /// Probability of as much anywhere among the slow ordinates.
    pub p_value: f64,
}

/// The slow lines of an axis at this `level`, the slowest first.
pub fn lines(axis: &AxisState, level: f64) -> Vec<Slow> {
    let seen = axis.whitened();
    let top = (LEAST_CYCLES as usize + BESIDE).min(seen.top);
    // A band that is excluded has no finite density, and no power.
    let power = |k: usize| {
        seen.transform.ordinates()[k].norm_sqr() / (seen.transform.power() * seen.density[k])
    };
    let powers: Vec<f64> = (0..top).map(power).collect();
    let count = LEAST_CYCLES;
    let find = |k: usize| {
        let ratio = ratio(&powers, k)?;
        let p_value = (count * (-ratio / SURE).exp()).min(1.0);
        let f_hz = seen.transform.frequency(k);
        (p_value < level).then_some(Slow {
            f_hz,
            ratio,
            p_value,
        })
    };
    let last = (LEAST_CYCLES as usize).min(top.saturating_sub(BESIDE));
    (FEWEST..last).filter_map(find).collect()
}

/// Power of ordinate `k` over what stands beside it; `None` where it is no line.
fn ratio(powers: &[f64], k: usize) -> Option<f64> {
    let own = powers[k];
    let is_top = own >= powers[k - 1] && own > powers[k + 1];
    let below = powers[k.saturating_sub(BESIDE).max(1)..k - OWN + 1].iter();
    let slower = below.copied().fold(0.0, f64::max);
    if !is_top || own < OVER_SLOWER * slower {
        return None;
    }
    let lower = (k.saturating_sub(BESIDE).max(1)..k).rev().skip(OWN);
    let upper = (k + 1 + OWN..k + 1 + BESIDE).filter(|&j| j < powers.len());
    let mut beside: Vec<f64> = lower.chain(upper).map(|j| powers[j]).collect();
    // The median of an exponential law is ln 2 of its mean.
    let floor = median(&mut beside)? / std::f64::consts::LN_2;
    Some(own / floor.max(1.0))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::diagnosis::detect::trial::{LEVEL, Trial, noise};

    /// Frequencies of the slow lines of noise with a course, as cycles a record.
    fn found(seed: u64, course: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut values = noise(seed);
        let count = values.len() as f64;
        for (n, value) in values.iter_mut().enumerate() {
            *value += course(n as f64 / count);
        }
        let trial = Trial::new(values);
        let lines = lines(&trial.axis, LEVEL);
        let duration_s = trial.axis.filled.len() as f64 / trial.axis.rate_hz;
        lines.iter().map(|one| one.f_hz * duration_s).collect()
    }

    #[test]
    fn a_line_of_few_cycles_is_found() {
        for (seed, cycles) in [(0, 14.3), (1, 25.0), (2, 40.5)] {
            let lines = found(seed, |share| (TAU * cycles * share).cos());
            assert!(
                matches!(lines[..], [one] if (one - cycles).abs() < 1.0),
                "seed {seed}: {lines:?}"
            );
        }
    }

    #[test]
    fn noise_and_courses_that_do_not_turn_evenly_are_none() {
        for seed in 10..40 {
            assert!(found(seed, |_| 0.0).is_empty(), "seed {seed}");
        }
        for seed in 40..44 {
            let step = |share: f64| if share > 0.37 { 1.0 } else { 0.0 };
            assert!(found(seed, step).is_empty(), "seed {seed}: a step");
            let slow = |share: f64| (TAU * 1.3 * share).sin() + 0.4 * (TAU * 2.7 * share).cos();
            assert!(found(seed, slow).is_empty(), "seed {seed}: a course");
            let settles = |share: f64| 3.0 * (-share / 0.03).exp();
            assert!(found(seed, settles).is_empty(), "seed {seed}: a settling");
        }
    }
}
