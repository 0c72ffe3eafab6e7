//! Whether `inm diagnose` says what happened on an ordinary desk.
//!
//! ```text
//! cargo xtask study everyday --seeds 200
//! cargo xtask study everyday --kind knock --first-seed 7 --seeds 1 --keep FOLDER
//! ```

use std::path::PathBuf;

use clap::Parser;
use inm_tests::hidden::everyday::record::Record;
use inm_tests::hidden::everyday::score::{Score, score};
use inm_tests::hidden::everyday::table::{EVERYDAY, Everyday, find};
use inm_tests::hidden::everyday::tally::table;
use inm_tests::hidden::judge::program::{Diagnose as _, Failure, Program};
use inm_tests::hidden::judge::trial::each;

/// Lets everyday disturbances happen and asks `inm diagnose` what it was.
#[derive(Debug, Parser)]
struct Arguments {
    /// The program to judge.
    #[arg(long)]
    inm: PathBuf,
    /// Records a disturbance.
    #[arg(long, default_value_t = 20)]
    seeds: u64,
    /// First seed.
    #[arg(long, default_value_t = 1)]
    first_seed: u64,
    /// Only this disturbance; may be repeated.
    #[arg(long)]
    kind: Vec<String>,
    /// Samples of the longest record.
    #[arg(long, default_value_t = 1 << 19)]
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
    if let Some(name) = arguments.kind.iter().find(|name| find(name).is_none()) {
        let names: Vec<&str> = EVERYDAY.iter().map(|one| one.name).collect();
        return Err(format!(
            "--kind {name}: no such disturbance; one of {}",
            names.join(", ")
        )
        .into());
    }
    let is_wanted = |one: &&Everyday| {
        arguments.kind.is_empty() || arguments.kind.iter().any(|name| name == one.name)
    };
    let last_seed = arguments.first_seed + arguments.seeds - 1;
    let tasks: Vec<(&Everyday, u64)> = EVERYDAY
        .iter()
        .filter(is_wanted)
        .flat_map(|one| (arguments.first_seed..=last_seed).map(move |seed| (one, seed)))
        .collect();
    if let Some(folder) = &arguments.keep {
        for (everyday, seed) in tasks {
            let record = Record::draw(everyday, seed, arguments.longest);
            let here = folder.join(format!("{}-{seed}", everyday.name));
            std::fs::create_dir_all(&here)?;
            let files = record.write(&here)?;
            println!("{} {}", files.record.display(), files.arguments.join(" "));
            println!("  {:?}, axis {}", record.event_s, record.plainest);
        }
        return Ok(());
    }
    let program = Program(arguments.inm.clone());
    let trials = each(&tasks, arguments.at_once, &|(everyday, seed)| {
        let came = judge(everyday, *seed, arguments.longest, &program);
        // A line a record, so that a study that is stopped early has still said what it found.
        match &came {
            Ok(score) if score.is_right() => eprintln!("{} seed {seed}: right", everyday.name),
            Ok(score) => eprintln!("{} seed {seed}: WRONG, {score:?}", everyday.name),
            Err(failure) => eprintln!("{} seed {seed}: FAILED, {failure}", everyday.name),
        }
        (everyday.name, *seed, came)
    });
    println!(
        "== everyday, seeds {} to {last_seed}\n",
        arguments.first_seed
    );
    println!("{}", table(&trials));
    Ok(())
}

fn judge(
    everyday: &'static Everyday,
    seed: u64,
    longest: usize,
    program: &Program,
) -> Result<Score, Failure> {
    let record = Record::draw(everyday, seed, longest);
    let folder = tempfile::tempdir()?;
    let files = record.write(folder.path())?;
    Ok(score(&record, &program.diagnose(&files)?.answer))
}
