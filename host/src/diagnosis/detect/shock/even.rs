//! Whether a stretch is as strong from its beginning to its end: a burst then, and no shock.

use std::ops::Range;

use super::about::About;
use crate::diagnosis::statistic::p_value;

/// Probability of strengths that differ as much, above which a stretch is as strong from its beginning to its
/// end: a choice. It decides about a name, not about a finding.
const EVEN: f64 = 1e-5;

/// Correlations between errors whose squares are summed for the share of them that are numbers of their own.
const LAGS: usize = 32;

/// Numbers of their own among errors of one colour with the record's noise, at least, beyond what chance correlates: a choice. Bursts
/// of that noise have 0.7 and more of them, a lorry's tremble 0.2.
const OWN_COLOUR: f64 = 0.5;

/// Samples of a stretch whose evenness can be seen, at least.
pub const LONG: usize = 128;

/// Mean square of some errors of prediction, and the share of them that are numbers of their own: of another colour than
/// the record's noise, a stretch has fewer.
pub fn strength(errors: &[f64]) -> (f64, f64) {
    let count = errors.len() as f64;
    let mean = errors.iter().map(|error| error * error).sum::<f64>() / count;
    let correlation = |lag: usize| {
        let pairs = errors.iter().zip(&errors[lag..]);
        pairs.map(|(a, b)| a * b).sum::<f64>() / count / mean
    };
    let lags = 1..=LAGS.min(errors.len().saturating_sub(1));
    let squares: f64 = lags.map(|lag| correlation(lag).powi(2)).sum();
    (mean, 1.0 / (1.0 + 2.0 * squares))
}

/// Gain in log-likelihood of noise as strong from its beginning to its end, in nats; `None` where it is not, or of another
/// colour.
pub fn even(about: &About, samples: &Range<usize>) -> Option<f64> {
    let inside = about.means_of(samples);
    if inside.len() < LONG {
        return None;
    }
    // Its ends are not known to the sample.
    let edge = inside.len() / 10;
    let errors = about.said(inside.start + edge..inside.end - edge);
    if errors.len() < LONG / 2 {
        return None;
    }
    let count = errors.len() as f64;
    let (mean, own) = strength(&errors);
    let correlated = own.recip() - 1.0 - 2.0 * LAGS as f64 / count;
    if correlated > OWN_COLOUR.recip() - 1.0 {
        return None;
    }
    let gain = 0.5 * count * own * (mean - 1.0 - mean.ln());
    let parts = (errors.len() / 32).clamp(4, 32);
    let length = errors.len() / parts;
    let logs: Vec<f64> = errors
        .chunks_exact(length)
        .map(|part| (part.iter().map(|error| error * error).sum::<f64>() / length as f64).ln())
        .collect();
    let middle = logs.iter().sum::<f64>() / logs.len() as f64;
    let scatter: f64 = logs.iter().map(|log| (log - middle).powi(2)).sum();
    let even = p_value::chi_squared(scatter * 0.5 * length as f64 * own, logs.len() as f64 - 1.0);
    (mean > 1.0 && even > EVEN).then_some(gain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::shock::trial::{EVENT, about};
    use crate::diagnosis::detect::trial::{add_band, noise};

    /// The gain of a stretch in which the noise is so many times as strong, by the share of it that is over.
    fn gain(seed: u64, factor: impl Fn(f64) -> f64) -> Option<f64> {
        let mut values = noise(seed);
        let length = EVENT.len() as f64;
        let inside = values[EVENT].iter_mut().enumerate();
        inside.for_each(|(n, value)| *value *= factor(n as f64 / length));
        even(&about(&values), &EVENT)
    }

    #[test]
    fn noise_of_another_colour_is_no_louder_noise() {
        for seed in 4..8 {
            let mut values = noise(seed);
            let mut band = vec![0.0; values.len()];
            add_band(&mut band, seed, 3.0, |_| 1.0);
            let pairs = values[EVENT].iter_mut().zip(&band[EVENT]);
            pairs.for_each(|(value, more)| *value += more);
            assert!(even(&about(&values), &EVENT).is_none(), "seed {seed}");
        }
    }

    #[test]
    fn a_burst_is_louder_and_does_not_die_away() {
        for seed in 0..4 {
            assert!(gain(seed, |_| 3.0).is_some(), "seed {seed}: louder");
            assert!(gain(seed, |_| 0.3).is_none(), "seed {seed}: quieter");
            let dies_away = |over: f64| 6.0 * (-4.0 * over).exp();
            assert!(gain(seed, dies_away).is_none(), "seed {seed}: dies away");
        }
    }
}
