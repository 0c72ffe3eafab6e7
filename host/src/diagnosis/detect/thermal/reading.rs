//! What a column says without the noise of its own reading.
//!
//! A thermometer adds noise that the sensor does not follow. Behind a short lag more of it is left than behind a long one,
//! so that a lag that is fitted to the readings themselves comes out too long, and the gain too small (errors in the
//! variables: W. A. Fuller, *Measurement Error Models*, 1987). Temperature itself is slow: the column is kept where it
//! stands out of what its fast half holds.

use crate::diagnosis::statistic::matched_filter::Transformer;
use crate::numeric::order::median;

/// How many times as much power as its reading's noise an ordinate must have to be kept: a choice. Noise alone has it once in
/// 20 000 ordinates.
const PLAIN: f64 = 10.0;

/// The `column`, one value a sample, without what its reading adds.
pub fn without_noise(column: &[f64]) -> Vec<f64> {
    let transformer = Transformer::new(column.len());
    let whole = transformer.transform(column, 1.0);
    let powers = || whole.ordinates().iter().map(|one| one.norm_sqr());
    let mut fast: Vec<f64> = powers().skip(whole.ordinates().len() / 2).collect();
    // The median of exponential powers is their mean times this.
    let noise = median(&mut fast).unwrap_or(0.0) / std::f64::consts::LN_2;
    let kept: Vec<f64> = powers()
        .map(|power| match power > PLAIN * noise {
            true => 1.0 - noise / power,
            false => 0.0,
        })
        .collect();
    let smooth = whole.filtered(|k| kept[k].into());
    let plain = whole.filtered(|_| 1.0.into());
    let mut without = column.to_vec();
    // The last few samples may be left over.
    for (value, (smooth, plain)) in without.iter_mut().zip(smooth.iter().zip(plain.iter())) {
        *value += smooth - plain;
    }
    without
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Seed;
    use crate::model::random::Gaussian;

    /// Two slow waves, and the same as they are read.
    fn read(seed: u64, len: usize, noise: f64) -> [Vec<f64>; 2] {
        let mut normal = Gaussian::new(Seed { seed, stream: 0 }, noise);
        let wave = |n: usize| (0.0003 * n as f64).sin() + 0.3 * (0.0011 * n as f64).cos();
        let true_values: Vec<f64> = (0..len).map(wave).collect();
        let read = true_values
            .iter()
            .map(|value| value + normal.draw())
            .collect();
        [true_values, read]
    }

    #[test]
    fn slow_waves_stay_and_most_of_the_noise_goes() {
        for (seed, len) in [(1, 100_000), (2, 65_537), (3, 30_011)] {
            let [is, read] = read(seed, len, 0.05);
            let found = without_noise(&read);
            let inside = len / 20..len - len / 20;
            let squares = inside.clone().map(|n| (found[n] - is[n]).powi(2));
            let rms = (squares.sum::<f64>() / inside.len() as f64).sqrt();
            // A tenth of the noise: a hundredth of all ordinates.
            assert!(rms < 0.005, "seed {seed}: {rms}");
        }
    }

    #[test]
    fn a_column_without_noise_stays_as_it_is() {
        let [is, _] = read(4, 50_000, 0.05);
        let found = without_noise(&is);
        let off = |range: std::ops::Range<usize>| {
            let off = range.map(|n| (found[n] - is[n]).abs());
            off.fold(0.0, f64::max)
        };
        // Waves of height 1. The ring closes on the line through the means of 256 samples at either end, which they miss by what
        // they rise in half as many, 0.04: half of that is off at the last.
        let [inside, all] = [off(2500..47_500), off(0..50_000)];
        assert!(
            inside < 1e-4 && all < 0.04,
            "{inside:e} inside, {all:e} in all"
        );
        assert_eq!(without_noise(&[20.0; 1000]), [20.0; 1000]);
    }
}
