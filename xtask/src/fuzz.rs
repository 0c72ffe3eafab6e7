//! `cargo xtask fuzz`: bytes that a reader does not bear are looked for, guided by what they reach.
//!
//! What a reader promises stands in `tests/src/promise`, its seeds in `fuzz/corpus`; what is found on
//! the way grows in `fuzz/found`, and bytes that break a promise are left in `fuzz/artifacts`. Nothing of
//! what is fuzzed has `unsafe` code, so it runs without a sanitizer, which is several times as fast;
//! numbers that run over and broken assertions count.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::thread;

use anyhow::{Context, Result, bail};

use crate::run::{output, root, run as execute};

/// The targets, one a reader.
const TARGETS: [&str; 8] = [
    "capture", "elf", "frames", "header", "model", "npy", "state", "text",
];

/// How long each is tried where nothing is said: long enough for a million executions of most.
const SECONDS: u64 = 60;

/// Executions of each in a run of all tests: what the slowest, a log with stamps, does in half a minute.
const EXECUTIONS: u64 = 20_000;

/// Most memory, MB. Inputs have some kilobytes and the readers' buffers some hundred; the fuzzer itself
/// takes most of what is left.
const MOST_MB: u32 = 512;

/// Longest time for one input, seconds: a thousand times what the slowest seed takes.
const LONGEST_S: u32 = 5;

/// The least that shows what broke.
const LAST_LINES: usize = 30;

/// How much a target is tried.
#[derive(Debug, Clone, Copy)]
enum Effort {
    /// For so long, from another seed each time, on top of what was found before.
    Seconds(u64),
    /// From the same seed and nothing found before: about the same inputs each time (maps are in another order), so that
    /// a run that fails most likely does so by what was changed.
    Again,
}

impl Effort {
    fn options(self) -> Vec<String> {
        match self {
            Self::Seconds(seconds) => vec![format!("-max_total_time={seconds}")],
            Self::Again => vec![format!("-runs={EXECUTIONS}"), "-seed=1".to_owned()],
        }
    }

    /// Where it leaves what it found on the way.
    fn found(self, target: &str) -> Result<PathBuf> {
        let all = root().join("fuzz").join("found");
        let own = match self {
            Self::Seconds(_) => all.join(target),
            Self::Again => all.join("again").join(target),
        };
        if matches!(self, Self::Again) && own.exists() {
            fs::remove_dir_all(&own)?;
        }
        fs::create_dir_all(&own)?;
        Ok(own)
    }
}

/// Tries the targets that `options` name: `[TARGET] [--seconds N]`.
///
/// # Errors
/// A tool is missing (says which), the options are wrong, or a promise is broken.
pub fn run(options: &[&str]) -> Result<()> {
    let (targets, seconds) = asked_for(options)?;
    if let Some(missing) = missing() {
        bail!("{missing}");
    }
    build()?;
    try_all(&targets, Effort::Seconds(seconds))
}

/// All targets from the same seed each time, where the tools are there; says what is missing where not.
///
/// # Errors
/// A promise is broken.
pub fn check() -> Result<()> {
    match missing() {
        Some(missing) => {
            eprintln!("\nleft out: {missing}");
            Ok(())
        }
        None => {
            build()?;
            try_all(&TARGETS, Effort::Again)
        }
    }
}

fn asked_for<'o>(options: &[&'o str]) -> Result<(Vec<&'o str>, u64)> {
    let number = |text: &str| {
        let number = text.parse();
        number.with_context(|| format!("`{text}` is no number of seconds"))
    };
    let (target, seconds) = match options {
        [] => (None, SECONDS),
        ["--seconds", seconds] => (None, number(seconds)?),
        [target] => (Some(*target), SECONDS),
        [target, "--seconds", seconds] => (Some(*target), number(seconds)?),
        _ => bail!("expected [TARGET] [--seconds N]"),
    };
    match target {
        None => Ok((TARGETS.to_vec(), seconds)),
        Some(one) if TARGETS.contains(&one) => Ok((vec![one], seconds)),
        Some(one) => bail!("no target `{one}`; known are {}", TARGETS.join(", ")),
    }
}

/// What is not installed, and how to get it.
fn missing() -> Option<String> {
    let starts =
        |program: &str, arguments: &[&str]| output(Command::new(program).args(arguments)).is_ok();
    let remedy = if !starts("rustup", &["run", "nightly", "rustc", "--version"]) {
        "a nightly toolchain: rustup toolchain install nightly --profile minimal"
    } else if !starts("rustup", &["run", "nightly", "cargo", "fuzz", "--version"]) {
        "cargo-fuzz: cargo install cargo-fuzz"
    } else if !starts("c++", &["--version"]) {
        "a C++ compiler, c++, for libfuzzer"
    } else {
        return None;
    };
    Some(format!("fuzzing needs {remedy}"))
}

/// cargo-fuzz with the options that building and running share.
fn cargo_fuzz(what: &str) -> Command {
    let mut command = Command::new("rustup");
    command.args(["run", "nightly", "cargo", "fuzz", what]);
    command.args(["--release", "--debug-assertions", "--sanitizer", "none"]);
    // In one unit the host alone takes minutes on one processor; in sixteen the targets run as fast.
    command.args(["--codegen-units", "16"]);
    // The toolchain that runs this program is another.
    command.env_remove("RUSTC").env_remove("RUSTDOC");
    command
}

fn build() -> Result<()> {
    execute(&mut cargo_fuzz("build"))
}

/// As many at a time as there are processors.
fn try_all(targets: &[&str], effort: Effort) -> Result<()> {
    let waiting = Mutex::new(targets.iter());
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let next = || waiting.lock().ok()?.next();
    let work = || -> Result<()> {
        while let Some(target) = next() {
            try_one(target, effort)?;
        }
        Ok(())
    };
    thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        let ended = workers.into_iter().map(|worker| worker.join());
        // Each is heard to its end before any is believed.
        let ended: Vec<_> = ended.collect();
        ended
            .into_iter()
            .try_for_each(|one| one.unwrap_or_else(|_| bail!("a worker panicked")))
    })
}

fn try_one(target: &str, effort: Effort) -> Result<()> {
    let fuzz = root().join("fuzz");
    let found = effort.found(target)?;
    let log = fuzz.join("found").join(format!("{target}.log"));
    let status = cargo_fuzz("run")
        .arg(target)
        .args([&found, &fuzz.join("corpus").join(target)])
        .arg("--")
        .args(effort.options())
        .arg(format!("-rss_limit_mb={MOST_MB}"))
        .arg(format!("-timeout={LONGEST_S}"))
        .arg("-print_final_stats=1")
        .env("TMPDIR", scratch())
        .current_dir(root())
        .stdout(Stdio::null())
        .stderr(File::create(&log)?)
        .status()
        .context("cannot run `rustup run nightly cargo fuzz`")?;
    let said = String::from_utf8_lossy(&fs::read(&log)?).into_owned();
    if status.success() {
        let executions = figure(&said, "stat::number_of_executed_units:");
        let kept = fs::read_dir(&found)?.count();
        eprintln!("{target:<8}{executions:>12} executions, {kept} inputs found");
        return Ok(());
    }
    let lines: Vec<&str> = said.lines().collect();
    let last = lines[lines.len().saturating_sub(LAST_LINES)..].join("\n");
    bail!(
        "{target} breaks its promise; all of it: {}\n{last}",
        shown(&log)
    )
}

/// Where readers put their files: in memory where there is such a folder, as a disk takes most of the
/// time of a log with stamps.
fn scratch() -> PathBuf {
    let memory = PathBuf::from("/dev/shm");
    if memory.is_dir() {
        memory
    } else {
        std::env::temp_dir()
    }
}

/// The figure behind `name`, as the fuzzer wrote it.
fn figure<'s>(said: &'s str, name: &str) -> &'s str {
    let line = said.lines().find_map(|line| line.strip_prefix(name));
    line.map_or("?", str::trim)
}

fn shown(path: &Path) -> String {
    let below = path.strip_prefix(root()).map(PathBuf::from);
    below
        .unwrap_or_else(|_| path.to_owned())
        .display()
        .to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_is_built_and_has_seeds() {
        let fuzz = root().join("fuzz");
        let manifest = fs::read_to_string(fuzz.join("Cargo.toml")).expect("a manifest");
        let named: Vec<&str> = manifest
            .lines()
            .filter_map(|line| {
                line.strip_prefix("path = \"fuzz_targets/")?
                    .strip_suffix(".rs\"")
            })
            .collect();
        assert_eq!(named, TARGETS);
        for target in TARGETS {
            let seeds = fs::read_dir(fuzz.join("corpus").join(target)).expect("a folder");
            assert!(seeds.count() > 0, "{target} has no seed");
        }
    }

    #[test]
    fn options_say_which_and_how_long() {
        assert_eq!(asked_for(&[]).expect("all"), (TARGETS.to_vec(), SECONDS));
        let one = asked_for(&["npy", "--seconds", "5"]).expect("one");
        assert_eq!(one, (vec!["npy"], 5));
        for wrong in [&["nyp"][..], &["--seconds", "long"], &["npy", "5"]] {
            assert!(asked_for(wrong).is_err(), "{wrong:?}");
        }
    }
}
