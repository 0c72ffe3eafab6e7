//! The ideal detector's formulas against closed forms and against simulated detectors.

use std::f64::consts::TAU;

use inm_tests::hidden::draw::Draw;
use inm_tests::hidden::effect::tone::trials;
use inm_tests::hidden::effect::{self, Kind};
use inm_tests::hidden::ideal::detector::{Evidence, FAMILY_LEVEL, power, threshold};
use inm_tests::hidden::ideal::grid::Grid;
use inm_tests::hidden::ideal::levels::{Data, contrast as levels};
use inm_tests::hidden::ideal::matched::energy;
use inm_tests::hidden::ideal::spectral::contrast;
use inm_tests::hidden::noise::base::Base;
use inm_tests::hidden::noise::chain::Chain;
use inm_tests::hidden::outside;
use inm_tests::hidden::scene::Scene;
use inm_tests::hidden::strength::unit;
use nalgebra::{Cholesky, DMatrix, DVector};
use realfft::RealFftPlanner;

fn scene(base: Base, samples: usize) -> Scene {
    Scene {
        rate_hz: 2000.0,
        samples,
        axes: vec![base],
        target: 0,
        chain: Chain::None,
        declared: true,
        relative: false,
        missing: 0.0,
        code: 0.0,
        measured: None,
    }
}

const WHITE: Base = Base {
    r: 0.0,
    k: 0.0,
    b: 0.0,
    n: 1.0,
    q: 0.0,
    mean: 0.0,
};

/// 20 000 draws of the statistic itself: five deviations of the share.
#[test]
fn power_is_that_of_noncentral_chi_squared() {
    let mut draw = Draw::new(1, "chi-squared");
    for (non_centrality, parameters, trials) in [(20.0_f64, 1, 10.0), (40.0, 2, 1e5), (0.0, 3, 1.0)]
    {
        let limit = threshold(f64::from(parameters), trials);
        let draws = 20_000;
        let mut above = 0;
        for _ in 0..draws {
            let shifted = (draw.normal() + non_centrality.sqrt()).powi(2);
            let rest: f64 = (1..parameters).map(|_| draw.normal().powi(2)).sum();
            above += u32::from(shifted + rest > limit);
        }
        let share = f64::from(above) / f64::from(draws);
        let expected = power(non_centrality, f64::from(parameters), trials);
        let deviation = (expected * (1.0 - expected) / f64::from(draws)).sqrt();
        assert!(
            (share - expected).abs() < 5.0 * deviation + 1e-9,
            "seed 1: {share}, expected {expected}"
        );
    }
}

/// The search for a line, simulated: the largest ordinate of a periodogram padded eight times,
/// in white noise and with a line of the strength that 99 % asks for. Records of 1024 samples.
#[test]
fn the_search_for_a_line_keeps_its_level_and_its_power() {
    const SAMPLES: usize = 1024;
    let limit = threshold(2.0, trials(SAMPLES));
    let mut non_centrality = 1.0;
    while power(non_centrality, 2.0, trials(SAMPLES)) < 0.99 {
        non_centrality *= 1.01;
    }
    let amplitude = (2.0_f64 * non_centrality / SAMPLES as f64).sqrt();
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(8 * SAMPLES);
    let mut spectrum = plan.make_output_vec();
    let mut draw = Draw::new(1, "lines");
    let mut share = |amplitude: f64, records: u32| {
        let mut found = 0;
        for _ in 0..records {
            let (cycles, phase) = (draw.uniform(0.02, 0.45), draw.uniform(0.0, TAU));
            let mut samples = vec![0.0; 8 * SAMPLES];
            for (i, sample) in samples[..SAMPLES].iter_mut().enumerate() {
                let line = amplitude * (TAU * cycles * i as f64 + phase).cos();
                *sample = draw.normal() + line;
            }
            plan.process(&mut samples, &mut spectrum)
                .expect("sizes fit");
            // The ends are not chi-squared with two degrees of freedom.
            let ordinates = &spectrum[16..spectrum.len() - 16];
            let largest = ordinates.iter().map(|x| x.norm_sqr()).fold(0.0, f64::max);
            found += u32::from(2.0 * largest / SAMPLES as f64 > limit);
        }
        f64::from(found) / f64::from(records)
    };
    let false_alarms = share(0.0, 8000);
    let deviation = (FAMILY_LEVEL / 8000.0_f64).sqrt();
    // The trials are those of a larger record's threshold, a tenth too many here.
    assert!(
        (false_alarms - FAMILY_LEVEL).abs() < 5.0 * deviation,
        "seed 1: {false_alarms} false"
    );
    let found = share(amplitude, 1000);
    let deviation = (0.99_f64 * 0.01 / 1000.0).sqrt();
    assert!(found > 0.99 - 5.0 * deviation, "seed 1: {found} found");
}

/// White noise: what a fitted mean and ramp leave of a step. Walk: one increment among white
/// ones, less a fitted slope.
#[test]
fn a_step_has_the_energy_of_its_closed_form() {
    const SAMPLES: usize = 1 << 12;
    let n = SAMPLES as f64;
    for share in [0.1, 0.5, 0.7] {
        let at = (share * n) as usize;
        let waveform: Vec<f64> = (0..SAMPLES)
            .map(|i| f64::from(u8::from(i >= at)) * 3.0)
            .collect();
        let found = energy(&waveform, &scene(WHITE, SAMPLES), 0);
        let spread = share * (1.0 - share);
        let expected = 9.0 * n / 2000.0 * (spread - 3.0 * spread * spread);
        assert!(
            (found / expected - 1.0).abs() < 1e-2,
            "{found}, expected {expected}"
        );
        let walk = Base {
            k: 2.0,
            n: 0.0,
            ..WHITE
        };
        let found = energy(&waveform, &scene(walk, SAMPLES), 0);
        let expected = 9.0 * 2000.0 / 4.0 * (1.0 - 1.0 / (n - 1.0));
        assert!(
            (found / expected - 1.0).abs() < 1e-6,
            "{found}, expected {expected}"
        );
    }
}

/// A band of the share `p` that is `r` times as high as white noise of unknown level:
/// `N [ln(1 + p (r - 1)) - p ln r]`. And what the base can imitate is no evidence.
#[test]
fn spectra_are_compared_with_the_nearest_base() {
    let scene = scene(WHITE, 1 << 14);
    let grid = Grid::new(&scene, &[]);
    let total: f64 = grid.weight.iter().sum();
    let raised = |f_hz: f64| if f_hz > 700.0 { 1.3 } else { 1.0 };
    let truth = grid.at(raised);
    let weights = grid.weight.iter().zip(&truth);
    let share = weights
        .filter(|(_, s)| **s > 1.0)
        .map(|(w, _)| w)
        .sum::<f64>()
        / total;
    let found = contrast(&truth, &[grid.at(|_| 5.0)], &grid).mean;
    let expected = total * ((1.0 + 0.3 * share).ln() - share * 1.3_f64.ln());
    assert!(
        (found / expected - 1.0).abs() < 1e-6,
        "{found}, expected {expected}"
    );

    let mixed = Base {
        k: 0.5,
        b: 2.0,
        n: 0.3,
        q: 1e-3,
        ..WHITE
    };
    let law = Scene {
        axes: vec![mixed],
        ..scene.clone()
    };
    let truth = grid.at(|f_hz| law.density(0, f_hz));
    let found = contrast(&truth, &grid.base(&scene, |_| 1.0), &grid).mean;
    assert!((0.0..0.01).contains(&found), "{found}");
}

/// The ratio's mean and variance, of simulated cosine coefficients: 4000 draws, five deviations.
#[test]
fn the_spectral_ratio_has_its_mean_and_variance() {
    let scene = scene(WHITE, 1 << 9);
    let grid = Grid::new(&scene, &[]);
    let raised = |f_hz: f64| if f_hz > 500.0 { 2.0 } else { 1.0 };
    let truth = grid.at(raised);
    let expected = contrast(&truth, &[grid.at(|_| 1.0)], &grid);
    let mut draw = Draw::new(1, "spectra");
    let (coefficients, draws) = (1 << 9, 4000);
    let level = 1.5_f64;
    let ratios: Vec<f64> = (0..draws)
        .map(|_| {
            let one = |k: i32| {
                let s = raised((f64::from(k) + 0.5) * 1000.0 / f64::from(coefficients));
                let square = s * draw.normal().powi(2);
                square / level + level.ln() - square / s - s.ln()
            };
            (0..coefficients).map(one).sum()
        })
        .collect();
    let mean = ratios.iter().sum::<f64>() / f64::from(draws);
    let variance = ratios.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(draws);
    let error = (expected.variance / f64::from(draws)).sqrt();
    assert!(
        (mean - expected.mean).abs() < 5.0 * error + 0.02 * expected.mean,
        "seed 1: {mean}, expected {expected:?}"
    );
    let relative = 5.0 * (2.0 / f64::from(draws)).sqrt() + 0.03;
    assert!(
        (variance / expected.variance - 1.0).abs() < relative,
        "seed 1: {variance}, expected {expected:?}"
    );
}

/// Levels so far apart that noise never confuses them: the Gaussian pays
/// `ln(sqrt(1 + h^2 / 4 v)) + 1/2 - ln 2 - 1/2` a block.
#[test]
fn two_levels_far_apart_are_told_from_a_gaussian() {
    let found = levels(20.0, 1.0, 1.0, Data::TwoLevels).mean;
    let expected = 2.0 * (0.5 * 101.0_f64.ln() - 2.0_f64.ln());
    assert!(
        (found - expected).abs() < 1e-3,
        "{found}, expected {expected}"
    );
    assert!(levels(0.01, 1.0, 1.0, Data::Gaussian).mean < 1e-6);
}

/// Strength 1 suffices, a tenth less does not, and more does: for every kind, three scenes each.
#[test]
fn strength_one_is_where_the_ideal_detector_succeeds() {
    let all: Vec<&Kind> = effect::KINDS.iter().chain(outside::KINDS).collect();
    for kind in all {
        let mut draw = Draw::new(3, kind.name);
        let mut settled = 0;
        for _ in 0..20 {
            let scene = Scene::draw(1 << 17, kind.axes, &mut draw);
            let Some(effect) = unit((kind.draw)(&scene, &mut draw).as_ref(), &scene) else {
                continue;
            };
            let at = |factor: f64| -> Evidence { effect.scaled(factor).evidence(&scene) };
            assert!(at(1.0).suffices(), "{}: {:?}", kind.name, at(1.0));
            assert!(!at(0.9).suffices(), "{}: {:?} at 0.9", kind.name, at(0.9));
            for factor in [2.0, 5.0, 10.0] {
                assert!(
                    at(factor).suffices(),
                    "{}: {:?} at {factor}",
                    kind.name,
                    at(factor)
                );
            }
            settled += 1;
            if settled == 3 {
                break;
            }
        }
        assert!(
            settled == 3,
            "{}: too few scenes have a strength 1",
            kind.name
        );
    }
}

/// Samples missing at random against the covariance of those that are there: a slow wave, in one draw of what is missing. The
/// draws scatter by some hundredths. Of quantisation noise half of what is left may go uncounted, and none may be made up.
#[test]
fn what_missing_samples_take_away_is_what_the_rest_says() {
    const SAMPLES: usize = 600;
    const MISSING: f64 = 0.3;
    let rough = Base { q: 1e-3, ..WHITE };
    let rougher = Base { q: 1e-2, ..WHITE };
    for (seed, base, least) in [(1, WHITE, 0.9), (2, rough, 0.8), (3, rougher, 0.45)] {
        let scene = Scene {
            missing: MISSING,
            measured: None,
            ..scene(base, SAMPLES)
        };
        let mut draw = Draw::new(seed, "missing");
        let there: Vec<usize> = (0..SAMPLES).filter(|_| !draw.chance(MISSING)).collect();
        let covariances = covariances(&scene, SAMPLES);
        let size = there.len();
        let matrix = DMatrix::from_fn(size, size, |i, j| covariances[there[i].abs_diff(there[j])]);
        let wave: Vec<f64> = (0..SAMPLES)
            .map(|i| (TAU * 6.0 * i as f64 / SAMPLES as f64).cos())
            .collect();
        let seen = DVector::from_iterator(size, there.iter().map(|&i| wave[i]));
        let solved = Cholesky::new(matrix).expect("positive").solve(&seen);
        let exact = seen.dot(&solved);
        let ratio = energy(&wave, &scene, 0) / exact;
        assert!((least..1.1).contains(&ratio), "seed {seed}: {ratio} of it");
    }
}

/// Autocovariances of a scene's noise.
fn covariances(scene: &Scene, lags: usize) -> Vec<f64> {
    const POINTS: usize = 8192;
    let share = |i: usize| (i as f64 + 0.5) / (2 * POINTS) as f64;
    let at = |lag: usize| {
        let each = (0..POINTS).map(|i| {
            let density = scene.density(0, share(i) * scene.rate_hz);
            density * (TAU * share(i) * lag as f64).cos()
        });
        each.sum::<f64>() * scene.rate_hz / POINTS as f64
    };
    (0..lags).map(at).collect()
}
