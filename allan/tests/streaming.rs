//! The streaming bins against the direct strided evaluation, bit for bit.

mod size;
mod support;

use inm_allan::{AllanBins, Bins, Estimate, Statistic};
use proptest::prelude::*;
use size::{cases, size};
use support::{ALL, Runs, adversarial, direct, grid, normalisation};

const LEVELS: usize = size(8, 2);

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
    let run = (0_u64..300, 0_u8..7, 1..size(2500, 120), any::<u64>());
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
    #![proptest_config(cases(64, 3))]

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

/// Feeds codes in pieces whose sizes the seed decides, some of them one by one.
fn push_in_pieces(bins: &mut Bins<LEVELS>, mut codes: &[i32], mut seed: u64) {
    while !codes.is_empty() {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let longest = [1, 7, 300, 5000][(seed >> 40) as usize % 4];
        let (piece, rest) = codes.split_at(((seed >> 33) as usize % longest + 1).min(codes.len()));
        if longest == 7 {
            piece.iter().for_each(|&code| bins.push(code));
        } else {
            bins.push_slice(piece);
        }
        codes = rest;
    }
}

/// Bins over the part of a record from index `from` to `to`.
fn part(runs: &Runs, from: u64, to: u64) -> Bins<LEVELS> {
    let mut bins = Bins::starting_at(from);
    for (start, codes) in runs {
        let cut = |index: u64| (index.clamp(from, to).max(*start) - start) as usize;
        let codes = &codes[cut(from).min(codes.len())..cut(to).min(codes.len())];
        if !codes.is_empty() {
            bins.skip(start.max(&from) - bins.next_index());
            bins.push_slice(codes);
        }
    }
    bins.skip(to - bins.next_index());
    bins
}

proptest! {
    #![proptest_config(cases(64, 3))]

    #[test]
    fn any_chunking_gives_the_same_bits(runs in runs_strategy(), seed in any::<u64>()) {
        let mut single = Bins::<LEVELS>::starting_at(runs[0].0);
        feed(&mut single, &runs, Bins::skip, |bins, codes| codes.iter().for_each(|&c| bins.push(c)));
        let mut whole = Bins::<LEVELS>::starting_at(runs[0].0);
        feed(&mut whole, &runs, Bins::skip, Bins::push_slice);
        prop_assert!(single == whole, "slices");
        let mut pieces = Bins::<LEVELS>::starting_at(runs[0].0);
        feed(&mut pieces, &runs, Bins::skip, |bins, codes| push_in_pieces(bins, codes, seed));
        prop_assert!(single == pieces, "pieces");
        let mut board = AllanBins::<LEVELS>::starting_at(runs[0].0);
        feed(&mut board, &runs, AllanBins::skip, |bins, codes| codes.iter().for_each(|&c| bins.push(c)));
        let mut host = AllanBins::<LEVELS>::starting_at(runs[0].0);
        feed(&mut host, &runs, AllanBins::skip, AllanBins::push_slice);
        prop_assert_eq!(board.digest(), host.digest());
    }

    #[test]
    fn merge_from_any_parts(runs in runs_strategy(), cuts in prop::collection::vec(0.0_f64..1.0, 0..5)) {
        let first = runs[0].0;
        let last = runs.last().map_or(first, |(start, codes)| start + codes.len() as u64);
        let whole = part(&runs, first, last);
        let mut bounds: Vec<u64> =
            cuts.iter().map(|cut| first + (cut * (last - first) as f64) as u64).collect();
        bounds.extend([first, last]);
        bounds.sort_unstable();
        let parts: Vec<_> = bounds.windows(2).map(|w| part(&runs, w[0], w[1])).collect();
        // From the left, and from the right: associativity.
        let mut forward = parts[0].clone();
        for right in &parts[1..] {
            forward.merge(right).unwrap();
        }
        prop_assert!(forward == whole, "from the left");
        let mut backward = parts[parts.len() - 1].clone();
        for left in parts[..parts.len() - 1].iter().rev() {
            let mut merged = left.clone();
            merged.merge(&backward).unwrap();
            backward = merged;
        }
        prop_assert!(backward == whole, "from the right");
        // Through its serialised form.
        let words = postcard::to_stdvec(&forward).unwrap();
        prop_assert_eq!(&words, &postcard::to_stdvec(&whole).unwrap());
        prop_assert!(postcard::from_bytes::<Bins<LEVELS>>(&words).unwrap() == whole, "resumed");
        // And goes on identically.
        let more = adversarial(4, 300, 1);
        let mut whole = whole;
        whole.push_slice(&more);
        backward.push_slice(&more);
        prop_assert!(backward == whole, "continued");
        let points: Vec<_> = whole.points(Statistic::Modified).collect();
        prop_assert_eq!(points, backward.points(Statistic::Modified).collect::<Vec<_>>());
    }
}

#[test]
fn damaged_states_are_refused_or_usable() {
    let mut bins = Bins::<LEVELS>::new();
    bins.push_slice(&adversarial(4, size(3000, 300), 5));
    bins.skip(10);
    bins.push_slice(&adversarial(0, size(3000, 300), 6));
    let bytes = postcard::to_stdvec(&bins).unwrap();
    assert!(
        postcard::from_bytes::<Bins<{ LEVELS - 1 }>>(&bytes).is_err(),
        "another number of levels"
    );
    assert!(
        postcard::from_bytes::<Bins<LEVELS>>(&bytes[..bytes.len() - 1]).is_err(),
        "cut"
    );
    let spread = (0..bytes.len()).step_by(size(101, 5001));
    for position in spread.chain(0..size(200, 8)) {
        for flip in [1, 0x80, 0xFF] {
            let mut damaged = bytes.clone();
            damaged[position] ^= flip;
            if let Ok(mut state) = postcard::from_bytes::<Bins<LEVELS>>(&damaged) {
                state.push_slice(&[1, 2, 3]);
                state.skip(1);
                let mut right = Bins::starting_at(state.next_index());
                right.push(7);
                state.merge(&right).unwrap();
                assert!(
                    ALL.iter()
                        .all(|&s| state.points(s).all(|p| p.variance.is_finite()))
                );
            }
        }
    }
}

#[test]
fn states_that_do_not_meet_refuse() {
    let mut left = Bins::<LEVELS>::new();
    left.push(1);
    let right = Bins::<LEVELS>::starting_at(2);
    let error = left.merge(&right).unwrap_err();
    assert_eq!((error.left_next, error.right_first), (1, 2));
    left.skip(1);
    assert_eq!(left.merge(&right), Ok(()));
}

/// The block kernels choose their arithmetic by the size of the differences: sums that swing
/// between two values make all of them as large as the bound allows, at and beside each limit.
#[test]
fn differences_at_the_limits_of_the_arithmetic() {
    for exponent in (17..31).step_by(size(1, 13)) {
        for code in (-1..=1).map(|beside| (1 << exponent) + beside) {
            for period in [1, 5, 40] {
                let codes: Vec<i32> = (0..size(2500, 120))
                    .map(|i| [code, -code][i / period % 2])
                    .collect();
                let mut bins = Bins::<LEVELS>::new();
                bins.push_slice(&codes);
                let runs = vec![(0, codes)];
                for statistic in ALL {
                    let points: Vec<_> = bins.points(statistic).collect();
                    let context = format!("swings by {code}, period {period}");
                    assert_equals_direct(&points, statistic, &runs, &context);
                }
            }
        }
    }
}
