//! A night at the bench: what `cargo xtask night` runs, and prints.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use inm_tests::night::{Night, Weather, night};

/// Records a virtual board at 4000/s with `inm live` while everything happens to it, and compares every
/// sample with the converters' own words.
#[derive(Debug, Parser)]
struct Options {
    /// The program.
    #[arg(long)]
    inm: PathBuf,
    /// Hours of samples.
    #[arg(long, default_value_t = 12.0)]
    hours: f64,
    /// What happens follows from it; when, from the speed of the machine as well.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Seconds of board time in a second, at most.
    #[arg(long, default_value_t = 60.0)]
    speed: f64,
    /// Mean board time between two cables out, seconds.
    #[arg(long, default_value_t = 900.0)]
    cable: f64,
    /// Mean board time between two losses of power, seconds.
    #[arg(long, default_value_t = 900.0)]
    power: f64,
    /// Bits slip on the bus, too.
    #[arg(long)]
    slips: bool,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let weather = Weather {
        speed: options.speed,
        cable_s: options.cable,
        power_s: options.power,
        slips: options.slips,
    };
    let begin = Instant::now();
    let night = match night(&options.inm, options.hours, options.seed, weather) {
        Ok(night) => night,
        Err(error) => {
            eprintln!("seed {}: {error}", options.seed);
            return ExitCode::FAILURE;
        }
    };
    print(&night);
    println!(
        "took {:.0} s; seed {}",
        begin.elapsed().as_secs_f64(),
        options.seed
    );
    if night.axes.iter().all(|axis| axis.wrong == 0) && night.memory.is_flat() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn print(night: &Night) {
    println!("{:?}", night.happened);
    println!("exit status of inm live: {:?}", night.status);
    if night.status != Some(1) {
        println!("{}", night.shown);
    }
    println!("axis        right     flagged     missing  wrong  unknown gaps  exact  fewer");
    for (name, axis) in ["X", "Y", "Z"].iter().zip(&night.axes) {
        println!(
            "{name:<4}{:>13}{:>12}{:>12}{:>7}{:>14}{:>7}{:>7}",
            axis.right,
            axis.flagged,
            axis.missing,
            axis.wrong,
            axis.unknown_gaps,
            axis.exact,
            axis.fewer
        );
    }
    println!(
        "resident memory, most in each twelfth, MB: {:.1?}",
        night.memory.most_mb(12)
    );
}
