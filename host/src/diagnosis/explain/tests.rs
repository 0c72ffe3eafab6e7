//! What is said of an axis before and after its search.

use super::*;
use crate::diagnosis::refused::LEAST;
use crate::diagnosis::statistic::matched_filter::Transformer;
use crate::diagnosis::trial::{
    LEVEL, axis, law, markov as wander, numbers, ringing, short, take_in,
};
use crate::model::{markov, telegraph};
use crate::signal::Unit;

const SEED: u64 = 1;

fn signal() -> Axis {
    Axis {
        name: "X".into(),
        unit: Unit::default(),
        scale: 1.0,
        zero: 0.0,
        chain: None,
    }
}

#[test]
fn a_record_of_too_few_samples_that_count_is_refused() {
    let mut values = vec![1.0; LEAST];
    assert_eq!(long_enough(&signal(), &values), Ok(()));
    values[7] = f64::NAN;
    let short = Refused::TooShort {
        axis: "X".into(),
        samples: LEAST - 1,
    };
    assert_eq!(long_enough(&signal(), &values), Err(short));
}

#[test]
fn without_a_spectrum_a_record_is_constant_or_broken() {
    let mut values = [f64::NAN, 3.0, f64::NAN, 3.0];
    let axis = || "X".to_owned();
    let constant = Refused::Constant { axis: axis() };
    assert_eq!(refusal(&signal(), &values), constant);
    values[0] = 2.0;
    let broken = Refused::Broken { axis: axis() };
    assert_eq!(refusal(&signal(), &values), broken);
}

#[test]
fn only_what_is_significant_is_said_of_the_five_terms() {
    let options = Options {
        family_level: 0.01,
        covariate: None,
        suspects: Vec::new(),
        views: false,
    };
    let said = |axis: &AxisState| Bare::of(axis, LEVEL, &options).discrepancies.len();
    let plain = axis(SEED, short(SEED), |_, noise| noise);
    assert_eq!(said(&plain), 0, "seed {SEED}");
    let mut rings = ringing(SEED, 100.0, 10.0);
    let rung = axis(SEED, short(SEED), |_, noise| noise + rings());
    assert_eq!(said(&rung), 1, "seed {SEED}");
}

#[test]
fn two_levels_have_twice_the_deviation_and_the_time_of_their_law() {
    let mut drawn = wander(SEED, 20.0);
    let mut axis = axis(SEED, short(SEED), |_, noise| noise + drawn());
    take_in(&mut axis, telegraph::KIND, law(markov::KIND, &[1.0, 0.02]));
    let sized = crate::diagnosis::laws::sized(&axis.bins, &axis.laws, 0, &axis.fit);
    with_intervals(&mut axis);
    let told = axis.explanations()[0].effect.plain();
    for (told, sized) in told.iter().zip(&sized) {
        let ratio = told / sized;
        assert!((ratio - 2.0).abs() < 1e-9, "seed {SEED}: {ratio}");
    }
    assert_eq!(told.len(), 2, "seed {SEED}");
}

#[test]
fn behind_a_converter_that_is_recognised_the_record_is_explained_anew() {
    let chain: Chain = "ads1281:linear".parse().expect("a chain");
    let rate_hz = 1000.0;
    let ring = Transformer::new(1 << 14);
    let density = |k: usize| {
        let f_hz = k as f64 * rate_hz / ring.len() as f64;
        chain.power(f_hz, rate_hz) / rate_hz + 1e-9
    };
    let density: Vec<f64> = (0..=ring.len() / 2).map(density).collect();
    let mut normal = numbers(SEED, 0);
    let values = ring.noise(&density, rate_hz, || normal.draw()).to_vec();
    let options = Options {
        family_level: 0.01,
        covariate: None,
        suspects: Vec::new(),
        views: false,
    };
    let explained = explain(&signal(), values.into(), rate_hz, &options, &|_, _| {});
    let explained = explained.expect("a record that can be explained");
    assert_eq!(explained.recognised.as_ref(), Some(&chain), "seed {SEED}");
    assert_eq!(explained.axis.chain, Some(chain), "seed {SEED}");
    // Noise as white as any, once the filter is known.
    assert_eq!(explained.axis.kinds(), [], "seed {SEED}");
}
