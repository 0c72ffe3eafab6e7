//! Whether every level sees the same noise, and what a gap costs.

use rand_distr::{Distribution, StandardNormal};

use super::super::segments::LEN;
use super::*;

fn white(seed: u64, len: usize) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64::new(u128::from(seed), 1);
    (0..len).map(|_| StandardNormal.sample(&mut rng)).collect()
}

#[test]
fn white_noise_has_the_same_density_at_every_level() {
    let seed = 11;
    let mut cascade = Cascade::default();
    cascade.push_values(5, &white(seed, 1 << 20)).unwrap();
    for (depth, level) in cascade.levels().iter().enumerate().take(3) {
        let power = level.power();
        let ks = LEN / 20..=LEN * 2 / 5;
        let count = ks.clone().count() as f64;
        let mean = ks.map(|k| power.at(k)).sum::<f64>()
            / (count * power.segments as f64 * 0.5 * LEN as f64 * 8.0_f64.powi(-(depth as i32)));
        // Every sample of the level carries 0.7 of a degree of freedom in this band.
        let sigma = (2.0 / (0.7 * LEN as f64 * 0.5 * power.segments as f64)).sqrt();
        assert!(
            (mean - 1.0).abs() < 4.0 * sigma,
            "seed {seed}, level {depth}: {mean}"
        );
    }
}

#[test]
fn chunks_do_not_matter_and_a_gap_costs_only_what_it_breaks() {
    let noise = white(3, 100_000);
    let mut whole = Cascade::default();
    whole.push_values(0, &noise).unwrap();
    let mut pieces = Cascade::default();
    let (mut at, mut len) = (0, 1);
    while at < noise.len() {
        let end = (at + len).min(noise.len());
        pieces.push_values(at as u64, &noise[at..end]).unwrap();
        at = end;
        len = (len * 5 + 1) % 7919;
    }
    for (one, other) in whole.levels().iter().zip(pieces.levels()) {
        assert_eq!(one.power().segments, other.power().segments);
        for k in 1..=LEN / 2 {
            let (one, other) = (one.power().at(k), other.power().at(k));
            assert!((one - other).abs() <= 1e-9 * one, "bin {k}: {one} {other}");
        }
    }
    let mut holed = noise.clone();
    holed[50_000] = f64::NAN;
    let mut gapped = Cascade::default();
    gapped.push_values(0, &holed).unwrap();
    let segments = |cascade: &Cascade, level: usize| cascade.levels()[level].power().segments;
    // One sample lies in two segments of its level; with the filters' reach, in at most
    // three of the levels below.
    assert_eq!(segments(&gapped, 0), segments(&whole, 0) - 2);
    assert!(segments(&gapped, 1) + 3 >= segments(&whole, 1));
    assert!(gapped.push_values(1, &[0.0]).is_err());
}
