//! The Allan variance that the judge expects of a record, against closed forms and against records.

use std::f64::consts::{LN_2, PI, TAU};

use inm_tests::hidden::case::{Case, Plan};
use inm_tests::hidden::effect::{self, find};
use inm_tests::hidden::noise::allan::{of_course, of_law};
use inm_tests::hidden::noise::base::densities;
use inm_tests::hidden::strength::Strength;

const RATE_HZ: f64 = 2000.0;

#[test]
fn the_five_terms_have_their_closed_forms() {
    let ms = [1, 2, 3, 40, 1024];
    let law = |term: usize| of_law(RATE_HZ, &ms, |f_hz| densities(f_hz, RATE_HZ, true)[term]);
    let forms: [fn(f64, f64) -> f64; 4] = [
        // The walk as a sum over samples.
        |tau_s, m| tau_s / 3.0 * (1.0 + 0.5 / (m * m)),
        |_, _| 2.0 * LN_2 / PI,
        |tau_s, _| 1.0 / tau_s,
        |tau_s, _| 3.0 / (tau_s * tau_s),
    ];
    for (term, form) in forms.into_iter().enumerate() {
        for (&m, expected) in ms.iter().zip(law(term)) {
            // Flicker's form is that of long averages; the sum over points leaves 1e-5 of the others.
            let slack = match (term, m) {
                (1, ..=3) => continue,
                (1, _) => 1e-3,
                _ => 1e-5,
            };
            let ratio = expected / form(m as f64 / RATE_HZ, m as f64);
            assert!((ratio - 1.0).abs() < slack, "term {term}, m = {m}: {ratio}");
        }
    }
}

#[test]
fn courses_have_theirs() {
    let ms = [1, 7, 300];
    let (slope, f_hz, amplitude) = (0.3, 61.7, 2.0);
    let t_s = |i: u32| f64::from(i) / RATE_HZ;
    let ramp: Vec<f64> = (0..100_000).map(|i| 5.0 + slope * t_s(i)).collect();
    let line: Vec<f64> = (0..100_000)
        .map(|i| amplitude * (TAU * f_hz * t_s(i)).cos())
        .collect();
    let (ramp, line) = (of_course(&ramp, &ms), of_course(&line, &ms));
    for (place, &m) in ms.iter().enumerate() {
        let (m, tau_s) = (m as f64, m as f64 / RATE_HZ);
        let form = (slope * tau_s).powi(2) / 2.0;
        assert!(
            (ramp[place] / form - 1.0).abs() < 1e-9,
            "m = {m}: {}",
            ramp[place]
        );
        // The mean over all phases; that over this record's ends within a few of 6000 turns.
        let x = PI * f_hz / RATE_HZ;
        let form = (amplitude * (m * x).sin().powi(2) / (m * x.sin())).powi(2);
        assert!(
            (line[place] / form - 1.0).abs() < 1e-3,
            "m = {m}: {}",
            line[place]
        );
    }
    assert_eq!(of_course(&[1.0; 50], &[1, 25, 26]), [0.0; 3]);
    assert_eq!(of_course(&[], &[1]), [0.0]);
}

/// Records of every kind, ten times as strong as need be, have the Allan variance that is expected of
/// them: the mean ratio over seeds lies within five deviations of one. Differences over m samples, of
/// which N / m do not overlap, have a relative variance of at most 3.9 m / N (quantisation noise's), to
/// which a thousandth is added for what is neglected.
#[test]
fn records_have_the_variance_that_is_expected() {
    const SAMPLES: usize = 1 << 16;
    const SEEDS: std::ops::RangeInclusive<u64> = 1..=2;
    let ms = [1, 4, 32, 256];
    for kind in effect::KINDS {
        let plan = Plan {
            kinds: vec![kind],
            strength: Strength::At(10.0),
            samples: SAMPLES,
        };
        let mut ratios: Vec<Vec<f64>> = vec![Vec::new(); ms.len()];
        for seed in SEEDS {
            let case = Case::draw(&plan, seed);
            let Some(expected) = case.allan_variances(&ms) else {
                assert_eq!(kind.name, "quantisation", "only its steps have no law");
                continue;
            };
            let measured = of_course(&case.columns[case.scene.target], &ms);
            for ((ratios, measured), expected) in ratios.iter_mut().zip(measured).zip(expected) {
                ratios.push(measured / expected);
            }
        }
        for (m, ratios) in ms
            .iter()
            .zip(&ratios)
            .filter(|(_, ratios)| !ratios.is_empty())
        {
            let count = ratios.len() as f64;
            let mean = ratios.iter().sum::<f64>() / count;
            let tolerance = 5.0 * (3.9 * *m as f64 / SAMPLES as f64 / count).sqrt() + 1e-3;
            assert!(
                (mean - 1.0).abs() < tolerance,
                "{}, m = {m}, seeds {SEEDS:?}: {mean} of what is expected, tolerance {tolerance}",
                kind.name
            );
        }
    }
}

/// A step that leaves few codes has no law; one that hides in the noise has.
#[test]
fn coarse_steps_have_no_law() {
    let known = |strength: f64| {
        let plan = Plan {
            kinds: vec![find("quantisation").expect("a kind")],
            strength: Strength::At(strength),
            samples: 1 << 16,
        };
        Case::draw(&plan, 1).allan_variances(&[1]).is_some()
    };
    assert!(known(1.0) && known(3.5));
    assert!(!known(4.0) && !known(10.0));
}
