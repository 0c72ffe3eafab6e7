//! What `inm diagnose` says of the frozen records: to be compared between two programs, or to be
//! frozen anew.
//!
//! ```text
//! cargo run --release -p inm-tests --example frozen -- --inm PATH --out FOLDER
//! cargo run --release -p inm-tests --example frozen -- --inm PATH --renew
//! cargo run --release -p inm-tests --example frozen -- --records-only FOLDER
//! ```
//!
//! The first writes `NAME.json` and `NAME.model.json` for each record, byte for byte the same for
//! programs that say the same: `diff -r` of two such folders shows where they differ. Where the
//! program fails, `NAME.error.txt` says how. The second writes what the test `frozen` compares with.
//! The third writes the records alone, and `commands.txt` with the command for each.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;
use inm_tests::hidden::frozen::program::{Bench, absolute, arguments};
use inm_tests::hidden::frozen::record::Frozen;
use inm_tests::hidden::frozen::records::records;
use inm_tests::hidden::judge::program::Failure;
use inm_tests::hidden::judge::trial::each;

/// Diagnoses the frozen records.
#[derive(Debug, Parser)]
struct Arguments {
    /// The program to ask.
    #[arg(long, required_unless_present = "records_only")]
    inm: Option<PathBuf>,
    /// Folder for its answers.
    #[arg(long, required_unless_present = "records_only")]
    out: Option<PathBuf>,
    /// Writes the records into this folder and stops.
    #[arg(long, value_name = "FOLDER", conflicts_with = "inm")]
    records_only: Option<PathBuf>,
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
    if let (Some(inm), Some(out)) = (&arguments.inm, &arguments.out) {
        fs::create_dir_all(out)?;
        let folder = tempfile::tempdir()?;
        let bench = Bench {
            inm: absolute(inm)?,
            records: absolute(folder.path())?,
            answers: absolute(out)?,
        };
        ask(&records, &bench, arguments.at_once)?;
    }
    Ok(())
}

/// Asks of all records; a record is gone when its answer is there.
fn ask(records: &[Frozen], bench: &Bench, at_once: usize) -> Result<(), Failed> {
    let asked = each(
        records,
        at_once,
        &|record: &Frozen| -> Result<(), Failure> {
            let files = record.write(&bench.records)?;
            let start = Instant::now();
            let answered = bench.diagnose(record.name(), &files);
            let time_s = start.elapsed().as_secs_f64();
            fs::remove_file(bench.records.join(&files.record))?;
            match answered {
                Ok(()) => eprintln!("{}: {time_s:.2} s", record.name()),
                Err(failure) => {
                    eprintln!("{}: FAILED, {failure}", record.name());
                    let path = bench.answers.join(format!("{}.error.txt", record.name()));
                    fs::write(path, format!("{failure}\n"))?;
                }
            }
            Ok(())
        },
    );
    asked.into_iter().collect::<Result<(), Failure>>()?;
    Ok(())
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
