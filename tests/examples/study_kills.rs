//! Recordings that are killed: what `cargo xtask faults --kills N` runs, and prints.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use inm_tests::night::{Killed, kill};

/// Kills recordings of a virtual board behind a serial port, each at a random moment, and compares what
/// is left with what had been written and with the converters' own words.
#[derive(Debug, Parser)]
struct Options {
    /// The program.
    #[arg(long)]
    inm: PathBuf,
    /// How many are killed.
    #[arg(long, default_value_t = 200)]
    kills: u64,
    /// Seed of the first; each has the next one.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let mut all = Vec::new();
    let mut unsound = 0;
    for seed in options.seed..options.seed + options.kills {
        match kill(&options.inm, seed) {
            Ok(killed) => {
                if !killed.is_sound() {
                    println!("seed {seed}: {killed:?}");
                    unsound += 1;
                }
                all.push(killed);
            }
            Err(error) => {
                println!("seed {seed}: {error}");
                unsound += 1;
            }
        }
    }
    print(&all);
    println!(
        "{unsound} of {} recordings are not as they should be",
        options.kills
    );
    ExitCode::from(u8::from(unsound > 0))
}

fn print(all: &[Killed]) {
    println!(
        "| killed | before the first sample | bytes written | lost | right | flagged | missing | wrong |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for command in ["record", "live"] {
        let of: Vec<&Killed> = all.iter().filter(|one| one.command == command).collect();
        let sum = |of_one: fn(&Killed) -> u64| of.iter().map(|one| of_one(one)).sum::<u64>();
        println!(
            "| {command}: {} | {} | {} | {} | {} | {} | {} | {} |",
            of.len(),
            sum(|one| u64::from(one.axes.is_none())),
            sum(|one| one.written),
            sum(|one| one.lost),
            sum(|one| one.axes.iter().flatten().map(|axis| axis.right).sum()),
            sum(|one| one.axes.iter().flatten().map(|axis| axis.flagged).sum()),
            sum(|one| one.axes.iter().flatten().map(|axis| axis.missing).sum()),
            sum(|one| one.axes.iter().flatten().map(|axis| axis.wrong).sum()),
        );
    }
}
