//! Serialised states that were tampered with. `cargo xtask fuzz state` tries the same without end.

mod any_state;
mod size;

use any_state::{LEVELS, try_state};
use inm_allan::Bins;
use proptest::prelude::*;
use size::{cases, size};

/// The words of the state after runs of samples with gaps between.
fn words(first: u64, runs: &[(u16, u8)]) -> Vec<u64> {
    let mut bins = Bins::<LEVELS>::starting_at(first);
    for &(len, gap) in runs {
        bins.push_slice(&(0..i32::from(len)).map(|k| k * k).collect::<Vec<_>>());
        bins.skip(u64::from(gap));
    }
    let bytes = postcard::to_stdvec(&bins).unwrap();
    postcard::from_bytes(&bytes).unwrap()
}

/// A word that is likely to hit a limit.
fn nasty() -> impl Strategy<Value = u64> {
    prop_oneof![
        any::<u64>(),
        0..300_u64,
        (0..64_u32).prop_map(|bit| 1 << bit),
        (0..64_u32).prop_map(|bit| (1_u64 << bit).wrapping_neg()),
    ]
}

#[test]
fn a_state_at_the_last_index_is_honest() {
    // The run ends on the last index, and the gap after it has no room.
    let words = words((1 << 63) - 100, &[(100, 1)]);
    assert!(try_state(&postcard::to_stdvec(&words).unwrap()));
}

proptest! {
    #![proptest_config(cases(2000, 6))]

    #[test]
    fn tampered_states_are_refused_or_usable(
        first in prop_oneof![Just(0), 0..5000_u64, Just((1 << 63) - 2000), Just((1 << 63) - 100)],
        runs in prop::collection::vec((0..size(700, 150) as u16, any::<u8>()), 0..3),
        // Mostly among the positions at the beginning, which the code relies on most.
        changes in prop::collection::vec((prop_oneof![0..12_usize, any::<usize>()], nasty()), 0..4),
        shorten in prop::option::of(any::<usize>()),
    ) {
        let mut words = words(first, &runs);
        let len = words.len();
        let honest = try_state(&postcard::to_stdvec(&words).unwrap());
        // Beyond 2^63 no index is promised to work.
        prop_assert!(honest || words[3] > 1 << 63, "an honest state is refused");
        for (at, word) in changes {
            words[at % len] = word;
        }
        if let Some(shorten) = shorten {
            words.truncate(len - shorten % 4);
        }
        try_state(&postcard::to_stdvec(&words).unwrap());
    }

    #[test]
    fn bytes_at_random_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(!try_state(&bytes));
    }
}
