//! Whether `inm diagnose` names effects that are added to stretches of real records, and nothing beside.
//!
//! ```text
//! cargo xtask study added --records LIST --seeds 100
//! cargo xtask study added --records LIST --first-seed 7 --seeds 1 --kind telegraph --keep FOLDER
//! ```

use std::path::PathBuf;

use clap::Parser;
use inm_tests::hidden::added::case::{self, Case};
use inm_tests::hidden::added::list::{self, Recording};
use inm_tests::hidden::added::score::{Score, names, score};
use inm_tests::hidden::added::stretch::Stretch;
use inm_tests::hidden::added::tally::{Trial, tables};
use inm_tests::hidden::effect::{self, Kind};
use inm_tests::hidden::judge::answer::Answer;
use inm_tests::hidden::judge::program::{Diagnose as _, Failure, Program};
use inm_tests::hidden::judge::trial::each;

/// Adds known effects to stretches of real records and asks `inm diagnose` what they are.
#[derive(Debug, Parser)]
struct Arguments {
    /// The program to judge.
    #[arg(long)]
    inm: PathBuf,
    /// The records: a JSON list of {"name", "file", "rate", "columns"}, and "scale", "from", "to" where needed.
    #[arg(long)]
    records: PathBuf,
    /// Stretches.
    #[arg(long, default_value_t = 20)]
    seeds: u64,
    /// First seed.
    #[arg(long, default_value_t = 1)]
    first_seed: u64,
    /// Effects a stretch, one at a time.
    #[arg(long, default_value_t = 4)]
    effects: usize,
    /// Only this kind; may be repeated.
    #[arg(long)]
    kind: Vec<String>,
    /// Records at once.
    #[arg(long, default_value_t = 2)]
    at_once: usize,
    /// Writes stretches and what is added to them here, and how the program is told of them.
    #[arg(long)]
    keep: Option<PathBuf>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    if let Some(name) = arguments
        .kind
        .iter()
        .find(|name| effect::find(name).is_none())
    {
        let all: Vec<&str> = effect::KINDS.iter().map(|kind| kind.name).collect();
        return Err(format!("--kind {name}: no such kind; one of {}", all.join(", ")).into());
    }
    let recordings = list::read(&arguments.records)?;
    let seeds: Vec<u64> = (arguments.first_seed..)
        .take(arguments.seeds as usize)
        .collect();
    let trials = each(&seeds, arguments.at_once, &|seed| {
        one_stretch(*seed, &recordings, &arguments)
    });
    let mut all = Vec::new();
    for trials in trials {
        all.extend(trials.map_err(|failure| failure.to_string())?);
    }
    if arguments.keep.is_none() {
        let last = arguments.first_seed + arguments.seeds - 1;
        println!("== added, seeds {} to {last}\n", arguments.first_seed);
        println!("{}", tables(&all));
    }
    Ok(())
}

/// A stretch, bare and with one effect at a time.
fn one_stretch(
    seed: u64,
    recordings: &[Recording],
    arguments: &Arguments,
) -> Result<Vec<Trial>, Failure> {
    let Some(stretch) = Stretch::draw(recordings, seed) else {
        eprintln!("seed {seed}: no stretch");
        return Ok(Vec::new());
    };
    let place = format!(
        "seed {seed}: {} axis {}, {} samples from {}",
        stretch.record,
        stretch.axis,
        stretch.samples.len(),
        stretch.from
    );
    let program = Program(arguments.inm.clone());
    let bare = match said(&stretch.samples, &stretch, &program, arguments, "bare") {
        Ok(answer) => answer,
        Err(failure) => {
            eprintln!("{place}: FAILED bare, {failure}");
            return Ok(vec![Trial {
                kind: "bare",
                record: stretch.record.clone(),
                strength: 0.0,
                result: Err(failure),
            }]);
        }
    };
    let is_wanted = |kind: &&Kind| {
        arguments.kind.is_empty() || arguments.kind.iter().any(|name| name == kind.name)
    };
    let held = names(&bare);
    let kinds = case::kinds(&stretch, &held).into_iter().filter(is_wanted);
    let cases = kinds.filter_map(|kind| Case::draw(&stretch, &held, kind));
    let trial = |case: Case| {
        let name = format!("{}-{:.1}", case.kind.name, case.strength);
        let said = said(&case.samples, &stretch, &program, arguments, &name);
        let result = said.map(|answer| score(&case, &stretch, &bare, &answer));
        // A line a case, so that a study that is stopped early has still said what it found.
        match &result {
            Ok(score) => eprintln!("{place}: {} {}", name, verdict(score, &held)),
            Err(failure) => eprintln!("{place}: {name} FAILED, {failure}"),
        }
        Trial {
            kind: case.kind.name,
            record: stretch.record.clone(),
            strength: case.strength,
            result,
        }
    };
    Ok(cases.take(arguments.effects).map(trial).collect())
}

fn verdict(score: &Score, bare: &[String]) -> String {
    match score.is_right() {
        true if score.held => "right".to_owned(),
        true => format!("right, not held; given {}", score.given.join("+")),
        false => format!(
            "{}, given {}; bare {}",
            match score.among && score.new.is_empty() {
                true => "UNDECIDED",
                false => "WRONG",
            },
            score.given.join("+"),
            bare.join("+")
        ),
    }
}

/// What the program says of samples of a stretch.
fn said(
    samples: &[f64],
    stretch: &Stretch,
    program: &Program,
    arguments: &Arguments,
    name: &str,
) -> Result<Answer, Failure> {
    let temporary = tempfile::tempdir()?;
    let folder = match &arguments.keep {
        Some(folder) => folder.join(format!("{}-{name}", stretch.seed)),
        None => temporary.path().to_owned(),
    };
    std::fs::create_dir_all(&folder)?;
    let files = case::write(samples, stretch, &folder)?;
    if arguments.keep.is_some() {
        println!("{} {}", files.record.display(), files.arguments.join(" "));
    }
    Ok(program.diagnose(&files)?.answer)
}
