//! What a stretch is about, band by band.
//!
//! What moves a sensor sways, rings and hums at once, over six powers of ten and more: no few bells follow that, as the skirts
//! of the strongest are louder than all the rest. So it is told half an octave by half an octave, each as strong as it was.

use std::ops::Range;

use super::energy::{density, give, shapes};
use crate::model::unnamed::Band;
use crate::numeric::mixture::add_mixture;

/// Bands an octave: a choice. What is of one shape over half an octave is met to a tenth.
const PER_OCTAVE: f64 = 2.0;

/// Share of what is expected of a band and all else that is nothing where it is nowhere more: a choice, 5 % of a deviation.
const NOTHING: f64 = 0.1;

/// The bands of a stretch with these `values`, the strongest first, beside some `noise` in their `groups` of ordinates.
pub fn described(values: &[f64], groups: &[Range<usize>], noise: &[f64]) -> Vec<Band> {
    let measured = density(values);
    let len = values.len() as f64;
    let middles = (0..).map(|number| f64::from(number).exp2().powf(PER_OCTAVE.recip()) / len);
    let half = (0.5 / PER_OCTAVE).exp2();
    let mut bands: Vec<Band> = middles
        .take_while(|f_hz| *f_hz < 0.5)
        .map(|f_hz| {
            let width_hz = f_hz * (half - half.recip());
            let ordinate = (f_hz * len).round() as usize;
            let power = measured
                .get(ordinate)
                .map_or(0.0, |one| 2.0 * one * width_hz);
            Band {
                f_hz,
                width_hz,
                amplitude: power.max(f64::MIN_POSITIVE).sqrt(),
            }
        })
        .collect();
    let shapes = shapes(&bands, values.len(), groups);
    give(&mut bands, &shapes, &measured, groups, noise);
    let (mut bands, shapes) = without_nothing(bands, shapes, noise);
    give(&mut bands, &shapes, &measured, groups, noise);
    bands.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    bands
}

/// The bands, with their shapes, without those that are nothing anywhere, but for the strongest.
fn without_nothing(
    bands: Vec<Band>,
    shapes: Vec<Vec<f64>>,
    noise: &[f64],
) -> (Vec<Band>, Vec<Vec<f64>>) {
    let squared: Vec<f64> = bands.iter().map(|band| band.amplitude.powi(2)).collect();
    let strongest = bands.iter().map(|band| band.amplitude).fold(0.0, f64::max);
    let mut expected = noise.to_vec();
    add_mixture(&mut expected, &shapes, &squared);
    let stays = |(band, shape): &(Band, Vec<f64>)| {
        let squared = band.amplitude.powi(2);
        let mut shares = shape.iter().zip(&expected);
        band.amplitude == strongest || shares.any(|(own, all)| squared * own > NOTHING * all)
    };
    bands.into_iter().zip(shapes).filter(stays).unzip()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::diagnosis::detect::shock::bands::{groups, mean};
    use crate::diagnosis::trial::numbers;
    use crate::model::Term;

    /// A sway of 1000 that comes up and fades, a hum a thousand times weaker, and noise of deviation 0.1.
    fn swayed(seed: u64, length: usize) -> Vec<f64> {
        let mut normal = numbers(seed, 0);
        let sample = |n: usize| {
            let held = (0.5 * TAU * n as f64 / length as f64).sin().powi(2);
            let sway = 1000.0 * held * (TAU * 0.004 * n as f64).sin();
            sway + held * (TAU * 0.2 * n as f64).sin() + 0.1 * normal.draw()
        };
        (0..length).map(sample).collect()
    }

    #[test]
    fn what_is_weak_beside_a_sway_is_as_weak_as_it_is() {
        for seed in 1..=5 {
            let values = swayed(seed, 3000 + 2 * (seed as usize) * 171);
            let groups = groups(values.len() / 2);
            let noise = vec![0.01; groups.len()];
            let bands = described(&values, &groups, &noise);
            let strongest = bands[0].f_hz;
            assert!(
                (0.004 / 1.2..0.004 * 1.2).contains(&strongest),
                "seed {seed}: {strongest}"
            );
            // Half an octave about the hum has its energy: 3/8 of a half of its square, and what is left of the noise.
            let hum = bands
                .iter()
                .filter(|band| (0.16..0.25).contains(&band.f_hz));
            let power: f64 = hum.map(|band| band.amplitude.powi(2)).sum();
            // The bells beside it reach into it with a tenth of what is there.
            assert!((power / 0.1875 - 1.0).abs() < 0.2, "seed {seed}: {power}");
            // Beside both the skirts of the sway are a million times weaker than it is.
            let density =
                |f_hz: f64| -> f64 { bands.iter().map(|band| band.spectrum(f_hz, 1.0)).sum() };
            for f_hz in [0.06, 0.1, 0.45] {
                let share = density(f_hz) / density(strongest);
                assert!(share < 1e-6, "seed {seed}, {f_hz}: {share}");
            }
        }
    }

    #[test]
    fn a_stretch_has_all_of_its_energy_wherever_it_was() {
        // All of it in the first tenth, as behind a blow.
        for seed in 1..=5 {
            let mut values = swayed(seed, 2000);
            for (n, value) in values.iter_mut().enumerate() {
                *value *= (-(n as f64) / 60.0).exp();
            }
            let groups = groups(values.len() / 2);
            let bands = described(&values, &groups, &vec![1e-6; groups.len()]);
            let told: f64 = bands.iter().map(|band| band.amplitude.powi(2)).sum();
            let squares: Vec<f64> = values.iter().map(|value| value * value).collect();
            let ratio = told / mean(&squares);
            // Sums are kept, but for the noise, which is nothing here, and what is left out.
            assert!((ratio - 1.0).abs() < 0.01, "seed {seed}: {ratio}");
        }
    }
}
