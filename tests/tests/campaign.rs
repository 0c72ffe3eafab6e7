//! No wrong sample is taken for good, whatever happens together: the short form of
//! `cargo xtask faults`.

use inm_tests::campaign::{Class, Kind, Outcome, Plan, run};

/// Seeds of the short form: some seconds.
const SEEDS: u64 = 150;

/// Seeds of each kind alone, and of each kind of link.
const FEW: u64 = 20;

/// Runs this plan, which must take nothing wrong for good.
fn sound(class: Class, seed: u64) -> Outcome {
    let plan = Plan::of(class, seed);
    let outcome = run(&plan);
    assert!(
        outcome.wrong.is_empty(),
        "{class}, seed {seed}: {:x?} and {} more; {plan:?}",
        outcome.wrong[0],
        outcome.wrong.len() - 1
    );
    outcome
}

#[test]
fn every_sample_is_right_or_known_to_be_missing_or_flagged() {
    let mut right = 0;
    let mut resets = 0;
    for seed in 0..SEEDS {
        let outcome = sound(Class::Company, seed);
        right += outcome.right;
        resets += outcome.resets;
    }
    // The misfortunes are there, and cost no more than they have to.
    assert!(resets > SEEDS, "{resets} resets");
    assert!(right > 2000 * SEEDS, "{right} right samples");
}

/// The port is away over a stop and a start, and the count of the new stream is ahead of the old one's
/// when it is back: seed 14159 of the long form.
#[test]
fn a_stream_whose_start_was_not_heard_is_not_taken_for_the_old_one() {
    let outcome = sound(Class::Company, 14_159);
    // Of the old stream the end is not confirmed, the new one is whole.
    assert!(outcome.right > 500, "{outcome:?}");
}

#[test]
fn nothing_wrong_comes_over_a_dirty_link_or_out_of_place() {
    for class in [Class::Dirty, Class::OutOfPlace] {
        let outcomes: Vec<Outcome> = (0..FEW).map(|seed| sound(class, seed)).collect();
        let right: u64 = outcomes.iter().map(|outcome| outcome.right).sum();
        let missing: u64 = outcomes.iter().map(|outcome| outcome.missing).sum();
        assert!(right > 2000 * FEW, "{class}: {right} right samples");
        // The link is what it is said to be.
        assert!(missing > 100 * FEW, "{class}: {missing} samples missing");
    }
}

/// A part that says for ever that it is another is left out; whatever else happens ends.
#[test]
fn every_kind_alone_is_recovered_from() {
    for kind in Kind::ALL.into_iter().filter(|&kind| kind != Kind::WrongId) {
        for seed in 0..FEW / 4 {
            let outcome = sound(Class::Single(kind), seed);
            assert!(outcome.recovered, "{kind:?}, seed {seed}");
        }
    }
}
