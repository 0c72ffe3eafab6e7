//! How strong the bands of a stretch are: as strong as what was measured of it.
//!
//! Whittle's likelihood finds which bands are there: it weighs ratios, so that a form that fits roughly is as strong as suits
//! most of its ordinates, and its taper sees the middle of a stretch, not where it begins with a blow. What happened once is
//! not drawn again: it had the energy that it had. So its sizes are those of the least Kullback-Leibler divergence, which
//! keeps sums as they were measured (D. D. Lee and H. S. Seung, Adv. Neural Inf. Process. Syst. 13, 2001, theorem 2), in a
//! spectrum of several sines, which weigh all of the stretch alike (K. S. Riedel and A. Sidorenko, IEEE Trans. Signal
//! Process. 43, 1995).

use std::f64::consts::PI;
use std::ops::Range;

use super::bands::{lags, mean, seen};
use crate::fft;
use crate::model::unnamed::Band;
use crate::numeric::mixture::add_mixture;

/// Tapers: with five all but the tenth at either end weighs alike, and frequencies are told to three ordinates.
const TAPERS: usize = 5;

/// Steps towards the sizes: bands that lie over one another share what is there to a hundredth by then.
const STEPS: usize = 50;

/// Two-sided density of some samples in cycles a sample, from zero on, all samples weighed alike but those at the very ends;
/// what happened there is told with the rest, so that all of it has its energy.
pub fn density(values: &[f64]) -> Vec<f64> {
    let len = values.len();
    let fft = fft::real_forward(len);
    let mut sum = vec![0.0; len / 2 + 1];
    for number in 1..=TAPERS {
        let (mut samples, mut ordinates) = (fft.make_input_vec(), fft.make_output_vec());
        for (n, (sample, value)) in samples.iter_mut().zip(values).enumerate() {
            let turn = PI * number as f64 * (n as f64 + 0.5) / len as f64;
            *sample = value * turn.sin();
        }
        // The lengths are those that it was planned for.
        let done = fft.process(&mut samples, &mut ordinates);
        debug_assert!(done.is_ok());
        for (sum, one) in sum.iter_mut().zip(&ordinates) {
            *sum += one.norm_sqr() / (0.5 * (len * TAPERS) as f64);
        }
    }
    let own = values.iter().map(|one| one * one).sum::<f64>();
    // Of all ordinates, both ways.
    let told = 2.0 * sum[1..].iter().sum::<f64>() + sum[0] - sum[len / 2];
    if told > 0.0 {
        sum.iter_mut().for_each(|one| *one *= own / told);
    }
    sum
}

/// Mean of the products of the tapers over a stretch with themselves a `part` of it later, over that without a lag.
fn taper_covariance(part: f64) -> f64 {
    let of_taper = |number: usize| {
        let turn = PI * number as f64;
        (1.0 - part) * (turn * part).cos() + (turn * part).sin() / turn
    };
    (1..=TAPERS).map(of_taper).sum::<f64>() / TAPERS as f64
}

/// What the `groups` of ordinates of a stretch of so many samples are expected to be for each of its `bands`, of amplitude 1.
pub fn shapes(bands: &[Band], len: usize, groups: &[Range<usize>]) -> Vec<Vec<f64>> {
    let taper = lags(len, taper_covariance);
    let shape = |band: &Band| {
        let unit = Band {
            amplitude: 1.0,
            ..*band
        };
        seen(unit, groups, &taper).expected
    };
    bands.iter().map(shape).collect()
}

/// Gives `bands` of these [shapes] the energy that a stretch of this `measured` [density] has in their `groups` of ordinates,
/// beside some `noise`. A band that is left without any stays as it is.
pub fn give(
    bands: &mut [Band],
    shapes: &[Vec<f64>],
    measured: &[f64],
    groups: &[Range<usize>],
    noise: &[f64],
) {
    let measured: Vec<f64> = groups
        .iter()
        .map(|group| mean(&measured[group.clone()]))
        .collect();
    let mut squared: Vec<f64> = bands.iter().map(|band| band.amplitude.powi(2)).collect();
    for _ in 0..STEPS {
        let mut expected = noise.to_vec();
        add_mixture(&mut expected, shapes, &squared);
        for (squared, shape) in squared.iter_mut().zip(shapes) {
            let (mut up, mut down) = (0.0, 0.0);
            for (place, group) in groups.iter().enumerate() {
                let own = shape[place] * group.len() as f64;
                up += own * measured[place] / expected[place];
                down += own;
            }
            *squared *= up / down;
        }
    }
    for (band, squared) in bands.iter_mut().zip(squared) {
        if squared.is_finite() && squared > 0.0 {
            band.amplitude = squared.sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::diagnosis::detect::shock::bands::groups;
    use crate::diagnosis::trial::numbers;

    /// White noise of deviation 1 with a tone of amplitude 20 in the `part` of it, and the mean square of that tone.
    fn with_tone(seed: u64, part: Range<usize>) -> (Vec<f64>, f64) {
        const LENGTH: usize = 1024;
        let mut normal = numbers(seed, 0);
        let mut values: Vec<f64> = (0..LENGTH).map(|_| normal.draw()).collect();
        let mut square = 0.0;
        for n in part {
            let own = 20.0 * (TAU * 0.05 * n as f64).sin();
            values[n] += own;
            square += own * own;
        }
        (values, square / LENGTH as f64)
    }

    #[test]
    fn what_is_strong_for_a_part_of_a_stretch_has_its_energy_wherever_that_is() {
        for (seed, part) in [(1, 128..384), (2, 384..640), (3, 640..896)] {
            let (values, square) = with_tone(seed, part.clone());
            let groups = groups(values.len() / 2);
            let noise = vec![1.0; groups.len()];
            // Wider than it is, and sized for another.
            let mut bands = [Band {
                f_hz: 0.05,
                width_hz: 0.01,
                amplitude: 3.0,
            }];
            let shapes = shapes(&bands, values.len(), &groups);
            give(&mut bands, &shapes, &density(&values), &groups, &noise);
            let ratio = bands[0].amplitude.powi(2) / square;
            // The tapers' weights differ by a fifth about an eighth of it, and the noise beside the band is 1 of 50.
            assert!((ratio - 1.0).abs() < 0.25, "seed {seed}, {part:?}: {ratio}");
        }
    }

    #[test]
    fn a_band_keeps_its_energy_beside_a_stronger_one() {
        let mut normal = numbers(4, 0);
        let tone = |f_hz: f64, n: usize| (TAU * f_hz * n as f64).sin();
        let values = (0..1024).map(|n| normal.draw() + 50.0 * tone(0.02, n) + 5.0 * tone(0.3, n));
        let values: Vec<f64> = values.collect();
        let groups = groups(512);
        let band = |f_hz: f64| Band {
            f_hz,
            width_hz: 0.01,
            amplitude: 1.0,
        };
        let mut bands = [band(0.02), band(0.3)];
        let shapes = shapes(&bands, values.len(), &groups);
        let noise = vec![1.0; groups.len()];
        give(&mut bands, &shapes, &density(&values), &groups, &noise);
        for (band, expected) in bands.iter().zip([1250.0, 12.5]) {
            let ratio = band.amplitude.powi(2) / expected;
            // A hundredth of the noise is within the band's reach.
            assert!((ratio - 1.0).abs() < 0.1, "seed 4, {band:?}: {ratio}");
        }
    }
}
