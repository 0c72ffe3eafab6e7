//! How well `inm diagnose` finds what is hidden: thousands of records, tables of figures.
//!
//! ```text
//! cargo xtask study diagnose --seeds 200
//! cargo xtask study diagnose --part single --kind markov --seeds 20
//! cargo xtask study diagnose --kind markov --first-seed 7 --seeds 1 --keep folder
//! ```

use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use inm_tests::hidden::case::{Case, Plan};
use inm_tests::hidden::effect::{self, Kind};
use inm_tests::hidden::judge::allan_table;
use inm_tests::hidden::judge::closure;
use inm_tests::hidden::judge::program::Program;
use inm_tests::hidden::judge::tally;
use inm_tests::hidden::judge::trial::{self, Task, Trial, run_all};
use inm_tests::hidden::scene::SAMPLES;
use inm_tests::hidden::strength::Strength;
use inm_tests::hidden::{outside, pairs, wide};

/// Strengths of the detection table.
const STRENGTHS: [f64; 8] = [0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 4.0, 10.0];

/// Samples of the longest record of the wide draw.
const LONGEST: usize = 1 << 21;

/// Hides effects in records and lets `inm diagnose` find them.
#[derive(Debug, Parser)]
struct Arguments {
    /// The program to judge.
    #[arg(long)]
    inm: PathBuf,
    /// Records a row of the tables.
    #[arg(long, default_value_t = 20)]
    seeds: u64,
    /// First seed.
    #[arg(long, default_value_t = 1)]
    first_seed: u64,
    /// Part of the study; all of them if not given.
    #[arg(long)]
    part: Vec<Part>,
    /// Only this kind of effect, of the catalogue or outside; may be repeated.
    #[arg(long)]
    kind: Vec<String>,
    /// Just this multiple of the ideal detector's strength.
    #[arg(long)]
    strength: Option<f64>,
    /// Samples a record; with --wide those of the longest [default: 1048576, with --wide 2097152]
    #[arg(long)]
    samples: Option<usize>,
    /// Strengths to 1000 in records of any length, rate, noise and form; clean records and singles.
    #[arg(long, conflicts_with = "strength")]
    wide: bool,
    /// Records at once.
    #[arg(long, default_value_t = 2)]
    at_once: usize,
    /// Writes the records and what is hidden in them here and stops: nothing is run.
    #[arg(long)]
    keep: Option<PathBuf>,
}

impl Arguments {
    fn samples(&self) -> usize {
        self.samples
            .unwrap_or(if self.wide { LONGEST } else { SAMPLES })
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Nothing hidden.
    Clean,
    /// One effect, at 1 to 10 times the strength that an ideal detector needs.
    Single,
    /// Two at once, each at 2 to 10 times.
    Pairs,
    /// What no catalogue holds, at 2 to 10 times.
    Outside,
    /// One effect at strengths from 0.3 to 10.
    Strength,
    /// One effect at 2 to 10 times: data of the model found, diagnosed in turn.
    Closure,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    let known = |name: &String| effect::find(name).or(outside::find(name)).is_some();
    if let Some(name) = arguments.kind.iter().find(|name| !known(name)) {
        let all = effect::KINDS.iter().chain(outside::KINDS);
        let names: Vec<&str> = all.map(|kind| kind.name).collect();
        return Err(format!("--kind {name}: no such kind; one of {}", names.join(", ")).into());
    }
    if arguments.samples() < 1 << 16 {
        return Err("--samples: at least 65536, so that every effect has room".into());
    }
    for part in Part::value_variants() {
        let chosen = match (arguments.part.as_slice(), arguments.kind.as_slice()) {
            ([], _) if arguments.wide => match arguments.kind.is_empty() {
                true => matches!(part, Part::Clean | Part::Single),
                false => *part == Part::Single,
            },
            ([], []) => true,
            ([], _) => matches!(part, Part::Single | Part::Outside),
            (parts, _) => parts.contains(part),
        };
        if chosen {
            run(*part, &arguments)?;
        }
    }
    Ok(())
}

fn run(part: Part, arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let tasks = tasks(part, arguments);
    if tasks.is_empty() {
        return Ok(());
    }
    if let Some(folder) = &arguments.keep {
        return keep(&tasks, folder);
    }
    // A line a case, so that a study that is stopped early has still said what it found.
    let progress = |trial: &Trial| eprintln!("{}", verdict(trial));
    let program = Program(arguments.inm.clone());
    if part == Part::Closure {
        print_closure(&tasks, &program, arguments.at_once);
        return Ok(());
    }
    let trials = run_all(&tasks, &program, arguments.at_once, &progress);
    let (first, last) = (
        arguments.first_seed,
        arguments.first_seed + arguments.seeds - 1,
    );
    println!(
        "== {part:?}, seeds {first} to {last}, {} samples\n",
        arguments.samples()
    );
    if arguments.wide {
        println!("{}", wide::tally::tables(&trials));
    }
    if part == Part::Strength {
        println!("{}", tally::detection(&trials));
        return Ok(());
    }
    println!("{}", tally::confusion(&trials));
    println!("{}", tally::coverage(&trials));
    if matches!(part, Part::Single | Part::Pairs) && !arguments.wide {
        println!("{}", allan_table::table(&trials));
    }
    Ok(())
}

/// Runs all tasks to their model and back.
fn print_closure(tasks: &[Task], program: &Program, at_once: usize) {
    let closed = trial::each(tasks, at_once, &|task| {
        let closed = closure::close(task, program);
        let case = format!("{} seed {}", task.plan.name(), task.seed);
        match &closed {
            Ok(closed) if closed.is_same() => eprintln!("{case}: the same"),
            Ok(closed) => eprintln!("{case}: OTHERWISE, {closed:?}"),
            Err(failure) => eprintln!("{case}: FAILED, {failure}"),
        }
        closed
    });
    println!("{}", closure::table(tasks, &closed));
}

fn verdict(trial: &Trial) -> String {
    let strength = trial.strength.unwrap_or(0.0);
    let case = format!("{} seed {} strength {strength:.2}", trial.row, trial.seed);
    let (score, time) = match &trial.result {
        Ok(result) => result,
        Err(failure) => return format!("{case}: FAILED, {failure}"),
    };
    let verdict = match (score.is_right(), score.placed) {
        (_, Some(true)) if score.extra.is_empty() => "placed".to_owned(),
        (true, None) if score.held => "right".to_owned(),
        (true, None) => "named, but NOT HELD".to_owned(),
        _ => {
            let missed = score.named.iter().filter(|(_, named)| !named);
            let missed: Vec<&str> = missed.map(|(name, _)| *name).collect();
            format!(
                "WRONG, not named [{}], named instead [{}], {} unexplained",
                missed.join(" "),
                score.extra.join(" "),
                score.unexplained
            )
        }
    };
    let facts: Vec<&str> = trial.facts.iter().map(|(_, at)| at.trim()).collect();
    let like = facts.join(" ");
    let worse = if score.is_worse {
        ", WORSE than five terms"
    } else {
        ""
    };
    format!(
        "{case}: {verdict}{worse}, {:.2} s, {like}",
        time.as_secs_f64()
    )
}

fn tasks(part: Part, arguments: &Arguments) -> Vec<Task> {
    let wanted = |kinds: &[&'static Kind]| {
        arguments.kind.is_empty()
            || kinds
                .iter()
                .any(|kind| arguments.kind.iter().any(|name| name == kind.name))
    };
    let singles = |kinds: &'static [Kind]| kinds.iter().map(|kind| vec![kind]).collect();
    let (rows, range): (Vec<Vec<&'static Kind>>, _) = match part {
        Part::Clean => (vec![Vec::new()], (1.0, 1.0)),
        Part::Single | Part::Strength => (singles(effect::KINDS), (1.0, 10.0)),
        Part::Pairs => (pairs::all(), (2.0, 10.0)),
        Part::Outside => (singles(outside::KINDS), (2.0, 10.0)),
        Part::Closure => (singles(effect::KINDS), (2.0, 10.0)),
    };
    let strengths: Vec<Strength> = match (arguments.strength, part) {
        (_, Part::Clean | Part::Single) if arguments.wide => vec![Strength::Any],
        (Some(strength), _) => vec![Strength::At(strength)],
        (None, Part::Strength) => STRENGTHS.map(Strength::At).to_vec(),
        (None, _) => vec![Strength::Between(range.0, range.1)],
    };
    let mut tasks = Vec::new();
    for kinds in rows {
        if !kinds.is_empty() && !wanted(&kinds) {
            continue;
        }
        for strength in &strengths {
            for seed in arguments.first_seed..arguments.first_seed + arguments.seeds {
                let plan = Plan {
                    kinds: kinds.clone(),
                    strength: *strength,
                    samples: arguments.samples(),
                };
                tasks.push(Task { plan, seed });
            }
        }
    }
    tasks
}

fn keep(tasks: &[Task], folder: &std::path::Path) -> Result<(), Box<dyn std::error::Error>> {
    for task in tasks {
        let start = std::time::Instant::now();
        let case = Case::draw(&task.plan, task.seed);
        let time_s = start.elapsed().as_secs_f64();
        let strength = case.strength.unwrap_or(0.0);
        let here = folder.join(format!("{}-{}-{strength:.2}", task.plan.name(), task.seed));
        std::fs::create_dir_all(&here)?;
        let files = case.write(&here)?;
        println!(
            "{} {}\n  drawn in {time_s:.2} s, strength {strength:.2}, {:?}",
            files.record.display(),
            files.arguments.join(" "),
            case.ideal
        );
        for truth in &case.truths {
            let said: Vec<String> = truth
                .parameters
                .iter()
                .map(|(name, value)| format!("{name} {value:.6e}"))
                .collect();
            println!("  {} {}", truth.effect, said.join(", "));
        }
        println!(
            "  axis {} {:?}",
            case.scene.target, case.scene.axes[case.scene.target]
        );
    }
    Ok(())
}
