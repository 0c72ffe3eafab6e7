//! Long records: the upper levels against the direct evaluation, and degrees of freedom against
//! simulation.

mod normal;
mod support;

use inm_allan::edf::{Noise, edf};
use inm_allan::{Bins, Statistic, full};
use normal::Normal;
use support::{ALL, Runs, adversarial, direct, grid, normalisation};

#[test]
#[cfg_attr(miri, ignore = "700 000 samples; the lower levels are in streaming.rs")]
fn upper_levels_equal_the_direct_evaluation() {
    // Codes of 20 bits keep the direct sums within 128 bits at the longest averaging times.
    let codes: Vec<i32> = adversarial(4, 700_000, 11)
        .iter()
        .map(|code| code >> 12)
        .collect();
    let first = 123_457;
    let mut bins = Bins::<14>::starting_at(first);
    let (left, right) = codes.split_at(400_001);
    bins.push_slice(left);
    bins.skip(1);
    bins.push_slice(right);
    let runs: Runs = vec![(first, left.to_vec()), (first + 400_002, right.to_vec())];
    for statistic in ALL {
        let points: Vec<_> = bins.points(statistic).collect();
        let mut compared = 0;
        for (m, stride) in grid(40 << 14)
            .into_iter()
            .filter(|&(m, _)| m <= 3 || m > 1000)
        {
            let (total, terms) = direct(statistic, &runs, m, stride);
            let Some(point) = points.iter().find(|point| point.m == m) else {
                assert_eq!(terms, 0, "{statistic:?} m={m}");
                continue;
            };
            let low = total as u64 as f64;
            let total = (total >> 64) as u64 as f64 * 18_446_744_073_709_551_616.0 + low;
            assert_eq!(
                (point.terms, point.stride),
                (terms, stride),
                "{statistic:?} m={m}"
            );
            assert_eq!(
                point.variance,
                total / terms as f64 / normalisation(statistic, m)
            );
            compared += 1;
        }
        assert!(compared > 30, "{compared}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "statistics over 9000 records")]
fn degrees_of_freedom_match_simulation() {
    const RECORDS: usize = 3000;
    const SAMPLES: usize = 240;
    for (noise, seed) in [
        (Noise::Quantisation, 1),
        (Noise::White, 2),
        (Noise::Walk, 3),
    ] {
        let mut normal = Normal { state: seed };
        let cases: Vec<_> = ALL
            .iter()
            .flat_map(|&s| [1, 10, 40].map(|m| (s, m)))
            .collect();
        let mut moments = vec![(0.0, 0.0); cases.len()];
        for _ in 0..RECORDS {
            let (mut level, mut before) = (0.0, normal.next());
            let record: Vec<f64> = (0..SAMPLES)
                .map(|_| {
                    let white = normal.next();
                    level += white;
                    let difference = white - before;
                    before = white;
                    match noise {
                        Noise::Quantisation => difference,
                        Noise::Walk => level,
                        _ => white,
                    }
                })
                .collect();
            for (&(statistic, m), moments) in cases.iter().zip(&mut moments) {
                let variance = full::floats(statistic, &[&record], m).unwrap().variance;
                moments.0 += variance;
                moments.1 += variance * variance;
            }
        }
        for ((statistic, m), (sum, squares)) in cases.into_iter().zip(moments) {
            let mean: f64 = sum / RECORDS as f64;
            let simulated = 2.0 * mean * mean / (squares / RECORDS as f64 - mean * mean);
            let terms = full::floats(statistic, &[&[0.0; SAMPLES]], m)
                .unwrap()
                .terms;
            let expected = edf(statistic, noise, m, 1, terms);
            // The variance of a variance of chi^2 form has relative deviation
            // sqrt((2 + 12 / edf) / n); four of them.
            let tolerance = 4.0 * ((2.0 + 12.0 / expected) / RECORDS as f64).sqrt();
            let relative = simulated / expected - 1.0;
            assert!(
                relative.abs() < tolerance,
                "{noise:?} {statistic:?} m={m} seed={seed}: {simulated} against {expected}"
            );
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "statistics over 400 000 samples")]
fn sampled_walk_has_its_closed_form() {
    // Method: (K^2 tau / 3)(1 + 1 / (2 m^2)), for unit steps m/3 + 1/(6 m). One long record of
    // random steps; five deviations of the estimate from its degrees of freedom.
    let mut level = 0;
    let mut normal = Normal { state: 77 };
    let codes: Vec<i32> = (0..400_000)
        .map(|_| {
            level += if normal.uniform() < 0.5 { 1000 } else { -1000 };
            level
        })
        .collect();
    let mut bins = Bins::<10>::new();
    bins.push_slice(&codes);
    for point in bins.points(Statistic::Allan).filter(|point| point.m < 4000) {
        let m = point.m as f64;
        let expected = 1e6 * (m / 3.0 + 1.0 / (6.0 * m));
        let edf = edf(
            Statistic::Allan,
            Noise::Walk,
            point.m,
            point.stride,
            point.terms,
        );
        let relative = point.variance / expected - 1.0;
        assert!(
            relative.abs() < 5.0 * (2.0 / edf).sqrt(),
            "m={m}: {relative}, edf {edf}, seed 77"
        );
    }
}
