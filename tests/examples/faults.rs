//! Random misfortunes in company: `cargo xtask faults [FIRST] [RUNS]`.
//!
//! Prints a table, and of each run with a wrong sample its seed and plan. Exit status 1 if there was
//! one.

use std::process::ExitCode;

use inm_tests::campaign::{Class, Kind, Outcome, Plan, run};

/// One run on a dirty link, and one with frames out of place, in so many in company.
const LINK_SHARE: u64 = 10;

/// One run of each kind alone in so many in company.
const SINGLE_SHARE: u64 = 20;

/// A row of the table.
#[derive(Default)]
struct Row {
    runs: u64,
    noticed: u64,
    recovered: u64,
    right: u64,
    lost: u64,
    wrong: u64,
    wrong_runs: u64,
}

impl Row {
    fn add(&mut self, outcome: &Outcome) {
        self.runs += 1;
        self.noticed += u64::from(outcome.resets + outcome.marked + outcome.missing > 0);
        self.recovered += u64::from(outcome.recovered);
        self.right += outcome.right;
        self.lost += outcome.marked + 3 * outcome.missing;
        self.wrong += outcome.wrong.len() as u64;
        self.wrong_runs += u64::from(!outcome.wrong.is_empty());
    }
}

fn row(class: Class, first: u64, runs: u64) -> Row {
    let mut row = Row::default();
    for seed in first..first + runs {
        let plan = Plan::of(class, seed);
        let outcome = run(&plan);
        row.add(&outcome);
        if let (Some(begin), Some(end)) = (outcome.wrong.first(), outcome.wrong.last()) {
            let wrong = outcome.wrong.len();
            println!("{class:?}, seed {seed}: {wrong} wrong samples taken for good");
            println!("  from {begin:x?}\n  to {end:x?}\n  {plan:?}");
        }
    }
    row
}

fn main() -> ExitCode {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let mut number = |default| numbers.next().unwrap_or(Ok(default));
    let (Ok(first), Ok(runs)) = (number(0), number(1000)) else {
        eprintln!("usage: cargo xtask faults [FIRST SEED] [RUNS]");
        return ExitCode::from(2);
    };
    let singles = Kind::ALL.map(|kind| (Class::Single(kind), runs.div_ceil(SINGLE_SHARE)));
    let company = [
        (Class::Company, runs),
        (Class::Dirty, runs.div_ceil(LINK_SHARE)),
        (Class::OutOfPlace, runs.div_ceil(LINK_SHARE)),
    ];
    println!("| fault | seeds | runs | noticed | recovered | right | lost or marked | wrong |");
    println!("|---|---|---|---|---|---|---|---|");
    let mut wrong_runs = 0;
    for (class, runs) in singles.into_iter().chain(company) {
        let row = row(class, first, runs);
        println!(
            "| {class} | {first} to {} | {} | {} | {} | {} | {} | {} |",
            first + runs - 1,
            row.runs,
            row.noticed,
            row.recovered,
            row.right,
            row.lost,
            row.wrong
        );
        wrong_runs += row.wrong_runs;
    }
    println!("\n{wrong_runs} runs with a wrong sample");
    ExitCode::from(u8::from(wrong_runs > 0))
}
