//! Full-overlap estimates against published values, the definitions and closed forms.

mod size;

use inm_allan::fixed_point::FixedPoint;
use inm_allan::{Estimate, Statistic, full};
use proptest::prelude::*;
use size::{cases, size};

/// The 1000-point test set of NIST SP 1065, section 12.4, from its recurrence.
fn nbs_1000() -> Vec<f64> {
    let mut state = 1_234_567_890_u64;
    (0..1000)
        .map(|_| {
            let sample = state as f64 / 2_147_483_647.0;
            state = state * 16_807 % 2_147_483_647;
            sample
        })
        .collect()
}

/// The variance by its definition, in 128-bit integers, over one segment.
fn by_definition(statistic: Statistic, codes: &[i32], m: usize) -> Option<(u128, u64)> {
    let mut sums = vec![0_i128];
    for &code in codes {
        sums.push(sums[sums.len() - 1] + i128::from(code));
    }
    let second = |j: usize| sums[j + 2 * m] - 2 * sums[j + m] + sums[j];
    let terms = match statistic {
        Statistic::Allan => (codes.len() + 1).checked_sub(2 * m)?,
        Statistic::Modified => (codes.len() + 2).checked_sub(3 * m)?,
        Statistic::Hadamard => (codes.len() + 1).checked_sub(3 * m)?,
    };
    let total = (0..terms)
        .map(|j| {
            let difference = match statistic {
                Statistic::Allan => second(j),
                Statistic::Modified => (j..j + m).map(second).sum(),
                Statistic::Hadamard => second(j + m) - second(j),
            };
            (difference * difference) as u128
        })
        .sum();
    (terms > 0).then_some((total, terms as u64))
}

const ALL: [Statistic; 3] = [Statistic::Allan, Statistic::Modified, Statistic::Hadamard];

#[test]
fn nbs_set_gives_the_published_deviations() {
    // NIST SP 1065, table 31 (page 108), seven digits.
    let published = [
        (Statistic::Allan, [2.922319e-1, 9.159953e-2, 3.241343e-2]),
        (Statistic::Modified, [2.922319e-1, 6.172376e-2, 2.170921e-2]),
        (Statistic::Hadamard, [2.943883e-1, 9.581083e-2, 3.237638e-2]),
    ];
    let samples = nbs_1000();
    for (statistic, deviations) in published {
        for (m, expected) in [1, 10, 100].into_iter().zip(deviations) {
            let deviation = full::floats(statistic, &[&samples], m).unwrap().deviation();
            let relative = deviation / expected - 1.0;
            assert!(
                relative.abs() < 5e-7,
                "{statistic:?} m={m}: {deviation} ({relative:e})"
            );
        }
    }
}

#[test]
fn a_large_mean_loses_no_digit() {
    // Noise 1e-6 on 9.80665, on a grid of 2^-49, the spacing of f64 there, so that nothing rounds.
    let grid = 2.0_f64.powi(49);
    let noise: Vec<i32> = nbs_1000()
        .iter()
        .map(|y| ((y - 0.5) * 1e-6 * grid) as i32)
        .collect();
    let mean = (9.80665 * grid).round();
    let samples: Vec<f64> = noise
        .iter()
        .map(|&code| (f64::from(code) + mean) / grid)
        .collect();
    for statistic in ALL {
        for m in [1, 7, 100] {
            let exact = full::integers(statistic, &[&noise], m).unwrap();
            let estimate = full::floats(statistic, &[&samples], m).unwrap();
            assert_eq!(
                estimate.variance * grid * grid,
                exact.variance,
                "{statistic:?} m={m}"
            );
        }
    }
}

#[test]
fn a_gap_ends_a_segment_and_costs_nothing_else() {
    let (left, right) = (
        [5, -3, 8, 8, 1, 0, 2],
        [1_000_000, 1_000_003, 999_999, 1_000_001],
    );
    let mut joined: Vec<f64> = left.iter().map(|&code| f64::from(code)).collect();
    joined.push(f64::NAN);
    joined.extend(right.iter().map(|&code| f64::from(code)));
    for statistic in ALL {
        for m in 1..4 {
            let parts = [&left[..], &right[..]].map(|part| by_definition(statistic, part, m));
            let total: u128 = parts.iter().flatten().map(|part| part.0).sum();
            let terms: u64 = parts.iter().flatten().map(|part| part.1).sum();
            let split = full::integers(statistic, &[&left, &right], m as u64);
            let nan = full::floats(statistic, &[&joined], m as u64);
            assert_eq!(split.map(|e| e.terms), (terms > 0).then_some(terms));
            assert_eq!(nan.map(|e| e.terms), (terms > 0).then_some(terms));
            if let (Some(split), Some(nan)) = (split, nan) {
                assert_eq!(sum_of_squares(statistic, &split), total as f64);
                assert!((nan.variance / split.variance - 1.0).abs() < 1e-12);
            }
        }
    }
}

/// Undoes the normalisation; exact for the small integers of these tests.
fn sum_of_squares(statistic: Statistic, estimate: &Estimate) -> f64 {
    let m = estimate.m as f64;
    let scale = match statistic {
        Statistic::Allan => 2.0 * m * m,
        Statistic::Modified => 2.0 * m.powi(4),
        Statistic::Hadamard => 6.0 * m * m,
    };
    (estimate.variance * scale * estimate.terms as f64).round()
}

#[test]
fn too_short_or_zero_gives_none() {
    for statistic in ALL {
        assert_eq!(full::integers(statistic, &[&[1, 2, 3, 4, 5]], 3), None);
        assert_eq!(full::integers(statistic, &[&[1, 2, 3]], 0), None);
        assert_eq!(full::integers(statistic, &[], 1), None);
        assert_eq!(full::integers(statistic, &[&[1, 2, 3]], u64::MAX), None);
    }
}

#[test]
fn disjoint_octaves_add_up_to_twice_the_population_variance() {
    // For N = 2^k the differences of disjoint pairs of block means at m = 1, 2, .. N/2 are the
    // Haar coefficients: the sum over octaves of the variance of disjoint pairs, weighted by the
    // fraction of energy, is the population variance (Parseval).
    let samples: Vec<i64> = nbs_1000()
        .iter()
        .map(|y| (y * 1e6) as i64)
        .cycle()
        .take(1024)
        .collect();
    let n = samples.len();
    let mut haar = 0.0;
    let mut m = 1;
    while m < n {
        let (mut sum, mut pairs) = (0.0, 0);
        for pair in samples.chunks_exact(2 * m) {
            let codes: Vec<i32> = pair.iter().map(|&code| code as i32).collect();
            let estimate = full::integers(Statistic::Allan, &[&codes], m as u64).unwrap();
            assert_eq!(estimate.terms, 1);
            sum += estimate.variance;
            pairs += 1;
        }
        haar += sum / f64::from(pairs);
        m *= 2;
    }
    let mean = samples.iter().sum::<i64>() as f64 / n as f64;
    let variance = samples
        .iter()
        .map(|&y| (y as f64 - mean).powi(2))
        .sum::<f64>()
        / n as f64;
    // A pair contributes m (a - b)^2 / 2 = m * variance(m) of the pair to N times the population
    // variance, and there are N / 2m pairs: each octave adds half its mean.
    assert!(
        (haar / (2.0 * variance) - 1.0).abs() < 1e-12,
        "{haar} {variance}"
    );
}

#[test]
fn sampled_sinusoid_has_its_closed_form() {
    // A^2 sin^4(pi f m) / (m^2 sin^2(pi f)) when the starts cover whole periods.
    let (period, amplitude) = (16_usize, 1e8);
    let wave = |i: usize| {
        let phase = 2.0 * std::f64::consts::PI * 3.0 * i as f64 / period as f64;
        (amplitude * phase.sin()).round() as i32
    };
    for m in [1_usize, 2, 5, 7, 20] {
        let codes: Vec<i32> = (0..100 * period + 2 * m - 1).map(wave).collect();
        let estimate = full::integers(Statistic::Allan, &[&codes], m as u64).unwrap();
        let angle = std::f64::consts::PI * 3.0 / period as f64;
        let expected =
            (amplitude * (angle * m as f64).sin().powi(2) / (m as f64 * angle.sin())).powi(2);
        // Rounding to integers leaves at most one count in the deviation.
        assert!(
            (estimate.deviation() - expected.sqrt()).abs() < 1.0,
            "m={m}"
        );
    }
}

proptest! {
    #![proptest_config(cases(256, 8))]

    #[test]
    fn equals_the_definition(
        codes in prop::collection::vec(prop_oneof![Just(i32::MIN), Just(i32::MAX), any::<i32>()], 0..60),
        m in 1_usize..25,
    ) {
        for statistic in ALL {
            let direct = by_definition(statistic, &codes, m);
            let estimate = full::integers(statistic, &[&codes], m as u64);
            prop_assert_eq!(direct.map(|d| d.1), estimate.map(|e| e.terms));
            if let (Some((total, terms)), Some(estimate)) = (direct, estimate) {
                let m = m as f64;
                let scale = match statistic {
                    Statistic::Allan => 2.0 * m * m,
                    Statistic::Modified => 2.0 * m.powi(4),
                    Statistic::Hadamard => 6.0 * m * m,
                };
                let expected = total as f64 / terms as f64 / scale;
                prop_assert!((estimate.variance - expected).abs() <= 1e-15 * expected);
            }
        }
    }
}

/// The cumulative sums of `codes`, with their mean taken off.
fn cumulated(codes: impl ExactSizeIterator<Item = i64> + Clone) -> Vec<i64> {
    let level = codes.clone().map(i128::from).sum::<i128>() / (codes.len() as i128).max(1);
    let mut sums = vec![0; codes.len() + 1];
    full::cumulate(codes, level as i64, &mut sums);
    sums
}

proptest! {
    #![proptest_config(cases(256, 16))]

    /// Codes of any size, from those that are squared in 32 bits to full scale.
    #[test]
    fn cumulative_sums_give_the_same_bits(
        codes in prop::collection::vec(any::<i32>(), 0..size(1200, 150)),
        shift in 0_u32..31,
        split in any::<prop::sample::Index>(),
        m in prop_oneof![1_u64..8, 1_u64..700],
    ) {
        let codes: Vec<i32> = codes.iter().map(|code| code >> shift).collect();
        let (left, right) = codes.split_at(split.index(codes.len() + 1));
        let [left_sums, right_sums] =
            [left, right].map(|part| cumulated(part.iter().map(|&code| i64::from(code))));
        let segments = [&left_sums[..], &right_sums];
        for statistic in ALL {
            prop_assert_eq!(
                full::Cumulated::new(&segments).estimate(statistic, m),
                full::integers(statistic, &[left, right], m),
                "{:?}", statistic
            );
        }
    }
}

/// Codes as large as a grid has them, in sums that stray so far that inner sums are rounded.
#[test]
#[cfg_attr(miri, ignore = "sums that stray far enough take 60 000 samples")]
fn rounded_inner_sums_are_as_near_as_stated() {
    let mut state = 1_u64;
    let mut step = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as f64 / 2.0_f64.powi(32) - 0.5
    };
    let mut value = 0.0;
    let samples: Vec<f64> = (0..60_000)
        .map(|_| {
            value += step();
            value
        })
        .collect();
    let grid = FixedPoint::covering(samples.iter().copied(), 1.0);
    let sums = cumulated(samples.iter().map(|&sample| grid.code(sample).unwrap()));
    let segments = [&sums[..]];
    let record = full::Cumulated::new(&segments);
    let range = sums.iter().max().unwrap() - sums.iter().min().unwrap();
    // Not so far that they would be taken the slow way; rounded from m = 300 on.
    assert!(range < 1 << 56 && range > (1 << 57) / 300, "{range:e}");
    for m in [1, 10, 300, 5000, 19_999] {
        for statistic in ALL {
            let exact = full::floats(statistic, &[&samples], m).unwrap();
            let found = record.estimate(statistic, m).unwrap();
            let found_deviation = grid.scale_variance(found.variance).sqrt();
            let off = (found_deviation - exact.deviation()).abs();
            // A step over m, and the last places of two results.
            let allowed = grid.resolution() / m as f64 + 4.0 * f64::EPSILON * exact.deviation();
            assert_eq!(found.terms, exact.terms);
            assert!(
                off <= allowed,
                "{statistic:?} m={m}: {off:e} of {allowed:e}"
            );
        }
    }
}

/// Sums that leave 64 bits are taken the slow way.
#[test]
#[cfg_attr(miri, ignore = "sums that wrap take two million samples")]
fn sums_that_wrap_are_exact_too() {
    let codes: Vec<i64> = (0..1 << 21).map(|i| (1 << 42) - i % 1000).collect();
    let mut wrapped = vec![0; codes.len() + 1];
    full::cumulate(codes.iter().copied(), -1 << 42, &mut wrapped);
    assert!(wrapped.iter().any(|&sum| sum < 0), "ascending but for that");
    let sums = cumulated(codes.iter().copied());
    for statistic in ALL {
        for m in [1, 777, 600_000] {
            assert_eq!(
                full::Cumulated::new(&[&wrapped]).estimate(statistic, m),
                full::Cumulated::new(&[&sums]).estimate(statistic, m),
                "{statistic:?} m={m}"
            );
        }
    }
}
