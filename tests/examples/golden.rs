//! Writes a set of golden files, as they were written first; see `inm_tests::golden`.
//!
//! ```text
//! cargo run --release -p inm-tests --example golden -- --inm PATH --out FOLDER
//! ```
//!
//! The model with every effect is written by hand: it has to be in the folder already.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use clap::Parser;
use inm_emulator::Fault;
use inm_host::Model;
use inm_host::Source as _;
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::virtual_board::VirtualConnect;
use inm_protocol::{Filter, Phase, Rate, Settings};
use inm_tests::golden;
use inm_tests::hidden::frozen::program::{absolute, arguments as arguments_for};
use inm_tests::hidden::frozen::records::records;
use inm_tests::port::{Damage, DamagedConnect};
use serde_json::Value;

/// The record whose diagnosis is kept: short, with something to find.
const RECORD: &str = "sinusoid-3-first-8192";

/// Seed of the board's noise.
const SEED: u64 = 5;

/// Samples of the capture: at 250 a second the port comes back and two more seconds follow.
const SAMPLES: u64 = 2000;

/// Byte at which the port vanishes, and how many the board sends meanwhile.
const VANISHES: u64 = 12_000;
const UNHEARD: usize = 3000;

/// Writes golden files.
#[derive(Debug, Parser)]
struct Arguments {
    /// The program that is to write them.
    #[arg(long)]
    inm: PathBuf,
    /// Folder with `model.json` in it.
    #[arg(long)]
    out: PathBuf,
}

type Failed = Box<dyn std::error::Error>;

fn main() -> Result<(), Failed> {
    let arguments = Arguments::parse();
    let (inm, out) = (absolute(&arguments.inm)?, absolute(&arguments.out)?);
    board(&out.join("board.inmcap"))?;
    run(
        &inm,
        &out,
        ["analyze", "board.inmcap", "--json", "board.json"],
    )?;
    let model = Model::open(&out.join("model.json").display().to_string())?;
    write(&out.join("law.json"), &golden::law(&model))?;

    let folder = tempfile::tempdir()?;
    let here = folder.path();
    let simulate = "simulate --model published:X --rate 250 --duration 60 --seed 3 -o x.npy";
    run(&inm, here, simulate.split(' '))?;
    run(
        &inm,
        here,
        "analyze x.npy --rate 250 --unit m/s^2 --json analysis.json".split(' '),
    )?;
    let record = records().into_iter().find(|one| one.name() == RECORD);
    let record = record.ok_or("the record is no longer there")?;
    let mut diagnose = arguments_for(&record.write(here)?);
    diagnose.extend(
        "--json diagnosis.json --model diagnosis.model.json"
            .split(' ')
            .map(str::to_owned),
    );
    run(&inm, here, diagnose)?;
    for name in ["analysis.json", "diagnosis.json", "diagnosis.model.json"] {
        fs::copy(here.join(name), out.join(name))?;
    }
    for name in ["board.json", "analysis.json", "diagnosis.json"] {
        write(&out.join(name), &golden::json(&out.join(name)))?;
    }
    Ok(())
}

/// A capture of a board to which much happens.
fn board(path: &Path) -> Result<(), Failed> {
    let mut board = VirtualConnect::published(SEED, 0.0);
    let stuck = Fault::BusStuck {
        high: true,
        conversions: Some(5),
    };
    let overload = Fault::Overload {
        input: i32::MAX >> 1,
        conversions: 40,
    };
    board.faults = vec![
        (0, 300, stuck),
        (1, 400, overload),
        (2, 500, Fault::DrdyStops),
    ];
    let damage = Damage {
        flip: vec![8000],
        vanish: Some(VANISHES),
        failing_opens: 1,
        unheard: UNHEARD,
        ..Damage::default()
    };
    let damaged = DamagedConnect::new(&mut board, damage)?;
    let plan = Plan {
        settings: Some(Settings {
            rate: Rate::Sps250,
            filter: Filter::Fir {
                phase: Phase::Linear,
                high_pass: None,
            },
        }),
        samples: Some(SAMPLES),
        reconnect: Some(Duration::from_secs(20)),
        ..Plan::default()
    };
    let mut source = BoardSource::start(Box::new(damaged), plan, Some(path), Stop::default())?;
    while source.next_chunk()?.is_some() {}
    Ok(())
}

fn run<S: AsRef<OsStr>>(
    inm: &Path,
    folder: &Path,
    arguments: impl IntoIterator<Item = S>,
) -> Result<(), Failed> {
    let output = Command::new(inm)
        .current_dir(folder)
        .args(arguments)
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(())
}

/// Without spaces, for the repository's sake.
fn write(path: &Path, value: &Value) -> Result<(), Failed> {
    Ok(fs::write(path, format!("{value}\n"))?)
}
