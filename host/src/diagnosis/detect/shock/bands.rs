//! Bands of noise that are let in for a stretch, by Whittle's likelihood of its periodogram.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::diagnosis::laws::gain::Local;
use crate::fft;
use crate::fit::likelihood::scoring::maximise_beside;
use crate::fit::likelihood::{Data, log_likelihood};
use crate::model::unnamed::Band;
use crate::numeric::mixture::add_mixture;
use crate::numeric::taper::hann;

/// Bands of a stretch, at most: a choice. What sways, what rings, and what hums.
const MOST_BANDS: usize = 3;

/// Probability of a band too many.
const NEEDLESS: f64 = 0.05;

/// Bands of the dictionary that look alike.
const OVERLAP: f64 = 4.0;

/// Frequency of a group of ordinates over that of the one before.
pub const NEXT: f64 = 1.15;

/// Two-sided density of some samples in cycles a sample, from zero on, under Hann's taper: what the ends cut off would
/// else stand above all that is far from the bands.
pub fn periodogram(values: &[f64]) -> Vec<f64> {
    /// Mean square of the taper.
    const SQUARE: f64 = 0.375;
    let len = values.len();
    let fft = fft::real_forward(len);
    let (mut samples, mut ordinates) = (fft.make_input_vec(), fft.make_output_vec());
    for (n, (sample, value)) in samples.iter_mut().zip(values).enumerate() {
        *sample = value * hann(n as f64 + 0.5, len as f64);
    }
    // The lengths are those that it was planned for.
    let done = fft.process(&mut samples, &mut ordinates);
    debug_assert!(done.is_ok());
    ordinates
        .iter()
        .map(|one| one.norm_sqr() / (SQUARE * len as f64))
        .collect()
}

/// Ordinates that are taken together: the first by itself, as it is the sum of all samples.
pub fn groups(ordinates: usize) -> Vec<Range<usize>> {
    let mut groups = vec![0..1];
    let mut from = 1;
    while from < ordinates {
        let to = ((NEXT * from as f64).ceil() as usize).clamp(from + 1, ordinates.max(from + 1));
        groups.push(from..to);
        from = to;
    }
    groups
}

/// Mean of some values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Groups of ordinates of a periodogram; `None` where nothing is in them.
pub fn data(periodogram: &[f64], groups: &[Range<usize>]) -> Option<Data> {
    let len = 2.0 * (periodogram.len() - 1) as f64;
    let middle = |group: &Range<usize>| 0.5 * (group.start + group.end - 1) as f64 / len;
    /// Neighbouring ordinates under the taper are correlated: `1 + 2 (4/9 + 1/36)`.
    const CORRELATED: f64 = 1.944_444;
    // An ordinate has two degrees of freedom, the sum of all samples one.
    let variance = |group: &Range<usize>| {
        let count = group.len() as f64;
        if group.start == 0 {
            2.0
        } else {
            CORRELATED.min(count) / count
        }
    };
    let variances = DVector::from_iterator(groups.len(), groups.iter().map(variance));
    Data::from_parts(
        groups.iter().map(middle).collect(),
        groups
            .iter()
            .map(|group| mean(&periodogram[group.clone()]))
            .collect(),
        DMatrix::from_diagonal(&variances),
    )
}

/// The likeliest bands beside some noise, the one that explains most first, and their gain in log-likelihood, nats; `None`
/// where there are none.
pub fn bands(data: &Data, noise: &[f64], groups: &[Range<usize>]) -> Option<(Vec<Band>, f64)> {
    let len = 2 * groups.last()?.end;
    let taper = lags(len, taper_covariance);
    let tried = |band: Band| seen(band, groups, &taper);
    let dictionary: Vec<(Band, Local)> = dictionary(len as f64)
        .into_par_iter()
        .map(|band| (band, tried(band)))
        .collect();
    let cost_nats = (dictionary.len() as f64 / (OVERLAP * NEEDLESS)).ln();
    let mut bands: Vec<Band> = Vec::new();
    let (mut components, mut squared): (Vec<Vec<f64>>, Vec<f64>) = Default::default();
    while bands.len() < MOST_BANDS {
        let mut others = noise.to_vec();
        add_mixture(&mut others, &components, &squared);
        let gains = dictionary
            .iter()
            .map(|(band, local)| (band, local, local.best(data, &others)));
        let best = gains.max_by(|a, b| a.2.1.total_cmp(&b.2.1));
        let Some((band, _, (_, gain))) = best.filter(|best| best.2.1 > cost_nats) else {
            break;
        };
        let band = settled((*band, gain), |band| tried(band).best(data, &others).1);
        let local = tried(band);
        squared.push(local.best(data, &others).0);
        components.push(local.expected);
        bands.push(band);
        if let Some(fit) = maximise_beside(data, &components, noise, Some(&squared)) {
            squared = fit.squared;
        }
    }
    let mut expected = noise.to_vec();
    add_mixture(&mut expected, &components, &squared);
    let gain = log_likelihood(data, &expected) - log_likelihood(data, noise);
    let sized = bands.into_iter().zip(squared);
    let sized: Vec<Band> = sized
        .filter(|(_, squared)| *squared > 0.0)
        .map(|(band, squared)| Band {
            amplitude: squared.sqrt(),
            ..band
        })
        .collect();
    (!sized.is_empty()).then_some((sized, gain))
}

/// The band near a first one that gains most: far from its middle the width decides, which a dictionary gives roughly.
fn settled((mut band, mut gain): (Band, f64), gain_of: impl Fn(Band) -> f64 + Sync) -> Band {
    /// Moves of the middle in widths, factors on the width, the coarse first, and turns of each: choices.
    const MOVES: [[f64; 2]; 3] = [[0.3, 1.4], [0.1, 1.15], [0.03, 1.05]];
    const TURNS: usize = 6;
    for [aside, wider] in MOVES {
        for _ in 0..TURNS {
            let Band { f_hz, width_hz, .. } = band;
            let to = |f_hz: f64, width_hz: f64| Band {
                f_hz: f_hz.clamp(0.0, 0.5),
                width_hz,
                amplitude: 1.0,
            };
            let side = if f_hz > 0.0 { aside * width_hz } else { 0.0 };
            let tried = [
                to(f_hz + side, width_hz),
                to(f_hz - side, width_hz),
                to(f_hz, width_hz * wider),
                to(f_hz, width_hz / wider),
            ];
            let tried = tried.into_par_iter().map(|one| (one, gain_of(one)));
            match tried.max_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((better, more)) if more > gain => (band, gain) = (better, more),
                _ => break,
            }
        }
    }
    band
}

/// Bands that a stretch of so many samples may be about: of half an ordinate's width to four times the frequency.
fn dictionary(len: f64) -> Vec<Band> {
    let band = |f_hz: f64, width_hz: f64| Band {
        f_hz,
        width_hz,
        amplitude: 1.0,
    };
    let narrowest = 0.5 / len;
    let widths = std::iter::successors(Some(narrowest), |width| Some(2.0 * width));
    let widths: Vec<f64> = widths.take_while(|width| *width < 0.5).collect();
    let mut all: Vec<Band> = widths.iter().map(|&width| band(0.0, width)).collect();
    let mut f_hz = 1.0 / len;
    while f_hz < 0.5 {
        let own = widths.iter().filter(|width| **width <= f_hz);
        all.extend(own.map(|&width| band(f_hz, width)));
        f_hz *= NEXT;
    }
    all
}

/// What the groups of ordinates are expected to be for a band that is let in for so many samples: the transform of its
/// covariance times that of the `taper` with itself so many samples later, with what the ordinates fold.
pub fn seen(band: Band, groups: &[Range<usize>], taper: &[f64]) -> Local {
    let covariances = band.covariances(1.0).zip(taper);
    let covariances: Vec<f64> = covariances.map(|(band, taper)| band * taper).collect();
    let fft = fft::real_forward(taper.len());
    let (mut lags, mut ordinates) = (fft.make_input_vec(), fft.make_output_vec());
    lags.copy_from_slice(&covariances);
    let later = covariances[1..].iter().rev();
    lags[1..]
        .iter_mut()
        .zip(later)
        .for_each(|(one, later)| *one += later);
    // The lengths are those that it was planned for.
    let done = fft.process(&mut lags, &mut ordinates);
    debug_assert!(done.is_ok());
    let expected = groups.iter().map(|group| {
        let sum: f64 = ordinates[group.clone()].iter().map(|one| one.re).sum();
        sum.max(0.0) / group.len() as f64
    });
    Local {
        first: 0,
        expected: expected.collect(),
        most: f64::INFINITY,
    }
}

/// What is known of a taper at a `part` of its length, at each lag of so many.
pub fn lags(len: usize, covariance: impl Fn(f64) -> f64) -> Vec<f64> {
    let lags = 0..len;
    lags.map(|lag| covariance(lag as f64 / len as f64))
        .collect()
}

/// Sum of the products of Hann's taper with itself a `part` of its length later, over that without a lag.
fn taper_covariance(part: f64) -> f64 {
    let (sine, cosine) = (TAU * part).sin_cos();
    (1.0 - part) * (2.0 + cosine) / 3.0 + sine / TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::numbers;

    #[test]
    fn noise_that_is_known_has_hardly_ever_a_band_of_its_own() {
        let groups = groups(128);
        let noise = vec![1.0; groups.len()];
        // A band too many in 5 % of the records: three of eight have a probability of 0.6 %.
        let found = (1..=8).filter(|&seed| {
            let mut normal = numbers(seed, 0);
            let values: Vec<f64> = (0..256).map(|_| normal.draw()).collect();
            let data = data(&periodogram(&values), &groups).expect("ordinates");
            bands(&data, &noise, &groups).is_some()
        });
        let found: Vec<u64> = found.collect();
        assert!(found.len() < 3, "seeds {found:?}");
    }
}
