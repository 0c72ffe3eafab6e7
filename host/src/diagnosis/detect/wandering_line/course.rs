//! How far and how fast a followed frequency wanders.
//!
//! Between the middles of two windows the phase turns by the mean frequency between them. That frequency is the
//! integral of the process, and the phases' own errors leave differences of white noise. The cosine transform makes
//! the two nearly independent coefficients of known variances, whose likelihood (P. Whittle, 1953) is summed over all
//! correlation times that the record can hold.

use std::f64::consts::{PI, TAU};

use super::band::Band;
use super::straight::{bridge, cosine_coefficients, without_straight};
use super::track::Track;
use super::window::phasor;
use crate::diagnosis::result::value::Value;

/// Correlation times that are tried, each over the one before: a choice, a tenth of an e-fold.
const TIMES: f64 = 1.1;

/// Rounds of the squares' likelihood: they gain 1e-6 nats in the last one.
const ROUNDS: usize = 40;

/// Frequencies at least: fewer say nothing of a correlation time.
const LEAST: usize = 16;

/// A course of the frequency.
#[derive(Debug, Clone, Copy)]
pub struct Course {
    /// Mean frequency, hertz.
    pub f_hz: Value,
    /// Root mean square about it, hertz.
    pub wander_hz: Value,
    /// Correlation time, seconds.
    pub wander_s: Value,
    /// Gain in log-likelihood over a frequency that stands still.
    pub nats: f64,
    /// What it gains on top of that if it goes straight from one end of the record to the other as well.
    pub straight_nats: f64,
    /// How far it goes so, hertz.
    pub straight_hz: f64,
}

impl Course {
    /// Whether it runs up or down, and far: a process that wanders comes back.
    pub fn goes_one_way(&self) -> bool {
        /// Share of its frequency from which that is far: a choice. A clock that drifts against the samples' stays below.
        const FAR: f64 = 0.05;
        /// Least gain, nats: wandering by itself has more once in 100 000 records, as half a chi-squared of one degree.
        const LEAST: f64 = 10.0;
        self.straight_nats > LEAST && self.straight_hz > FAR * self.f_hz.value
    }
}

/// The course of a track; `None` where it has too few windows.
pub fn course(band: &Band, track: &Track) -> Option<Course> {
    let mut frequencies = frequencies(band, track);
    let count = frequencies.len();
    let counts = track.counts.windows(2).map(|two| two[0] && two[1]);
    let counts: Vec<bool> = counts.collect();
    let counted = || {
        frequencies
            .iter()
            .zip(&counts)
            .filter(|(_, counts)| **counts)
    };
    if counted().count() < LEAST {
        return None;
    }
    let step_s = track.length as f64 / band.rate_hz();
    let mean = counted().map(|(f_hz, _)| f_hz).sum::<f64>() / counted().count() as f64;
    // Where nothing was measured it went straight on, as far as is known.
    bridge(&mut frequencies, &counts);
    let coefficients = cosine_coefficients(frequencies.iter().map(|f_hz| f_hz - mean));
    let square = |one: &f64| one * one;
    let powers: Vec<f64> = coefficients.iter().map(square).collect();
    let angles: Vec<f64> = (1..count).map(|j| PI * j as f64 / count as f64).collect();
    let errors: Vec<f64> = angles.iter().map(|a| 2.0 - 2.0 * a.cos()).collect();
    let still = fit(&powers, &errors, None)?;
    let longest_s = 0.5 * band.duration_s;
    let times = std::iter::successors(Some(0.5 * step_s), |time_s| Some(time_s * TIMES));
    let times = times.take_while(|time_s| *time_s < longest_s);
    let times: Vec<f64> = times.collect();
    let moves_of = |time_s: f64| -> Vec<f64> {
        let moves = angles.iter().map(|&a| spectrum(a, step_s / time_s));
        moves.collect()
    };
    let of_all = |powers: &[f64]| -> Vec<(f64, Fit)> {
        let at = |&time_s: &f64| Some((time_s, fit(powers, &errors, Some(&moves_of(time_s)))?));
        times.iter().filter_map(at).collect()
    };
    let fits = of_all(&powers);
    let best = highest(&fits);
    let (time_s, at_best) = fits.iter().find(|(_, fit)| fit.value == best)?;
    let weights: Vec<f64> = fits
        .iter()
        .map(|(_, fit)| (fit.value - best).exp())
        .collect();
    let wander_hz = at_best.moves.sqrt();
    // The mean of a process of the correlation time `time_s` over the record.
    let mean_sd = (2.0 * at_best.moves * time_s / band.duration_s)
        .min(at_best.moves)
        .sqrt();
    let errors_sd = at_best.errors.sqrt() / count as f64;
    let expected: Vec<f64> = errors
        .iter()
        .zip(moves_of(*time_s))
        .map(|(error, moved)| at_best.errors * error + at_best.moves * moved)
        .collect();
    let (left, straight_hz) = without_straight(&coefficients, &expected);
    Some(Course {
        f_hz: Value::normal(mean, mean_sd.hypot(errors_sd)),
        wander_hz: mixed(wander_hz, &fits, &weights),
        wander_s: times_interval(*time_s, &fits, &weights),
        nats: best - still.value,
        straight_nats: highest(&of_all(&left)) - best,
        straight_hz,
    })
}

fn highest(fits: &[(f64, Fit)]) -> f64 {
    let values = fits.iter().map(|(_, fit)| fit.value);
    values.fold(f64::NEG_INFINITY, f64::max)
}

/// Mean frequencies between the middles of neighbouring windows, hertz.
fn frequencies(band: &Band, track: &Track) -> Vec<f64> {
    let len = band.values.len() as f64;
    let windows = band.values.chunks_exact(track.length);
    let phases: Vec<f64> = windows
        .zip(&track.places)
        .map(|(window, place)| phasor(window, place / len).arg() / TAU)
        .collect();
    let length = track.length as f64;
    let between = phases.windows(2).zip(track.places.windows(2));
    between
        .map(|(phase, place)| {
            let cycles = 0.5 * (place[0] + place[1]) / len;
            let foretold = cycles * length;
            let turned = phase[1] - phase[0] - foretold;
            let turns = foretold + turned - turned.round();
            band.frequency_hz(turns / length * len)
        })
        .collect()
}

/// Spectrum at an angle of means over steps of a process of variance 1 whose correlation falls by `e^-decay` a step.
fn spectrum(angle: f64, decay: f64) -> f64 {
    let keep = (-decay).exp();
    let fall = -(-decay).exp_m1();
    let own = 2.0 * (decay - fall) / (decay * decay);
    let next = (fall / decay).powi(2);
    let (cosine, spread) = (angle.cos(), 1.0 + keep * keep);
    own + 2.0 * next * (cosine - keep) / (spread - 2.0 * keep * cosine)
}

/// Squares of both parts, and their likelihood.
#[derive(Debug, Clone, Copy)]
struct Fit {
    errors: f64,
    moves: f64,
    /// Variance of the logarithm of `moves`.
    log_variance: f64,
    value: f64,
}

/// The likeliest squares of errors and of moves: by the multiplicative steps of C. Fevotte, N. Bertin and
/// J.-L. Durrieu (Neural Computation 21, 2009), which keep them above zero.
fn fit(powers: &[f64], errors: &[f64], moves: Option<&[f64]>) -> Option<Fit> {
    let nothing = vec![0.0; powers.len()];
    let moves = moves.unwrap_or(&nothing);
    let mean = |part: &[f64]| -> f64 {
        let ratios = powers.iter().zip(part).map(|(power, part)| power / part);
        ratios.sum::<f64>() / powers.len() as f64
    };
    let (mut a, mut b) = (mean(errors), 0.0);
    let both = moves.iter().any(|one| *one > 0.0);
    if both {
        a *= 0.5;
        b = powers.iter().sum::<f64>() / moves.iter().sum::<f64>();
    }
    let each = || powers.iter().zip(errors).zip(moves);
    for _ in 0..ROUNDS {
        let mut sums = [0.0; 4];
        for ((power, error), moved) in each() {
            let expected = a * error + b * moved;
            let (first, second) = (expected.recip(), power / (expected * expected));
            sums[0] += error * second;
            sums[1] += error * first;
            sums[2] += moved * second;
            sums[3] += moved * first;
        }
        a *= (sums[0] / sums[1]).sqrt();
        if both {
            b *= (sums[2] / sums[3]).sqrt();
        }
    }
    // Real coefficients: half a chi-squared of one degree each.
    let (mut value, mut information) = (0.0, [0.0; 3]);
    for ((power, error), moved) in each() {
        let expected = a * error + b * moved;
        value -= 0.5 * (expected.ln() + power / expected);
        let shares = [a * error / expected, b * moved / expected];
        information[0] += 0.5 * shares[0] * shares[0];
        information[1] += 0.5 * shares[0] * shares[1];
        information[2] += 0.5 * shares[1] * shares[1];
    }
    let determinant = information[0] * information[2] - information[1] * information[1];
    let log_variance = if determinant > 1e-12 {
        information[0] / determinant
    } else {
        information[2].recip()
    };
    (value.is_finite()).then_some(Fit {
        errors: a,
        moves: b,
        log_variance,
        value,
    })
}

/// The root of the moves with what their own error and that of the correlation time leave: a mixture of log-normal
/// laws, one for each time.
fn mixed(value: f64, fits: &[(f64, Fit)], weights: &[f64]) -> Value {
    let total: f64 = weights.iter().sum();
    let usable = || {
        fits.iter()
            .zip(weights)
            .filter(|((_, fit), _)| fit.moves > 0.0)
    };
    let mean = |of: &dyn Fn(&Fit) -> f64| -> f64 {
        usable()
            .map(|((_, fit), weight)| weight * of(fit))
            .sum::<f64>()
            / total
    };
    let centre = mean(&|fit| 0.5 * fit.moves.ln());
    let variance = mean(&|fit| (0.5 * fit.moves.ln() - centre).powi(2) + 0.25 * fit.log_variance);
    let around = Value::log_normal(centre.exp(), variance.sqrt());
    Value { value, ..around }
}

/// The shortest and the longest time between which 95 % of the likelihood lies, half a step beyond on either side.
fn times_interval(value: f64, fits: &[(f64, Fit)], weights: &[f64]) -> Value {
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    let (mut lo, mut hi) = (None, None);
    for ((time_s, _), weight) in fits.iter().zip(weights) {
        sum += weight;
        if lo.is_none() && sum > 0.025 * total {
            lo = Some(time_s / TIMES.sqrt());
        }
        if hi.is_none() && sum >= 0.975 * total {
            hi = Some(time_s * TIMES.sqrt());
        }
    }
    Value { value, lo, hi }
}
