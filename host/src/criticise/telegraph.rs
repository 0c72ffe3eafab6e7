//! Two levels or a Gaussian wander: the same spectrum, told apart by their amplitude law.
//!
//! The record is averaged over blocks of an eighth of the correlation time. What else it holds is
//! nearly white at that pace. Two models of equal spectrum are then compared by their exact
//! likelihoods: a chain of two states (the forward recursion of L. E. Baum 1970) and a Markov
//! process (the filter of R. E. Kalman 1960), each with its own best parameters.

use super::axis::AxisState;
use super::mend::block_means;

/// Blocks a correlation time.
const PER_TIME: f64 = 8.0;

/// Blocks that a running mean spans, correlation times: slower wander is not theirs.
const WINDOW: f64 = 100.0;

/// A switching between two levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Telegraph {
    /// Distance of the levels.
    pub height: f64,
    /// Standard deviation of its logarithm.
    pub height_log_sd: f64,
    /// Mean time at a level, seconds.
    pub dwell_s: f64,
    /// Standard deviation of its logarithm.
    pub dwell_log_sd: f64,
    /// Logarithm of the odds against Markov noise.
    pub log_odds: f64,
}

/// Compares both for a wander of standard deviation `deviation` and correlation time `time_s` in
/// `values`; `rest` is the two-sided density of everything else near its corner.
pub fn compare(
    axis: &AxisState,
    values: &[f64],
    deviation: f64,
    time_s: f64,
    rest: f64,
) -> Option<Telegraph> {
    let factor = ((time_s * axis.rate_hz / PER_TIME) as usize).max(1);
    let dt = factor as f64 / axis.rate_hz;
    let series = without_wander(&block_means(values, factor), (WINDOW * PER_TIME) as usize);
    if series.len() < 64 {
        return None;
    }
    let noise = rest / dt;
    let chain = |log: [f64; 2]| two_states(&series, log[0].exp(), dt, log[1].exp(), noise);
    let markov = |log: [f64; 2]| gaussian(&series, log[0].exp(), dt, log[1].exp(), noise);
    // Height 2 sd, dwell 2 times the correlation time.
    let start = [(2.0 * deviation).ln(), (2.0 * time_s).ln()];
    let (best, two) = climb(start, chain);
    let (_, one) = climb([deviation.ln(), time_s.ln()], markov);
    let sd = |axis: usize| {
        let h = 0.02;
        let mut up = best;
        let mut down = best;
        up[axis] += h;
        down[axis] -= h;
        let bend = (2.0 * two - chain(up) - chain(down)) / (h * h);
        bend.max(1e-12).recip().sqrt()
    };
    Some(Telegraph {
        height: best[0].exp(),
        height_log_sd: sd(0),
        dwell_s: best[1].exp(),
        dwell_log_sd: sd(1),
        log_odds: two - one,
    })
}

/// Log-likelihood of two levels `height` apart with mean dwell `dwell_s`, seen in white noise.
fn two_states(series: &[f64], height: f64, dt: f64, dwell_s: f64, noise: f64) -> f64 {
    let switch = 0.5 * -(-2.0 * dt / dwell_s).exp_m1();
    let mut up = 0.5;
    let mut sum = 0.0;
    for value in series {
        let a = up * (1.0 - switch) + (1.0 - up) * switch;
        let score = |level: f64| -0.5 * (value - level).powi(2) / noise;
        let (high, low) = (score(0.5 * height), score(-0.5 * height));
        let top = high.max(low);
        let (p, q) = (a * (high - top).exp(), (1.0 - a) * (low - top).exp());
        sum += top + (p + q).ln();
        up = p / (p + q);
    }
    sum - 0.5 * series.len() as f64 * noise.ln()
}

/// Log-likelihood of Markov noise of standard deviation `deviation`, seen in white noise.
fn gaussian(series: &[f64], deviation: f64, dt: f64, time_s: f64, noise: f64) -> f64 {
    let keep = (-dt / time_s).exp();
    let stationary = deviation * deviation;
    let (mut state, mut variance) = (0.0, stationary);
    let mut sum = 0.0;
    for value in series {
        let total = variance + noise;
        let surprise = value - state;
        sum -= 0.5 * (total.ln() + surprise * surprise / total);
        let gain = variance / total;
        state = keep * (state + gain * surprise);
        variance = keep * keep * variance * (1.0 - gain) + stationary * (1.0 - keep * keep);
    }
    sum
}

/// The highest point near `start`, by turns along both axes.
fn climb(start: [f64; 2], value: impl Fn([f64; 2]) -> f64) -> ([f64; 2], f64) {
    let mut best = (start, value(start));
    let mut step = 0.3;
    while step > 1e-3 {
        let before = best.1;
        for axis in 0..2 {
            for way in [step, -step] {
                let mut trial = best.0;
                trial[axis] += way;
                let height = value(trial);
                if height > best.1 {
                    best = (trial, height);
                    break;
                }
            }
        }
        if best.1 <= before {
            step *= 0.5;
        }
    }
    best
}

/// Less a running mean over `window` values.
fn without_wander(series: &[f64], window: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    for value in series {
        sums.push(sums[sums.len() - 1] + value);
    }
    (0..series.len())
        .map(|n| {
            let from = n.saturating_sub(window / 2);
            let to = (n + window / 2 + 1).min(series.len());
            series[n] - (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}
