//! Whether `inm diagnose` keeps its head on records of any kind.
//!
//! ```text
//! cargo xtask study robust --records 5000
//! cargo xtask study robust --first-seed 17 --records 1 --keep FOLDER
//! ```
//!
//! A record passes if the program ends within 60 s of processor time with status 0, 1 or 2 and no panic, its JSON can
//! be read, no parameter leaves what the record can hold, and `inm simulate` reads its model. A seed
//! and `--longest` settle a record.

use std::path::PathBuf;

use clap::Parser;
use inm_tests::hidden::judge::trial::each;
use inm_tests::hidden::robust::check::check;
use inm_tests::hidden::robust::record::{LONGEST, Record};
use inm_tests::hidden::robust::tally::table;

/// Gives random records to `inm diagnose`.
#[derive(Debug, Parser)]
struct Arguments {
    /// The program to judge.
    #[arg(long)]
    inm: PathBuf,
    /// How many records.
    #[arg(long, default_value_t = 200)]
    records: u64,
    /// First seed.
    #[arg(long, default_value_t = 1)]
    first_seed: u64,
    /// Samples of an axis at most.
    #[arg(long, default_value_t = LONGEST)]
    longest: usize,
    /// Records at once.
    #[arg(long, default_value_t = 2)]
    at_once: usize,
    /// Writes the records here and stops: nothing is run.
    #[arg(long)]
    keep: Option<PathBuf>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    let seeds: Vec<u64> = (arguments.first_seed..)
        .take(arguments.records as usize)
        .collect();
    if let Some(folder) = &arguments.keep {
        for seed in seeds {
            let record = Record::draw(seed, arguments.longest);
            let here = folder.join(seed.to_string());
            std::fs::create_dir_all(&here)?;
            let files = record.write(&here)?;
            println!("{} {}", files.record.display(), files.arguments.join(" "));
            println!("  {}", record.describe());
        }
        return Ok(());
    }
    let outcomes = each(&seeds, arguments.at_once, &|seed| {
        let record = Record::draw(*seed, arguments.longest);
        let outcome = check(&arguments.inm, &record);
        // A line a failure, so that a study that is stopped early has still said what it found.
        if let Ok(outcome) = &outcome {
            for failure in &outcome.failures {
                eprintln!("seed {seed}, {}: {failure}", record.describe());
            }
        }
        outcome.map(|outcome| (*seed, outcome))
    });
    let outcomes: Vec<_> = outcomes.into_iter().collect::<Result<_, _>>()?;
    let (first, last) = (seeds.first(), seeds.last());
    println!(
        "== robust, seeds {first:?} to {last:?}, at most {} samples\n",
        arguments.longest
    );
    println!("{}", table(&outcomes));
    match outcomes
        .iter()
        .all(|(_, outcome)| outcome.failures.is_empty())
    {
        true => Ok(()),
        false => Err("some records fail".into()),
    }
}
