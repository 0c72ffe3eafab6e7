//! How long a stretch takes to come up, and to fade.

use crate::model::motion::Envelope;

/// Parts of a stretch whose powers are compared: a choice. A sixteenth shows whether it comes slowly.
const PARTS: usize = 16;

/// What of a stretch, one over these, may be on the way at either end: a little, an eighth, a quarter, or all of it; choices.
/// Nothing is cut off at once: that would be louder at high frequencies than all that is there. What begins with a blow has
/// these frequencies by itself.
const ON_THE_WAY: [usize; 4] = [32, 8, 4, 2];

/// Samples in which a stretch of these `values` comes up, beside noise of this power: that of the likeliest envelope, if what
/// it holds is noise of one power in it.
pub fn fading(values: &[f64], noise_power: f64) -> usize {
    let length = values.len();
    let part = |number: usize| number * length / PARTS..(number + 1) * length / PARTS;
    let powers: Vec<f64> = (0..PARTS)
        .map(|number| {
            let own = &values[part(number)];
            own.iter().map(|one| one * one).sum::<f64>() / own.len() as f64
        })
        .collect();
    let mean = powers.iter().sum::<f64>() / PARTS as f64;
    let fades = ON_THE_WAY.map(|own| length / own);
    let log_likelihood = |fade: usize| {
        let envelope = Envelope::new(length as u64, fade as u64);
        let power = (mean - noise_power).max(0.0) / envelope.mean_square();
        let of_part = (0..PARTS).map(|number| {
            let own = part(number);
            let squares = own.clone().map(|n| envelope.at(n as u64).powi(2));
            let expected = noise_power + power * squares.sum::<f64>() / own.len() as f64;
            -(expected.ln() + powers[number] / expected)
        });
        of_part.sum::<f64>()
    };
    let likeliest = fades
        .into_iter()
        .max_by(|a, b| log_likelihood(*a).total_cmp(&log_likelihood(*b)));
    likeliest.unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::numbers;

    #[test]
    fn what_comes_soon_and_what_swells_are_told_apart() {
        for seed in 1..=10 {
            let mut normal = numbers(seed, 0);
            let length = 900 + 137 * seed as usize;
            for part in ON_THE_WAY {
                let fade = length / part;
                let envelope = Envelope::new(length as u64, fade as u64);
                let values: Vec<f64> = envelope
                    .values()
                    .map(|one| 30.0 * one * normal.draw() + normal.draw())
                    .collect();
                let found = fading(&values, 1.0);
                assert_eq!(found, fade, "seed {seed}, {length} samples");
            }
        }
    }
}
