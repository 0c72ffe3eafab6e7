//! The hidden effects' noise against formulas written independently of it.

use std::f64::consts::{LN_2, PI};

use inm_tests::hidden::axis::Axis;
use inm_tests::hidden::draw::Draw;
use inm_tests::hidden::noise::base::Base;
use inm_tests::hidden::noise::chain::Chain;
use inm_tests::hidden::scene::Scene;

const RATE_HZ: f64 = 2000.0;
const SILENT: Base = Base {
    r: 0.0,
    k: 0.0,
    b: 0.0,
    n: 0.0,
    q: 0.0,
    mean: 0.0,
};

fn record(base: Base, chain: Chain, seed: u64) -> Vec<f64> {
    let scene = Scene {
        rate_hz: RATE_HZ,
        samples: 1 << 18,
        axes: vec![base],
        target: 0,
        chain,
        declared: true,
        relative: false,
        missing: 0.0,
        code: 0.0,
        measured: None,
    };
    Axis::new(&scene, 0, &[], seed, "noise").samples().0
}

/// Allan variance by eq. 4, and the means it is taken from.
fn allan_variance(samples: &[f64], m: usize) -> (f64, usize) {
    let means: Vec<f64> = samples
        .chunks_exact(m)
        .map(|chunk| chunk.iter().sum::<f64>() / m as f64)
        .collect();
    let sum: f64 = means.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
    (sum / (2.0 * (means.len() - 1) as f64), means.len() - 1)
}

/// The mean of several records' Allan variances lies within five deviations of `law`, and
/// within `slack` of it where the law is an approximation. A mean of K squared differences has
/// relative variance 2 (1 + 2 sum rho^2) / K, at most 3.9 / K (that of quantisation noise, whose
/// neighbours are correlated by -2/3 and 1/6).
fn check(base: Base, chain: Chain, ms: &[usize], slack: f64, law: impl Fn(usize) -> f64) {
    let seeds = 1..=6;
    let records: Vec<Vec<f64>> = seeds
        .clone()
        .map(|seed| record(base, chain, seed))
        .collect();
    for &m in ms {
        let (mut mean, mut terms) = (0.0, 0);
        for samples in &records {
            let (variance, count) = allan_variance(samples, m);
            mean += variance / records.len() as f64;
            terms += count;
        }
        let ratio = mean / law(m);
        let tolerance = 5.0 * (3.9 / terms as f64).sqrt() + slack;
        assert!(
            (ratio - 1.0).abs() < tolerance,
            "m = {m}, seeds {seeds:?}: {ratio} of the law, tolerance {tolerance}; {base:?}"
        );
    }
}

fn tau(m: usize) -> f64 {
    m as f64 / RATE_HZ
}

#[test]
fn white_noise_falls_as_one_over_tau() {
    let base = Base { n: 1.3, ..SILENT };
    check(base, Chain::None, &[1, 2, 7, 64, 1024], 0.0, |m| {
        1.69 / tau(m)
    });
}

#[test]
fn the_walk_has_the_sampled_walks_variance() {
    let base = Base { k: 0.7, ..SILENT };
    check(base, Chain::None, &[1, 2, 7, 64, 1024], 0.0, |m| {
        0.49 * tau(m) / 3.0 * (1.0 + 0.5 / (m * m) as f64)
    });
}

#[test]
fn quantisation_falls_as_one_over_tau_squared() {
    let base = Base { q: 0.2, ..SILENT };
    check(base, Chain::None, &[1, 2, 7, 64, 1024], 0.0, |m| {
        3.0 * 0.04 / tau(m).powi(2)
    });
}

/// Where m is large; at m = 1 the band ends within the averaging.
#[test]
fn flicker_is_flat() {
    let base = Base { b: 2.0, ..SILENT };
    check(base, Chain::None, &[16, 64, 256, 1024], 0.005, |_| {
        4.0 * 2.0 * LN_2 / PI
    });
}

#[test]
fn all_terms_add() {
    let base = Base {
        r: 0.0,
        k: 0.7,
        b: 0.4,
        n: 0.01,
        q: 1e-4,
        mean: 9.8,
    };
    check(base, Chain::None, &[16, 128, 1024], 0.01, |m| {
        let tau = tau(m);
        0.49 * tau / 3.0 * (1.0 + 0.5 / (m * m) as f64)
            + 0.16 * 2.0 * LN_2 / PI
            + 1e-4 / tau
            + 3e-8 / tau.powi(2)
    });
}

#[test]
fn ramp_and_mean_are_what_they_say() {
    let base = Base {
        r: 0.03,
        n: 1e-6,
        mean: -2.0,
        ..SILENT
    };
    let samples = record(base, Chain::None, 1);
    let last = samples.len() - 1;
    // The synthesis starts within a few deviations, sqrt(rate) N, of zero.
    let tolerance = 10.0 * 1e-6 * RATE_HZ.sqrt();
    assert!((samples[0] + 2.0).abs() < tolerance);
    assert!((samples[last] + 2.0 - 0.03 * last as f64 / RATE_HZ).abs() < tolerance);
}

/// Ratios of the Allan deviation of white noise behind the chain to that of white noise, from a
/// numeric integral over the filter's coefficients (1, 2, 3, 4, 8, 64 samples at 2000/s).
#[test]
fn the_chain_shapes_white_noise() {
    let base = Base { n: 1.0, ..SILENT };
    let ms = [1, 2, 3, 4, 8, 64];
    for (pole_hz, factors) in [
        (None, [0.813, 0.998, 0.960, 0.992, 0.990, 0.999]),
        (Some(400), [0.476, 0.720, 0.799, 0.855, 0.928, 0.991]),
    ] {
        let chain = Chain::Ads1281 { pole_hz };
        // Three decimals of a deviation: 0.1 to 0.25 % of a variance.
        check(base, chain, &ms, 0.0025, |m| {
            let index = ms.iter().position(|&known| known == m);
            let factor = factors[index.expect("one of the list")];
            factor * factor / tau(m)
        });
    }
}

/// Different seeds, and different names of the same seed, are independent.
#[test]
fn streams_are_independent() {
    let draws = |seed: u64, name: &str| -> Vec<f64> {
        let mut draw = Draw::new(seed, name);
        (0..10_000).map(|_| draw.normal()).collect()
    };
    let first = draws(1, "a");
    assert_eq!(first, draws(1, "a"));
    for other in [draws(2, "a"), draws(1, "b")] {
        let sum: f64 = first.iter().zip(&other).map(|(a, b)| a * b).sum();
        assert!(sum.abs() < 5.0 * 100.0, "correlation {}", sum / 1e4);
    }
}
