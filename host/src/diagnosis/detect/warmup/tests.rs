//! Settlings that are there, and what looks like one.

use std::sync::Arc;

use super::*;
use crate::chain::Chain;
use crate::model::random::{Gaussian, Seed};

const LENGTH: usize = 1 << 15;
const RATE_HZ: f64 = 100.0;

/// White noise of deviation 1, a walk whose steps have this one, and a settling.
fn axis(seed: u64, walk: f64, amplitude: f64) -> AxisState {
    let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let mut level = 0.0;
    let values = (0..LENGTH).map(|n| {
        level += walk * noise.draw();
        level + noise.draw() + amplitude * (-(n as f64) / 3000.0).exp()
    });
    AxisState::new(Arc::new(values.collect()), RATE_HZ, None).expect("long enough")
}

#[test]
fn walk_settles_by_chance_alone() {
    // At 2 % of 30 records five or more have a probability of 3e-4.
    for walk in [0.0, 1e-3, 1e-2] {
        let alarms =
            (0..30).filter(|&seed| warm_up(&axis(seed, walk, 0.0), 0.02, Noise::Anew).is_some());
        let alarms: Vec<u64> = alarms.collect();
        assert!(alarms.len() < 5, "walk {walk}: seeds {alarms:?}");
    }
}

#[test]
fn a_settling_taken_for_walk_is_found_beside_it() {
    let level = 2e-4;
    let mut hidden = 0;
    for seed in 100..108 {
        let axis = axis(seed, 0.0, 1.0);
        hidden += u32::from(warm_up(&axis, level, Noise::Fitted).is_none());
        let found = warm_up(&axis, level, Noise::Anew);
        let found = found.unwrap_or_else(|| panic!("seed {seed}: nothing"));
        let Wave::WarmUp { amplitude, .. } = found.wave else {
            panic!("seed {seed}: another waveform");
        };
        // Four deviations: once in 16 000.
        assert!(
            (amplitude - 1.0).abs() < 4.0 * found.size_sd,
            "seed {seed}: {amplitude} within {}",
            found.size_sd
        );
    }
    assert!(hidden > 0, "the walk hides none of them");
}

#[test]
fn what_is_shorter_than_any_settling_is_none() {
    for seed in 200..203 {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let with = |samples: f64, draw: &mut Gaussian| {
            let settling = (0..LENGTH).map(|n| 30.0 * (-(n as f64) / samples).exp());
            let values = settling.map(|value| value + draw.draw());
            let axis = AxisState::new(Arc::new(values.collect()), RATE_HZ, None);
            warm_up(&axis.expect("long enough"), 2e-4, Noise::Fitted)
        };
        // The shortest is 64 samples, a 512th of the record.
        assert!(with(100.0, &mut noise).is_some(), "seed {seed}");
        assert!(with(5.0, &mut noise).is_none(), "seed {seed}");
    }
}

#[test]
fn nothing_settles_within_a_converters_filter() {
    let chain: Chain = "ads1281:linear".parse().expect("a chain");
    let mut noise = Gaussian::new(Seed { seed: 7, stream: 0 }, 1.0);
    let values: Arc<Vec<f64>> = Arc::new((0..1 << 13).map(|_| noise.draw()).collect());
    let shortest = |chain: Option<&Chain>| {
        let axis = AxisState::new(Arc::clone(&values), RATE_HZ, chain).expect("long enough");
        let factor = axis.drift_factor();
        Settlings::new(&axis, &axis.filled, factor).shortest * factor as f64
    };
    assert!(shortest(None) < SPREAD as f64);
    assert!(shortest(Some(&chain)) >= SPREAD as f64);
}

#[test]
fn a_settling_as_quick_as_the_level_switches_is_a_dwell() {
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::model::telegraph;
    for (dwell_s, is_found) in [(2.0, true), (15.0, false)] {
        let mut values = noise(0);
        trial::add(&mut values, &trial::settling(4.0, 30.0));
        let mut trial = Trial::new(values);
        trial.know(telegraph::KIND, [1.0, dwell_s], trial::steps(&[]));
        let found = trial.look(|look| find(look, Noise::Anew));
        assert_eq!(found.is_some(), is_found, "seed 0, {dwell_s} s");
    }
}

#[test]
fn a_settling_is_found_once_and_not_where_it_was_refused() {
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    let mut values = noise(1);
    trial::add(&mut values, &trial::settling(4.0, 30.0));
    let mut trial = Trial::new(values);
    let is_found = |trial: &Trial| trial.look(|look| find(look, Noise::Anew)).is_some();
    assert!(is_found(&trial), "seed 1");
    trial.refuse(KIND);
    assert!(!is_found(&trial), "seed 1: refused");
    trial.refused.clear();
    trial.know(KIND, [4.0, 30.0], trial::steps(&[]));
    assert!(!is_found(&trial), "seed 1: known");
}

/// A walk that is hardly resolved from zero in a record of which two stretches are missing: few spectra of whole runs are left
/// to say how strong it is.
#[test]
fn what_a_walk_does_that_was_not_resolved_is_no_settling() {
    let level = 2e-3;
    let (mut alone, mut found) = (Vec::new(), Vec::new());
    for seed in 300..420 {
        let mut values = axis(seed, 1e-3, 0.0).filled.to_vec();
        values[10_000..10_300].fill(f64::NAN);
        values[22_000..22_300].fill(f64::NAN);
        let axis = AxisState::new(Arc::new(values), RATE_HZ, None).expect("long enough");
        let settling = Settlings::new(&axis, &axis.filled, axis.drift_factor());
        if settling.p_value(settling.best().0) < level {
            alone.push(seed);
        }
        if warm_up(&axis, level, Noise::Fitted).is_some() {
            found.push(seed);
        }
    }
    // At 0.2 % of 120 records three or more have a probability of 2e-3.
    assert!(alone.len() >= 3, "seeds {alone:?} are no trap");
    assert!(found.len() < 3, "seeds {found:?} of {alone:?}");
}

#[test]
fn the_size_is_that_of_the_first_sample() {
    // Means over eight samples of a settling within 70, of which two tell it.
    let (factor, samples) = (8, 70.0_f64);
    let of = |n: usize| (-(n as f64) / samples).exp();
    let mean = |block: usize| {
        let own = block * factor..(block + 1) * factor;
        own.map(of).sum::<f64>() / factor as f64
    };
    let time = samples / factor as f64;
    for block in [0, 5] {
        let size = mean(block) / (-(block as f64 + 0.5) / time).exp();
        let first = size * first_sample(time, factor);
        assert!((first - 1.0).abs() < 1e-12, "{block}: {first}");
    }
    // Of single samples the first is half a sample late.
    assert!((first_sample(3.0, 1) - (-0.5_f64 / 3.0).exp()).abs() < 1e-12);
}
