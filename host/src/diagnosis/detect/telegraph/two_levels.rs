//! Two levels or a Gaussian wander: the same spectrum, distinguished by their amplitude law.
//!
//! The filter of N. Wiener (1949) gives the best view of the wander alone. Its excess kurtosis is
//! zero for Gaussian noise and tends to -2 for two levels, the less so the more the rest of the
//! record shines through. How much is found by sending both kinds of wander, with the fitted
//! parameters and the rest of the model, through the same filter.

use rand_distr::{Distribution, Exp1};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use realfft::num_complex::Complex64;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::statistic::matched_filter::{Transform, Transformer};
use crate::model::random::Gaussian;
use crate::model::random::Seed;

/// Simulated records of each kind: a choice. Their scatter is known with 7 degrees of freedom,
/// which Student's law allows for.
const RECORDS: usize = 8;

/// Samples of a long record that are looked at, from its start: the spread of the excess among
/// sixteen simulated records of a quick wander is small in as many.
const LONGEST: usize = 1 << 21;

/// Samples a correlation time that the slow copy must have to be used: means over a quarter of it
/// keep 92 % of the wander's variance.
const LEAST_PER_TIME: f64 = 4.0;

/// Logarithm of the odds for two levels against Markov noise, for a wander of standard deviation
/// `deviation` and correlation time `time_s` with the two-sided density `wander` at a frequency of
/// the samples, together with `rest`.
pub fn log_odds(
    axis: &AxisState,
    deviation: f64,
    time_s: f64,
    wander: impl Fn(f64) -> f64,
    rest: impl Fn(f64) -> f64,
) -> Option<f64> {
    let factor = axis.slow_factor();
    let slow = time_s * axis.rate_hz >= LEAST_PER_TIME * factor as f64;
    let (copy, seen);
    let (record, factor) = if slow {
        copy = axis.slow(&axis.filled, factor).0;
        (&copy, factor)
    } else if axis.filled.len() > LONGEST {
        copy = Transformer::new(LONGEST).transform(&axis.filled, axis.rate_hz);
        (&copy, 1)
    } else {
        seen = axis.whitened();
        (&seen.transform, 1)
    };
    let rate_hz = axis.rate_hz / factor as f64;
    let densities = |density: &dyn Fn(f64) -> f64| -> Vec<f64> {
        (0..record.ordinates().len())
            .map(|k| density(record.frequency(k.max(1)).min(0.499 * axis.rate_hz)))
            .collect()
    };
    let (wander, rest) = (densities(&wander), densities(&rest));
    // What is left of a tone has the law of a tone, far from that of noise.
    let mut left_out = axis.excluded_hz();
    left_out.extend(axis.tones_with_skirts_hz());
    let share = |k: usize| {
        let f_hz = record.frequency(k);
        let is_seen = !left_out.iter().any(|band| band.contains(&f_hz));
        is_seen.then_some(wander[k] / (wander[k] + rest[k]))
    };
    let filter: Vec<f64> = (0..wander.len())
        .map(|k| share(k).unwrap_or_default())
        .collect();
    let excess_of = |whole: &Transform| excess(&whole.filtered(|k| Complex64::new(filter[k], 0.0)));
    let transformer = Transformer::new(record.len());
    let dwell = 2.0 * time_s * rate_hz;
    let simulate = |two_levels: bool| -> (f64, f64) {
        let excesses: Vec<f64> = (0..RECORDS as u64)
            .into_par_iter()
            .map(|number| {
                let mut random = Random::new(number);
                let levels = if two_levels {
                    random.two_levels(record.len(), 2.0 * deviation, dwell)
                } else {
                    vec![0.0; record.len()]
                };
                let mut whole = transformer.transform(&levels, rate_hz);
                whole.add_noise(
                    |k| rest[k] + if two_levels { 0.0 } else { wander[k] },
                    || random.normal(),
                );
                excess_of(&whole)
            })
            .collect();
        let mean = excesses.iter().sum::<f64>() / RECORDS as f64;
        let square = excesses.iter().map(|one| (one - mean).powi(2)).sum::<f64>();
        (mean, (square / (RECORDS - 1) as f64).sqrt().max(1e-6))
    };
    let measured = excess_of(record);
    Some(score(measured, simulate(true)) - score(measured, simulate(false)))
}

/// Log-likelihood of an excess beside simulated ones of this mean and deviation: Student's law, as the spread itself
/// rests on few records.
fn score(measured: f64, (mean, sd): (f64, f64)) -> f64 {
    let freedom = (RECORDS - 1) as f64;
    let t = (measured - mean) / (sd * (1.0 + 1.0 / RECORDS as f64).sqrt());
    -0.5 * (freedom + 1.0) * (t * t / freedom).ln_1p() - sd.ln()
}

/// Excess kurtosis.
fn excess(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let moment = |power: i32| values.iter().map(|value| value.powi(power)).sum::<f64>() / count;
    let variance = moment(2);
    moment(4) / (variance * variance) - 3.0
}

/// Random numbers of one simulated record.
struct Random {
    uniform: Pcg64,
    normal: Gaussian,
}

impl Random {
    fn new(number: u64) -> Self {
        Self {
            uniform: Pcg64::new(0x5eed, u128::from(number)),
            normal: Gaussian::new(
                Seed {
                    seed: 0x5eed,
                    stream: number,
                },
                1.0,
            ),
        }
    }

    fn normal(&mut self) -> f64 {
        self.normal.draw()
    }

    /// Two levels that differ by `height`, each kept for `dwell` samples on average.
    fn two_levels(&mut self, length: usize, height: f64, dwell: f64) -> Vec<f64> {
        let mut level = 0.5 * height;
        let mut next = 0.0;
        (0..length)
            .map(|n| {
                while next <= n as f64 {
                    let wait: f64 = Exp1.sample(&mut self.uniform);
                    next += dwell * wait;
                    level = -level;
                }
                level
            })
            .collect()
    }
}
