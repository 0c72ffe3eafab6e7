//! The slope of what is left of an axis, with its uncertainty.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws;
use crate::fit::likelihood::components::SEEN;
use crate::fit::likelihood::ramp::Ramp;
use crate::fit::likelihood::slope::{Block, Slope};

/// Blocks that the record is averaged into: a walk shows a slope by its two ends alone, which so
/// many blunt by a sixty-fourth.
const BLOCKS: usize = 64;

/// Share of a block's samples that must be there, at least: the mean of what is there counts as
/// that of the whole block. Half is a choice.
const LEAST_FILLED: f64 = 0.5;

/// The ramp of the residual, together with all that was fitted to it; `None` where gaps leave too
/// little.
pub fn ramp(axis: &AxisState) -> Option<Ramp> {
    let mut slope = Slope::new(&blocks(axis), &axis.fit.squared[..SEEN.len()])?;
    // Over the length of the record laws are as good as white.
    let slow_hz = axis.rate_hz / axis.residual.len() as f64;
    let power = axis.filters(slow_hz);
    for unit in SEEN.len()..axis.bins.units().len() {
        slope.beside(axis.bins.unit_density(unit, slow_hz, power));
    }
    for which in 0..axis.laws.len() {
        if let Some(density) = axis.unit_law_density(which, slow_hz) {
            slope.beside(density * power);
        }
    }
    let filtered = laws::behind(&axis.bins, &axis.laws);
    let mut components = laws::components_of(&filtered, &axis.laws);
    let mut fit = axis.fit.clone();
    if axis.floor() > 0.0 {
        // One component more, of a size that is known.
        components.push(filtered.fixed());
        slope.beside(axis.floor());
        fit.squared.push(1.0);
        let size = fit.squared.len();
        fit.covariance = fit.covariance.resize(size, size, 0.0);
    }
    Ramp::new(&axis.data, &components, &fit, &slope)
}

fn blocks(axis: &AxisState) -> Vec<Block> {
    let values = axis.residual.values();
    let length = values.len().div_ceil(BLOCKS).max(1);
    let parts = values.chunks(length).enumerate();
    let block = |(number, part): (usize, &[f64])| {
        let there = || part.iter().filter(|value| value.is_finite());
        let count = there().count() as f64;
        let from = number * length;
        (count >= LEAST_FILLED * part.len() as f64).then(|| Block {
            from_s: from as f64 / axis.rate_hz,
            to_s: (from + part.len()) as f64 / axis.rate_hz,
            mean: there().sum::<f64>() / count,
        })
    };
    parts.filter_map(block).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    const RATE_HZ: f64 = 100.0;

    /// White noise of deviation 1 and a walk, on a slope.
    fn of(seed: u64, per_s: f64) -> Ramp {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let mut level = 0.0;
        let values = (0..1 << 15).map(|n| {
            level += 1e-3 * noise.draw();
            level + noise.draw() + per_s * f64::from(n) / RATE_HZ
        });
        let axis = AxisState::new(Arc::new(values.collect()), RATE_HZ, None);
        ramp(&axis.expect("long enough")).expect("no gaps")
    }

    #[test]
    fn a_slope_is_told_with_its_uncertainty() {
        for seed in 0..8 {
            let ramp = of(seed, 5e-3);
            // Half of a 95 % interval twice: one in 10 000 of Gaussian estimates.
            let off = (ramp.per_s - 5e-3).abs();
            assert!(off < 2.0 * ramp.two_sided, "seed {seed}: {ramp:?}");
            assert!(ramp.identified(), "seed {seed}: {ramp:?}");
        }
    }

    #[test]
    fn no_slope_is_told_where_there_is_none() {
        // Of 40 records at 5 % eight or more have a probability of 1e-3.
        let told = (100..140).filter(|&seed| of(seed, 0.0).identified());
        let told: Vec<u64> = told.collect();
        assert!(told.len() < 8, "seeds {told:?}");
    }

    #[test]
    fn a_block_of_which_most_is_missing_is_none() {
        let mut noise = Gaussian::new(
            Seed {
                seed: 200,
                stream: 0,
            },
            1.0,
        );
        let mut values: Vec<f64> = (0..1 << 15).map(|_| noise.draw()).collect();
        // Of 512 samples each: six tenths of one, four tenths of another.
        values[5120..5427].fill(f64::NAN);
        values[10_240..10_445].fill(f64::NAN);
        let axis = AxisState::new(Arc::new(values), RATE_HZ, None).expect("long enough");
        let from_s: Vec<f64> = blocks(&axis).iter().map(|one| one.from_s).collect();
        assert_eq!(from_s.len(), BLOCKS - 1);
        assert!(!from_s.contains(&51.2) && from_s.contains(&102.4));
    }

    #[test]
    fn beside_slow_noise_with_a_name_a_slope_is_as_sure_as_it_is_said_to_be() {
        use crate::diagnosis::trial;
        use crate::model::markov::KIND;
        const SEEDS: u64 = 24;
        let over_deviation = |seed: u64| {
            let mut slow = trial::markov(seed, 100.0);
            let make = |_, noise| noise + 3.0 * slow();
            let mut axis = trial::axis(seed, trial::short(seed), make);
            let law = trial::law(KIND, &[3.0, 100.0 / trial::RATE_HZ]);
            trial::take_in(&mut axis, KIND, law);
            let ramp = ramp(&axis).expect("no gaps");
            ramp.per_s / ramp.deviation
        };
        let square: f64 = (300..300 + SEEDS)
            .map(|seed| over_deviation(seed).powi(2))
            .sum();
        let square = square / SEEDS as f64;
        // A mean of as many squares scatters by sqrt(2 / n) of itself: five of it up, and down by a factor.
        let off = 5.0 * (2.0 / SEEDS as f64).sqrt();
        let is_one = (1.0 / (1.0 + off)..1.0 + off).contains(&square);
        assert!(is_one, "seeds 300 on: {square}");
    }
}
