//! Which filters pass for the converter's, and which do not.

use std::sync::Arc;

use super::*;
use crate::model::whole::Model;
use crate::simulate::source::Simulation;

/// Samples a record: the bins of the wall then have hundreds of degrees of freedom.
const SAMPLES: u64 = 1 << 16;

/// Noise of a chain at a rate.
fn record(chain: &str, rate_hz: f64, seed: u64) -> Vec<f64> {
    record_with("", chain, rate_hz, seed)
}

/// The same with some effects.
fn record_with(effects: &str, chain: &str, rate_hz: f64, seed: u64) -> Vec<f64> {
    let text = format!(
        r#"{{ "schema": 1, "rate_hz": {rate_hz}, "axes": [ {{ "name": "X", "chain": "{chain}",
            "coefficients": {{ "K": 1e-3, "B": 5e-3, "N": 0.01 }}{effects} }} ] }}"#
    );
    let model = Model::from_json(&text).expect("a model");
    let mut simulation = Simulation::new(&model, SAMPLES, seed).expect("a model");
    simulation.next_columns(SAMPLES as usize).remove(0)
}

/// What is recognised in noise of this chain at a rate, undeclared.
fn seen(chain: &str, rate_hz: f64, seed: u64) -> Option<String> {
    seen_without(chain, rate_hz, seed, 0)
}

/// The same without so many in a hundred of the samples.
fn seen_without(chain: &str, rate_hz: f64, seed: u64, percent: u64) -> Option<String> {
    let mut values = record(chain, rate_hz, seed);
    // A sequence that is as good as random, and has each number once in a hundred.
    let numbers = (0..SAMPLES).map(|n| n * n * n % 101);
    let lost = values.iter_mut().zip(numbers).filter(|(_, n)| *n < percent);
    lost.for_each(|(value, _)| *value = f64::NAN);
    let values = Arc::new(values);
    let behind = |chain: Option<&Chain>| AxisState::new(Arc::clone(&values), rate_hz, chain);
    let behind_any = |chain: &Chain| behind(Some(chain));
    let declared = Chain {
        converter: None,
        poles_hz: vec![rate_hz],
    };
    let axis = behind(Some(&declared)).expect("a spectrum");
    assert_eq!(
        super::chain(&axis, behind_any),
        None,
        "seed {seed}: declared"
    );
    let axis = behind(None).expect("a spectrum");
    super::chain(&axis, behind_any).map(|chain| chain.to_string())
}

#[test]
fn it_is_recognised_where_samples_are_missing() {
    for (seed, percent) in [(31, 1), (32, 8), (33, 30)] {
        let [converter, poles] = ["ads1281:linear", "500hz"];
        let found = seen_without(converter, 2000.0, seed, percent);
        // Which of its two filters, a third missing does not say any more. Nor does one in a hundred, of which the few
        // that are drawn decide: 6 of 16 such records have the other one, of those with 8 % missing none to one.
        let is_it = |one: &String| one == converter || percent != 8 && one == "ads1281:minimum";
        assert!(
            found.as_ref().is_some_and(is_it),
            "seed {seed}, {percent} %: {found:?}"
        );
        let found = seen_without(poles, 2000.0, seed, percent);
        assert_eq!(found, None, "seed {seed}, {percent} %, poles");
    }
}

#[test]
fn the_converters_filter_is_recognised_with_a_pole_and_without() {
    for (seed, [converter, pole]) in (1..).zip([
        ["ads1281:linear", ""],
        ["ads1281:minimum", ""],
        ["ads1281:linear", "+400hz"],
        ["ads1281:minimum", "+150hz"],
        ["ads1281:linear", "+1507hz"],
    ]) {
        let rate_hz = [2000.0, 1000.0, 4000.0][seed as usize % 3];
        let found = seen(&format!("{converter}{pole}"), rate_hz, seed);
        assert_eq!(
            found.as_deref(),
            Some(converter),
            "seed {seed}, {rate_hz}/s, {pole}"
        );
    }
}

#[test]
fn poles_alone_are_no_converter() {
    for (seed, poles) in (11..).zip(["400hz", "30hz", "30hz+40hz", "5hz+80hz+300hz"]) {
        assert_eq!(seen(poles, 2000.0, seed), None, "seed {seed}, {poles}");
    }
}

#[test]
fn means_over_some_samples_are_no_converter_and_hide_none() {
    for (seed, samples) in (61..).zip([2.0, 2.22, 5.3, 9.9, 14.3]) {
        let rate_hz = [425.0, 2000.0][seed as usize % 2];
        let mean = format!(
            r#", "effects": [ {{ "effect": "averaging", "parameters": {{ "duration_s": {} }} }} ]"#,
            samples / rate_hz
        );
        let seen = |chain: &str| {
            let values = Arc::new(record_with(&mean, chain, rate_hz, seed));
            let axis = AxisState::new(values, rate_hz, None).expect("a spectrum");
            super::chain(&axis, |_| None).map(|chain| chain.to_string())
        };
        assert_eq!(
            seen(&format!("{rate_hz}hz")),
            None,
            "seed {seed}, {samples}"
        );
        let converter = seen("ads1281:linear");
        assert!(converter.is_some(), "seed {seed}, {samples}");
    }
}

#[test]
fn what_rings_below_the_wall_is_no_converter() {
    const RATE_HZ: f64 = 120.0;
    // White noise of a hundredth has a deviation of 0.08 at this rate.
    for (seed, (share, quality, amplitude)) in (71..).zip([
        (0.33, 20.0, 3.0),
        (0.35, 5.0, 1.0),
        (0.38, 40.0, 0.6),
        (0.30, 10.0, 3.0),
    ]) {
        let f_hz = share * RATE_HZ;
        let rings = format!(
            r#", "effects": [ {{ "effect": "resonance", "parameters": {{ "f_hz": {f_hz}, "width_hz": {}, "amplitude": {amplitude} }} }} ]"#,
            f_hz / quality
        );
        let values = record_with(&rings, "120hz", RATE_HZ, seed);
        for len in [9381, values.len()] {
            let values = Arc::new(values[..len].to_vec());
            let axis = AxisState::new(values, RATE_HZ, None).expect("a spectrum");
            let found = super::chain(&axis, |_| None).map(|chain| chain.to_string());
            assert_eq!(found, None, "seed {seed}, {len} samples: {share}");
        }
    }
}

#[test]
fn of_two_filters_it_is_the_one_that_needs_less_ahead() {
    let fit = |phase, laws, gain| {
        let chain = Chain {
            converter: Some(phase),
            poles_hz: Vec::new(),
        };
        (chain, laws, gain)
    };
    let chosen = |fits: [(Chain, usize, f64); 2]| {
        simplest(fits.into_iter()).and_then(|chain| chain.converter)
    };
    let (linear, minimum) = (Phase::Linear, Phase::Minimum);
    let of_both = [fit(linear, 1, 30.0), fit(minimum, 2, 50.0)];
    assert_eq!(chosen(of_both), Some(linear));
    let of_one = [fit(linear, 1, 30.0), fit(minimum, 1, 50.0)];
    assert_eq!(chosen(of_one), Some(minimum));
}

#[test]
fn another_steep_filter_is_no_converter() {
    const SEED: u64 = 21;
    // Averages of neighbours fall to nothing at half the rate, but not as a wall.
    let mut noise = crate::diagnosis::trial::numbers(SEED, 0);
    let white: Vec<f64> = (0..SAMPLES + 8).map(|_| noise.draw()).collect();
    for order in [2, 4, 8] {
        let mut values = white.clone();
        for _ in 0..order {
            values = values.windows(2).map(|two| two[0] + two[1]).collect();
        }
        let axis = AxisState::new(Arc::new(values), 100.0, None).expect("a spectrum");
        assert_eq!(
            super::chain(&axis, |_| None),
            None,
            "seed {SEED}, order {order}"
        );
    }
}

#[test]
fn behind_two_poles_the_converter_is_recognised_by_one_of_them() {
    // No mix of the five terms falls as steeply as two poles do.
    for (seed, poles) in (41..).zip(["+100hz+150hz", "+30hz+200hz", "+300hz+300hz"]) {
        let found = seen(&format!("ads1281:linear{poles}"), 2000.0, seed);
        assert_eq!(
            found.as_deref(),
            Some("ads1281:linear"),
            "seed {seed}, {poles}"
        );
    }
}

#[test]
fn where_its_wall_is_excluded_the_likelihood_says_whether_there_is_one() {
    use crate::diagnosis::trial::{RATE_HZ, excluded, numbers, ringing};
    let is_seen = |values: Vec<f64>| {
        let axis = AxisState::new(Arc::new(values), RATE_HZ, None);
        let mut axis = axis.expect("a spectrum");
        axis.exclude(excluded(WALL * RATE_HZ, 0.5 * RATE_HZ));
        axis.refresh().expect("a fit");
        super::chain(&axis, |_| None).is_some()
    };
    for seed in 51..54 {
        // Louder at 0.44 of the rate, and shut out about half of it alone: a zero there beside a pole.
        let mut white = numbers(seed, 0);
        let mut rings = ringing(seed, 0.44 * RATE_HZ, 0.03 * RATE_HZ);
        let (mut before, mut passed) = (0.0, 0.0);
        let next = |_| {
            let value = white.draw() + 0.7 * rings();
            passed = value + before - 0.6 * passed;
            before = value;
            passed
        };
        assert!(!is_seen((0..SAMPLES).map(next).collect()), "seed {seed}");
        let converter = record("ads1281:linear", RATE_HZ, seed);
        assert!(is_seen(converter), "seed {seed}: the converter");
    }
}
