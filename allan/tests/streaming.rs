//! The streaming bins against the direct strided evaluation, bit for bit.

mod support;

use inm_allan::{AllanBins, Bins, Estimate, Statistic};
use proptest::prelude::*;
use support::{ALL, Runs, adversarial, direct, grid, normalisation};

const LEVELS: usize = 8;

fn assert_equals_direct(points: &[Estimate], statistic: Statistic, runs: &Runs, context: &str) {
    let mut points = points.iter();
    for (m, stride) in grid(40 << LEVELS) {
        let (total, terms) = direct(statistic, runs, m, stride);
        if terms == 0 {
            continue;
        }
        let point = points
            .next()
            .unwrap_or_else(|| panic!("{context}: nothing at m={m}"));
        assert_eq!(
            (point.m, point.stride, point.terms),
            (m, stride, terms),
            "{context}"
        );
        // Identical integers give identical floats: limbs are rounded in the same order.
        let low = total as u64 as f64;
        let total = (total >> 64) as u64 as f64 * 18_446_744_073_709_551_616.0 + low;
        let expected = total / terms as f64 / normalisation(statistic, m);
        assert_eq!(point.variance, expected, "{context}: {statistic:?} m={m}");
    }
    assert_eq!(points.next(), None, "{context}");
}

fn runs_strategy() -> impl Strategy<Value = Runs> {
    let run = (0_u64..300, 0_u8..7, 1_usize..2500, any::<u64>());
    (0_u64..5000, prop::collection::vec(run, 1..5)).prop_map(|(first, parts)| {
        let mut at = first;
        parts
            .into_iter()
            .enumerate()
            .map(|(i, (gap, kind, len, seed))| {
                // A gap of zero would be no gap; the first run begins where the bins do.
                at += if i == 0 { 0 } else { gap + 1 };
                let start = at;
                at += len as u64;
                (start, adversarial(kind, len, seed))
            })
            .collect()
    })
}

fn feed<T>(bins: &mut T, runs: &Runs, skip: impl Fn(&mut T, u64), push: impl Fn(&mut T, &[i32])) {
    let mut at = runs[0].0;
    for (start, codes) in runs {
        skip(bins, start - at);
        push(bins, codes);
        at = start + codes.len() as u64;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn equal_the_direct_evaluation(runs in runs_strategy()) {
        let mut bins = Bins::<LEVELS>::starting_at(runs[0].0);
        feed(&mut bins, &runs, Bins::skip, |bins, codes| codes.iter().for_each(|&c| bins.push(c)));
        for statistic in ALL {
            let points: Vec<_> = bins.points(statistic).collect();
            assert_equals_direct(&points, statistic, &runs, "family");
        }
        let mut bins = AllanBins::<LEVELS>::starting_at(runs[0].0);
        feed(&mut bins, &runs, AllanBins::skip, |bins, codes| {
            codes.iter().for_each(|&c| bins.push(c));
        });
        let points: Vec<_> = bins.points().collect();
        assert_equals_direct(&points, Statistic::Allan, &runs, "board");
    }
}
