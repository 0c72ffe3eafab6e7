//! What a model lacks is added without a name, and what has a name has to explain more than that would.

mod tones;

use std::sync::Arc;

use super::*;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::trial::{LEVEL, RATE_HZ, axis, law, long, markov, ringing, take_in};
use crate::model::drift::{self, Drift};
use crate::model::kind::Kind;
use crate::model::{markov as markov_noise, resonance};

/// What is left of the names when noise that rings at two frequencies has none.
fn left(seed: u64, kind: Kind, values: &[f64], also: &mut dyn FnMut() -> f64) -> Vec<Kind> {
    let mut one = ringing(seed, 0.11 * RATE_HZ, 0.03 * RATE_HZ);
    let mut other = ringing(seed + 1, 0.2 * RATE_HZ, 0.05 * RATE_HZ);
    let make = |_, noise| noise + 2.0 * one() + 3.0 * other() + also();
    let mut axis = axis(seed, long(seed), make);
    take_in(&mut axis, kind, law(kind, values));
    // As it was named, not as it would be beside nothing else.
    axis.laws[0].values = values.to_vec();
    axis.fit = laws::fit(&axis.bins, &axis.data, &axis.laws).expect("a fit");
    let completed = complete(&mut axis, LEVEL);
    assert!(
        completed.p_value.is_some(),
        "seed {seed}: bands are missing"
    );
    axis.kinds()
}

#[test]
fn a_law_of_which_bands_have_most_has_lost_its_name() {
    let mut rings = [0.1, 0.3].map(|share| ringing(9, share * RATE_HZ, 0.01 * RATE_HZ));
    let mut axis = axis(9, long(9), |_, noise| {
        noise + rings.iter_mut().map(|rings| rings()).sum::<f64>()
    });
    for share in [0.1, 0.3] {
        let bell = law(resonance::KIND, &[share * RATE_HZ, 0.01 * RATE_HZ, 1.0]);
        take_in(&mut axis, resonance::KIND, bell);
    }
    let second = laws::component_of(&axis.bins, &axis.laws, 1);
    for (share, expected) in [(1.0, None), (0.6, None), (0.4, Some(1)), (0.0, Some(1))] {
        let mut fit = axis.fit.clone();
        fit.squared[second] *= share;
        let found = Lacking {
            p_value: 1e-9,
            data: axis.data.clone(),
            bands: WithBands {
                laws: axis.laws.clone(),
                fit,
                tones: Vec::new(),
                cost_nats: 10.0,
            },
            fitted: bands::fitted,
        };
        assert_eq!(replaced(&axis, &found), expected, "{share} of it is left");
    }
}

#[test]
fn a_name_without_which_bands_explain_as_much_is_taken_back() {
    const SEEDS: u64 = 8;
    let values = [0.3 * RATE_HZ, 6.0, 2.0];
    let stays = |seed: &u64| !left(*seed, resonance::KIND, &values, &mut || 0.0).is_empty();
    let stay: Vec<u64> = (1..=SEEDS).filter(stays).collect();
    // Where the search of the bands ends differs by more than a name costs, now and then.
    assert!(stay.len() <= 2, "of seeds 1 to {SEEDS}: {stay:?}");
}

#[test]
fn a_name_that_bands_would_cost_more_than_stays_beside_them() {
    for seed in 1..5 {
        // Its shelf falls more slowly than any band's.
        let mut noise = markov(seed, 30.0);
        let time_s = 30.0 / RATE_HZ;
        let values = [3.0, time_s];
        let left = left(seed, markov_noise::KIND, &values, &mut || 3.0 * noise());
        assert_eq!(left, [markov_noise::KIND], "seed {seed}");
    }
}

#[test]
fn a_tone_that_wanders_a_few_times_is_no_better_known_than_these() {
    let noise = [1.0; 4];
    let own = [40.0; 4];
    let tone = |shaped_by| Tone {
        expected: vec![0.0, 9.0, 27.0, 0.0],
        shaped_by,
    };
    assert_eq!(freedom(&noise, &own, &[tone(f64::INFINITY)]), own);
    let few = freedom(&noise, &own, &[tone(8.0)]);
    // A quarter and three quarters of eight values.
    let expected = |share: f64, values: f64| (1.0 / 40.0 + 0.5 * share * share / values).recip();
    for (bin, expected) in [40.0, expected(0.9, 2.0), expected(27.0 / 28.0, 6.0), 40.0]
        .into_iter()
        .enumerate()
    {
        assert!((few[bin] / expected - 1.0).abs() < 1e-12, "{few:?}");
    }
}

/// Noise without a name at a tenth of the rate, of this deviation.
fn lacking_a_band(seed: u64, deviation: f64) -> AxisState {
    let mut band = ringing(seed, 0.1 * RATE_HZ, 0.01 * RATE_HZ);
    axis(seed, long(seed), |_, noise| noise + deviation * band())
}

#[test]
fn what_is_missing_is_missing_at_a_level() {
    for seed in 20..22 {
        let axis = lacking_a_band(seed, 0.3);
        let missing = |level: f64| lacking(&axis, axis.data.dof.clone(), &[], level);
        let p_value = missing(1.0).expect("a band").p_value;
        assert!(p_value < LEVEL, "seed {seed}: {p_value:e}");
        assert!(missing(2.0 * p_value).is_some(), "seed {seed}: {p_value:e}");
        assert!(missing(0.5 * p_value).is_none(), "seed {seed}: {p_value:e}");
    }
}

#[test]
fn where_noise_was_taken_out_with_a_course_its_bins_still_say_nothing() {
    const SEED: u64 = 23;
    let mut axis = lacking_a_band(SEED, 1.0);
    let course = Wave::Drift {
        rate_hz: axis.rate_hz,
        absorbs_hz: 1.0,
        drift: Arc::new(Drift {
            duration_s: axis.residual.len() as f64 / axis.rate_hz,
            levels: vec![0.0; 5],
        }),
    };
    take_in(&mut axis, drift::KIND, course.into());
    assert!(complete(&mut axis, LEVEL).p_value.is_some(), "seed {SEED}");
    let known = axis.data.dof.iter().zip(axis.bins.dof());
    let known: Vec<f64> = known.map(|(known, own)| known / own).collect();
    assert!(
        known[0] < 1e-6 && known[known.len() - 1] == 1.0,
        "seed {SEED}"
    );
}
