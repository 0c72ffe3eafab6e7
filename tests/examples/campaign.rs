//! Random misfortunes in company: `cargo run -p inm-tests --example campaign -- FIRST COUNT`.

use inm_tests::campaign::{Plan, run};

fn main() {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let mut number = |default| numbers.next().and_then(Result::ok).unwrap_or(default);
    let (first, count) = (number(0), number(1000));
    let (mut right, mut given_up, mut marked, mut missing) = (0, 0, 0, 0);
    let (mut resets, mut lost_frames, mut bad) = (0, 0, 0);
    for seed in first..first + count {
        let plan = Plan::new(seed);
        let outcome = run(&plan);
        right += outcome.right;
        given_up += outcome.given_up;
        marked += outcome.marked;
        missing += 3 * outcome.missing;
        resets += outcome.resets;
        lost_frames += outcome.lost_frames;
        if let (Some(begin), Some(end)) = (outcome.wrong.first(), outcome.wrong.last()) {
            bad += 1;
            println!(
                "seed {seed}: {} wrong samples taken for good",
                outcome.wrong.len()
            );
            println!("  from {begin:x?}\n  to {end:x?}\n  {plan:?}");
        }
    }
    println!(
        "seeds {first} to {}: {bad} of {count} runs with a wrong sample",
        first + count - 1
    );
    println!(
        "samples: {right} right, {marked} marked ({given_up} of them right), {missing} missing"
    );
    println!("{resets} resets of an axis, {lost_frames} frames lost");
}
