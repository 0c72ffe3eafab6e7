//! `cargo xtask bench`: the estimators beside what else there is, on the same samples.
//!
//! Each contender is a process of its own (`allan/examples/contender.rs`, and a Python script for
//! allantools), started one after the other in a round, and round after round: what else the
//! machine does then hits all of them alike. Times are processor time, the best of the rounds;
//! memory is the peak of the process. docs/studies/speed.md has results and what they mean. Last come the
//! samples a second that the simulator makes (`host/examples/simulator_speed.rs`, docs/explanation/noise-model.md).

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::run::{cargo, output, root, run as execute};

/// 1.5 h at 2000 samples a second.
const SAMPLES: u64 = 10_800_000;

/// Rounds over all contenders.
const ROUNDS: usize = 3;

/// Lengths over which cost and memory are followed.
const LENGTHS: [u64; 5] = [100_000, 1_000_000, 10_000_000, 100_000_000, 1_000_000_000];

/// The overlapping Allan deviation of allantools at the averaging times of the bins.
const PYTHON: &str = r"
import sys, time, resource
import numpy, allantools
data = numpy.load(sys.argv[1])
m = [1, 2, 3]
while m[-1] < len(data) // 2:
    k = (len(m) - 3) // 4
    m += [4 << k, 5 << k, 6 << k, 7 << k]
m = [one for one in m if one <= len(data) // 2 - 1]
begin = time.process_time()
taus, deviations, _, _ = allantools.oadev(data, rate=1.0, data_type='freq', taus=m)
spent = time.process_time() - begin
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(spent * 1e9 / len(data), peak, deviations[list(taus).index(80.0)])
";

/// One line of the comparison.
struct Contender {
    /// What it is, in words.
    title: &'static str,
    /// Its name for the example.
    name: &'static str,
    build: Build,
}

#[derive(Clone, Copy, PartialEq)]
enum Build {
    /// AVX2 where the processor has it.
    Vector,
    /// The baseline of the target only.
    Plain,
    /// allantools.
    Python,
}

const CONTENDERS: [Contender; 17] = {
    const fn one(title: &'static str, name: &'static str, build: Build) -> Contender {
        Contender { title, name, build }
    }
    use Build::{Plain, Python, Vector};
    [
        one("Allan, codes", "allan", Vector),
        one("Allan, codes", "allan", Plain),
        one("Allan, loud codes", "allan-loud", Vector),
        one("Allan, loud codes", "allan-loud", Plain),
        one("Allan, full scale alternating", "allan-extreme", Vector),
        one("Allan, full scale alternating", "allan-extreme", Plain),
        one("Allan, one code at a time", "allan-board", Plain),
        one("all three, codes", "three", Vector),
        one("all three, codes", "three", Plain),
        one("all three, loud codes", "three-loud", Vector),
        one("all three, loud codes", "three-loud", Plain),
        one("all three, full scale alternating", "three-extreme", Vector),
        one("all three, full scale alternating", "three-extreme", Plain),
        one("all three, f64", "three-floats", Vector),
        one("all three, f64", "three-floats", Plain),
        one("crate allan 0.4.1, Allan, 9 a decade", "rival", Plain),
        one("allantools oadev, same times", "", Python),
    ]
};

/// What a process said of itself.
#[derive(Clone, Copy)]
struct Figures {
    ns_per_sample: f64,
    peak_kib: f64,
    deviation: f64,
}

/// The processes' programs.
struct Programs {
    vector: PathBuf,
    plain: PathBuf,
    samples: PathBuf,
}

/// Builds, runs and prints everything.
///
/// # Errors
/// A build or a contender fails.
pub fn run() -> Result<()> {
    let programs = Programs::build()?;
    println!("\n{}", machine());
    let python = python(&programs)?;
    compare(&programs, python)?;
    growth(&programs)?;
    simulator()
}

/// The simulator alone.
///
/// # Errors
/// It cannot be built, or fails.
pub fn simulator() -> Result<()> {
    execute(&mut cargo(&[
        "run",
        "--release",
        "--package",
        "inm-host",
        "--example",
        "simulator_speed",
    ]))
}

impl Programs {
    fn build() -> Result<Self> {
        let folder = root().join("target/bench");
        std::fs::create_dir_all(&folder)?;
        let example = root().join("target/release/examples/contender");
        let build = |name: &str, features: &[&str]| -> Result<PathBuf> {
            let package = [
                "build",
                "--release",
                "--package",
                "inm-allan",
                "--example",
                "contender",
            ];
            execute(cargo(&package).args(features))?;
            let copy = folder.join(name);
            std::fs::copy(&example, &copy)
                .with_context(|| format!("cannot copy {}", example.display()))?;
            Ok(copy)
        };
        Ok(Self {
            plain: build("contender-plain", &[])?,
            vector: build("contender-vector", &["--features", "simd"])?,
            samples: folder.join("samples.npy"),
        })
    }
}

/// Writes the samples for allantools, if it is there; whether it is.
fn python(programs: &Programs) -> Result<bool> {
    let version = "import allantools, numpy; print(allantools.__version__, numpy.__version__)";
    let found = Command::new("python3").args(["-c", version]).output();
    let Some(found) = found.ok().filter(|run| run.status.success()) else {
        println!("allantools: not installed for python3, left out (pip install allantools)");
        return Ok(false);
    };
    println!(
        "allantools and numpy {}",
        String::from_utf8_lossy(&found.stdout).trim()
    );
    let count = SAMPLES.to_string();
    output(
        Command::new(&programs.vector)
            .args(["write", &count])
            .arg(&programs.samples),
    )?;
    Ok(true)
}

/// The machine and how busy it is.
fn machine() -> String {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let cpu = read("/proc/cpuinfo");
    let model = cpu
        .lines()
        .find_map(|line| line.strip_prefix("model name"))
        .map_or("unknown processor", |rest| {
            rest.trim_start_matches([' ', '\t', ':'])
        });
    let count = cpu
        .lines()
        .filter(|line| line.starts_with("processor"))
        .count();
    let load = read("/proc/loadavg");
    let load = load.split(' ').next().unwrap_or("unknown");
    format!("{model}, {count} processors, load average {load} before")
}

/// The table of contenders on the same samples.
fn compare(programs: &Programs, python: bool) -> Result<()> {
    let taking_part: Vec<&Contender> = CONTENDERS
        .iter()
        .filter(|one| python || one.build != Build::Python)
        .collect();
    let mut best: Vec<Option<Figures>> = vec![None; taking_part.len()];
    for _ in 0..ROUNDS {
        for (best, contender) in best.iter_mut().zip(&taking_part) {
            let result = start(programs, contender)?;
            if best.is_none_or(|best| result.ns_per_sample < best.ns_per_sample) {
                *best = Some(result);
            }
        }
    }
    println!(
        "\n{SAMPLES} samples, best of {ROUNDS} rounds, one core\n{:<38}{:<9}{:>11}{:>11}{:>10}{:>16}",
        "", "vectors", "ns/sample", "ratio", "peak MiB", "deviation at 80"
    );
    let reference = best
        .first()
        .copied()
        .flatten()
        .map_or(1.0, |one| one.ns_per_sample);
    for (result, contender) in best.iter().zip(&taking_part) {
        let Some(result) = result else { continue };
        let build = match contender.build {
            Build::Vector => "AVX2",
            Build::Plain => "baseline",
            Build::Python => "numpy",
        };
        println!(
            "{:<38}{build:<9}{:>11.2}{:>11.2}{:>10.1}{:>16.8e}",
            contender.title,
            result.ns_per_sample,
            result.ns_per_sample / reference,
            result.peak_kib / 1024.0,
            result.deviation
        );
    }
    Ok(())
}

fn start(programs: &Programs, contender: &Contender) -> Result<Figures> {
    let native = |program: &Path| measure(program, contender.name, SAMPLES);
    match contender.build {
        Build::Vector => native(&programs.vector),
        Build::Plain => native(&programs.plain),
        Build::Python => parse(&output(
            Command::new("python3")
                .args(["-c", PYTHON])
                .arg(&programs.samples),
        )?),
    }
}

fn measure(program: &Path, name: &str, samples: u64) -> Result<Figures> {
    parse(&output(
        Command::new(program).args([name, &samples.to_string()]),
    )?)
}

/// Reads the three numbers that every contender prints.
fn parse(line: &str) -> Result<Figures> {
    let numbers: Vec<f64> = line
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    let [ns_per_sample, peak_kib, deviation] = numbers[..] else {
        bail!("a contender printed `{}`", line.trim());
    };
    Ok(Figures {
        ns_per_sample,
        peak_kib,
        deviation,
    })
}

/// Cost and memory over four decades of length.
fn growth(programs: &Programs) -> Result<()> {
    println!(
        "\ngrowth, codes, AVX2\n{:>14}{:>16}{:>10}{:>20}{:>10}",
        "samples", "Allan ns/sample", "peak MiB", "all three ns/sample", "peak MiB"
    );
    for samples in LENGTHS {
        let allan = measure(&programs.vector, "allan", samples)?;
        let three = measure(&programs.vector, "three", samples)?;
        println!(
            "{samples:>14}{:>16.2}{:>10.1}{:>20.2}{:>10.1}",
            allan.ns_per_sample,
            allan.peak_kib / 1024.0,
            three.ns_per_sample,
            three.peak_kib / 1024.0
        );
    }
    Ok(())
}
