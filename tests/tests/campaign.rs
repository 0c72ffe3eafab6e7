//! No wrong sample is taken for good, whatever happens together: the short form of
//! `cargo run -p inm-tests --example campaign`.

use inm_tests::campaign::{Plan, run};

/// Seeds of the short form: some seconds.
const SEEDS: u64 = 150;

#[test]
fn every_sample_is_right_or_known_to_be_missing_or_flagged() {
    let mut right = 0;
    let mut resets = 0;
    for seed in 0..SEEDS {
        let plan = Plan::new(seed);
        let outcome = run(&plan);
        right += outcome.right;
        resets += outcome.resets;
        assert!(
            outcome.wrong.is_empty(),
            "seed {seed}: {:x?} and {} more; {plan:?}",
            outcome.wrong[0],
            outcome.wrong.len() - 1
        );
    }
    // The misfortunes are there, and cost no more than they have to.
    assert!(resets > SEEDS, "{resets} resets");
    assert!(right > 2000 * SEEDS, "{right} right samples");
}
