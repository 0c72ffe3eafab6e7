//! What `inm diagnose` says of the frozen records: to be compared between two programs, or to be
//! frozen anew.
//!
//! ```text
//! cargo run --release -p inm-tests --example frozen -- --inm PATH --out FOLDER
//! cargo run --release -p inm-tests --example frozen -- --renew
//! cargo run --release -p inm-tests --example frozen -- --records-only FOLDER
//! cargo run --release -p inm-tests --example frozen -- --compare BEFORE NOW
//! ```
//!
//! The first writes `NAME.json` and `NAME.model.json` for each record, byte for byte the same for
//! programs that say the same: `diff -r` of two such folders shows where they differ. Where the
//! program fails, `NAME.error.txt` says how. The second writes what the test `frozen` compares with.
//! The third writes the records alone, and `commands.txt` with the command for each. The fourth says
//! what differs between two folders of the first by more than another machine's rounding.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{ArgGroup, Parser};
use inm_tests::hidden::frozen::answer;
use inm_tests::hidden::frozen::compare::differences;
use inm_tests::hidden::frozen::program::{Bench, absolute, arguments, ask, frozen_folder};
use inm_tests::hidden::frozen::record::Frozen;
use inm_tests::hidden::frozen::records::{is_frozen, records};
use inm_tests::hidden::judge::program::Failure;
use inm_tests::hidden::judge::trial::each;

/// Differences within the tolerance that are shown, the largest first.
const SHOWN: usize = 10;

/// Diagnoses the frozen records.
#[derive(Debug, Parser)]
#[command(group(ArgGroup::new("what").required(true)))]
struct Arguments {
    /// The program to ask.
    #[arg(long, default_value = "target/release/inm")]
    inm: PathBuf,
    /// Folder for its answers.
    #[arg(long, value_name = "FOLDER", group = "what")]
    out: Option<PathBuf>,
    /// Freezes its answers anew, in the folder of the test.
    #[arg(long, group = "what")]
    renew: bool,
    /// Writes the records into this folder and stops.
    #[arg(long, value_name = "FOLDER", group = "what")]
    records_only: Option<PathBuf>,
    /// Compares two folders of answers and stops.
    #[arg(long, value_names = ["BEFORE", "NOW"], num_args = 2, group = "what")]
    compare: Vec<PathBuf>,
    /// Only records whose name contains this.
    #[arg(long, default_value = "")]
    only: String,
    /// Records at once.
    #[arg(long, default_value_t = 2)]
    at_once: usize,
}

type Failed = Box<dyn std::error::Error>;

fn main() -> Result<(), Failed> {
    let arguments = Arguments::parse();
    let mut records = records();
    records.retain(|record| record.name().contains(&arguments.only));
    if let Some(folder) = &arguments.records_only {
        return keep(&records, folder, arguments.at_once);
    }
    if let [before, now] = arguments.compare.as_slice() {
        return compare(&records, before, now);
    }
    if let Some(out) = &arguments.out {
        fs::create_dir_all(out)?;
        return write(&records, &arguments, out);
    }
    renew(records, &arguments)
}

/// Asks of all records.
fn answers(
    records: &[Frozen],
    arguments: &Arguments,
    out: &Path,
) -> Result<Vec<Result<(), Failure>>, Failed> {
    let folder = tempfile::tempdir()?;
    let bench = Bench {
        inm: absolute(&arguments.inm)?,
        records: absolute(folder.path())?,
        answers: absolute(out)?,
    };
    let progress = |record: &Frozen, time: Duration| {
        eprintln!("{}: {:.2} s", record.name(), time.as_secs_f64());
    };
    Ok(ask(records, &bench, arguments.at_once, &progress))
}

fn write(records: &[Frozen], arguments: &Arguments, out: &Path) -> Result<(), Failed> {
    for (record, answer) in records.iter().zip(answers(records, arguments, out)?) {
        if let Err(failure) = answer {
            eprintln!("{}: FAILED, {failure}", record.name());
            let path = out.join(format!("{}.error.txt", record.name()));
            fs::write(path, format!("{failure}\n"))?;
        }
    }
    Ok(())
}

/// Writes the answers, as far as they are frozen, into the folder of the test.
fn renew(mut records: Vec<Frozen>, arguments: &Arguments) -> Result<(), Failed> {
    records.retain(|record| is_frozen(record.name()));
    let out = tempfile::tempdir()?;
    let folder = frozen_folder();
    fs::create_dir_all(&folder)?;
    let answers = answers(&records, arguments, out.path())?;
    for (record, answer) in records.iter().zip(answers) {
        answer.map_err(|failure| format!("{}: {failure}", record.name()))?;
        let file = format!("{}.json", record.name());
        let kept = answer::read(record.name(), &out.path().join(&file))?;
        fs::write(folder.join(file), format!("{kept}\n"))?;
    }
    Ok(())
}

/// Says what differs.
fn compare(records: &[Frozen], before: &Path, now: &Path) -> Result<(), Failed> {
    let mut beyond = 0;
    let mut within = Vec::new();
    for name in records.iter().map(Frozen::name) {
        let file = format!("{name}.json");
        let before = answer::read(name, &before.join(&file));
        let (before, now) = match (before, answer::read(name, &now.join(&file))) {
            (Ok(before), Ok(now)) => (before, now),
            (Err(_), Err(_)) => continue,
            (Err(error), _) | (_, Err(error)) => {
                println!("{error}");
                beyond += 1;
                continue;
            }
        };
        for difference in differences(&before, &now) {
            if difference.times > 1.0 {
                println!("{name}: {difference}");
                beyond += 1;
            } else {
                within.push((difference.times, format!("{name}: {difference}")));
            }
        }
    }
    within.sort_by(|one, other| other.0.total_cmp(&one.0));
    println!("{beyond} beyond the tolerance, {} within", within.len());
    for (_, difference) in within.iter().take(SHOWN) {
        println!("  {difference}");
    }
    match beyond {
        0 => Ok(()),
        _ => Err("the answers differ".into()),
    }
}

fn keep(records: &[Frozen], folder: &Path, at_once: usize) -> Result<(), Failed> {
    fs::create_dir_all(folder)?;
    let commands = each(records, at_once, &|record: &Frozen| {
        let files = record.write(folder)?;
        Ok(format!("inm {}\n", arguments(&files).join(" ")))
    });
    let commands = commands.into_iter().collect::<std::io::Result<String>>()?;
    fs::write(folder.join("commands.txt"), commands)?;
    Ok(())
}
