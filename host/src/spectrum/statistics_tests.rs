//! Degrees of freedom, covariance and robustness, by simulation.

use super::{
    binning::Settings,
    cascade::Cascade,
    estimate::{Estimate, bins},
    segments::Plan,
};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;

const LEN: usize = 60_000;
const RECORDS: usize = 400;

fn white(seed: u64, len: usize) -> impl Iterator<Item = f64> {
    let mut rng = rand_pcg::Pcg64::new(u128::from(seed), 5);
    (0..len).map(move |_| StandardNormal.sample(&mut rng))
}

fn walk(seed: u64, len: usize) -> impl Iterator<Item = f64> {
    white(seed, len).scan(0.0, |sum, x| {
        *sum += x;
        Some(*sum)
    })
}

fn cascade(plan: &Plan, samples: &[f64]) -> Cascade {
    let mut cascade = Cascade::new(plan);
    cascade.push_values(0, samples).unwrap();
    cascade
}

/// Densities over expectations, `[record][bin]`, and the estimate that gives them.
fn simulate(records: &[Vec<f64>], density: fn(f64) -> f64) -> (Estimate, Vec<Vec<f64>>) {
    let (plan, settings) = (Plan::new(), Settings::default());
    let estimate = Estimate::new(&cascade(&plan, &records[0]), 1.0, &settings);
    let expected = estimate.expected(density);
    let ratios = records
        .iter()
        .map(|record| {
            let bins = bins(&cascade(&plan, record), 1.0, &settings);
            bins.iter()
                .zip(&expected)
                .map(|(bin, expected)| bin.psd / expected)
                .collect()
        })
        .collect();
    (estimate, ratios)
}

/// Mean, variances and correlations of neighbours are as claimed, within `sigmas` of what
/// `RECORDS` records can show.
fn assert_law(name: &str, estimate: &Estimate, ratios: &[Vec<f64>], from: usize, sigmas: f64) {
    let records = ratios.len() as f64;
    let moment = |a: usize, b: usize| {
        ratios
            .iter()
            .map(|r| (r[a] - 1.0) * (r[b] - 1.0))
            .sum::<f64>()
            / records
    };
    let mut origins = std::collections::BTreeSet::new();
    let (mut total, mut weight) = (0.0, 0.0);
    for (b, bin) in estimate.bins.iter().enumerate().skip(from) {
        origins.insert(format!("{:?}", bin.origin));
        let variance = estimate.covariance.at(b, b);
        assert!((variance * bin.edf / 2.0 - 1.0).abs() < 1e-12);
        let mean = ratios.iter().map(|r| r[b]).sum::<f64>() / records - 1.0;
        let sigma = (variance / records).sqrt();
        assert!(
            mean.abs() < sigmas * sigma,
            "{name}, {bin:?}: mean off by {mean} ({sigma})"
        );
        // The fourth moment of a chi-squared law of edf degrees of freedom.
        let sigma = ((2.0 + 12.0 / bin.edf) / records).sqrt();
        let ratio = moment(b, b) / variance;
        total += (ratio - 1.0) / (sigma * sigma);
        weight += 1.0 / (sigma * sigma);
        assert!(
            (ratio - 1.0).abs() < sigmas * sigma,
            "{name}, {bin:?}: variance {ratio} of claimed"
        );
        for c in b.saturating_sub(6).max(from)..b {
            let scale = (variance * estimate.covariance.at(c, c)).sqrt();
            let error = (moment(b, c) - estimate.covariance.at(b, c)) / scale;
            // Products of low degrees of freedom have heavy tails.
            let sigma = ((1.0 + 6.0 / bin.edf.min(estimate.bins[c].edf)) / records).sqrt();
            assert!(
                error.abs() < sigmas * sigma,
                "{name}, bins {c} and {b}: correlation off by {error}"
            );
        }
    }
    assert!(origins.len() >= 3, "{origins:?}");
    // Neighbouring bins share a part: as if half of them told something of their own.
    let mean = total / weight;
    let sigma = (2.0 / weight).sqrt();
    assert!(
        mean.abs() < sigmas * sigma,
        "{name}: variances off by {mean} on average ({sigma})"
    );
}

#[test]
fn white_noise_varies_as_claimed() {
    let records: Vec<_> = (0..RECORDS as u64)
        .map(|seed| white(seed, LEN).collect())
        .collect();
    let (estimate, ratios) = simulate(&records, |_| 1.0);
    assert_law("white, seeds 0..400", &estimate, &ratios, 0, 5.0);
}

#[test]
fn a_random_walk_varies_as_claimed() {
    let records: Vec<_> = (0..RECORDS as u64)
        .map(|seed| walk(7000 + seed, LEN).collect())
        .collect();
    let (estimate, ratios) = simulate(&records, |f| 0.25 / (PI * f).sin().powi(2));
    assert_law("walk, seeds 7000..7400", &estimate, &ratios, 0, 5.0);
}

/// Fisher information of a common factor: `1' C^-1 1`, by elimination.
fn information(estimate: &Estimate, keep: impl Fn(f64) -> bool) -> f64 {
    let chosen: Vec<usize> = (0..estimate.bins.len())
        .filter(|&b| keep(estimate.bins[b].f_hz))
        .collect();
    let n = chosen.len();
    let mut rows: Vec<Vec<f64>> = chosen
        .iter()
        .map(|&a| {
            chosen
                .iter()
                .map(|&b| estimate.covariance.at(a, b))
                .chain([1.0])
                .collect()
        })
        .collect();
    let mut total = 0.0;
    for pivot in 0..n {
        let head = rows[pivot].clone();
        assert!(head[pivot] > 0.0, "covariance is not positive at {pivot}");
        total += head[n] * head[n] / head[pivot];
        for row in rows.iter_mut().skip(pivot + 1) {
            let factor = row[pivot] / head[pivot];
            for (value, above) in row.iter_mut().zip(&head).skip(pivot) {
                *value -= factor * above;
            }
        }
    }
    total
}

#[test]
fn little_information_is_lost() {
    let len = 3_000_000;
    let record: Vec<f64> = white(1, len).collect();
    let estimate = Estimate::new(&cascade(&Plan::new(), &record), 1.0, &Settings::default());
    // A periodogram has one degree of information at each multiple of 1 / T.
    for (from, to, least) in [(0.01, 0.49, 0.98), (4e-5, 1e-3, 0.95), (2e-6, 4e-5, 0.97)] {
        let share = information(&estimate, |f| f > from && f < to)
            / (estimate_span(&estimate, from, to) * len as f64);
        println!("{from} to {to}: {share:.3} of the information");
        assert!(share > least && share < 1.05, "{from} to {to}: {share}");
    }
}

/// Width that bins between two frequencies cover.
fn estimate_span(estimate: &Estimate, from: f64, to: f64) -> f64 {
    let inside = estimate
        .bins
        .iter()
        .map(|bin| bin.f_hz)
        .filter(|f| *f > from && *f < to);
    let (low, high) = inside.fold((f64::MAX, 0.0_f64), |(low, high), f| {
        (low.min(f), high.max(f))
    });
    // Half a bin to either side, at sixteen an octave.
    high * 1.022 - low / 1.022
}

#[test]
fn offset_and_ramp_leave_the_estimate_alone() {
    let noise: Vec<f64> = white(5, LEN).collect();
    // Gravity in counts, and a ramp of a thousand times the noise over the record.
    let tilted: Vec<f64> = noise
        .iter()
        .enumerate()
        .map(|(n, x)| x + 2.6e8 + 1000.0 * n as f64 / LEN as f64)
        .collect();
    let (plan, settings) = (Plan::new(), Settings::default());
    let plain = bins(&cascade(&plan, &noise), 1.0, &settings);
    let tilted = bins(&cascade(&plan, &tilted), 1.0, &settings);
    for (plain, tilted) in plain.iter().zip(&tilted) {
        let change = tilted.psd / plain.psd - 1.0;
        assert!(change.abs() < 1e-5, "seed 5, {plain:?}: {change:e}");
    }
}

#[test]
fn short_constant_and_broken_records_are_survived() {
    let plan = Plan::new();
    for record in [
        vec![],
        vec![1.0],
        vec![3.0; 40],
        vec![f64::NAN; 5000],
        vec![7.0; 5000],
    ] {
        let estimate = Estimate::new(&cascade(&plan, &record), 100.0, &Settings::default());
        assert!(
            estimate.bins.iter().all(|bin| bin.psd.abs() < 1e-20),
            "{record:?}"
        );
    }
    // Nine tenths missing, in runs.
    let mut gapped = Cascade::new(&plan);
    let noise: Vec<f64> = white(8, 400_000).collect();
    for start in (0..400_000).step_by(40_000) {
        gapped
            .push_values(start as u64, &noise[start..start + 4000])
            .unwrap();
    }
    let estimate = Estimate::new(&gapped, 1.0, &Settings::default());
    let expected = estimate.expected(|_| 1.0);
    assert!(estimate.bins.len() > 20);
    for (bin, expected) in estimate.bins.iter().zip(expected) {
        let sigma = (2.0 / bin.edf).sqrt();
        assert!(
            (bin.psd / expected - 1.0).abs() < 5.0 * sigma,
            "seed 8: {bin:?} {expected}"
        );
    }
}
