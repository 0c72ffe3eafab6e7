//! Many cases, several at a time.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use super::program::{Diagnose, Failure};
use super::score::{Score, score};
use crate::hidden::case::{Case, Plan};
use crate::hidden::wide::tally::facts;

/// A case to be run.
#[derive(Clone)]
pub struct Task {
    /// What to hide.
    pub plan: Plan,
    /// Its seed.
    pub seed: u64,
}

/// What came of it.
#[derive(Debug)]
pub struct Trial {
    /// The row of the tables.
    pub row: String,
    /// Its seed.
    pub seed: u64,
    /// What its record is like: headings, and where under each it stands.
    pub facts: Vec<(&'static str, String)>,
    /// Scenes that were drawn in vain.
    pub redrawn: usize,
    /// Strength of the first kind.
    pub strength: Option<f64>,
    /// Probability that an ideal detector sees the first kind.
    pub ideal_power: Option<f64>,
    /// The score and the program's time, or why there is none.
    pub result: Result<(Score, Duration), Failure>,
}

/// Draws, writes and diagnoses one case, in a folder that is gone afterwards.
pub fn run_one(task: &Task, program: &dyn Diagnose) -> Trial {
    let case = Case::draw(&task.plan, task.seed);
    Trial {
        row: task.plan.name(),
        seed: task.seed,
        facts: facts(&case),
        redrawn: case.redrawn,
        strength: case.strength,
        ideal_power: case.ideal.map(|evidence| evidence.power),
        result: judge(&case, program),
    }
}

fn judge(case: &Case, program: &dyn Diagnose) -> Result<(Score, Duration), Failure> {
    let folder = tempfile::tempdir()?;
    let files = case.write(folder.path())?;
    let outcome = program.diagnose(&files)?;
    Ok((score(case, &outcome.answer), outcome.time))
}

/// Runs all tasks, `at_once` at a time; the trials come in the order of the tasks. `progress`
/// hears of every finished one.
pub fn run_all(
    tasks: &[Task],
    program: &dyn Diagnose,
    at_once: usize,
    progress: &(dyn Fn(&Trial) + Sync),
) -> Vec<Trial> {
    each(tasks, at_once, &|task| {
        let trial = run_one(task, program);
        progress(&trial);
        trial
    })
}

/// What `run` makes of each task, `at_once` at a time, in the order of the tasks.
pub fn each<A: Sync, T: Send>(
    tasks: &[A],
    at_once: usize,
    run: &(dyn Fn(&A) -> T + Sync),
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..at_once {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(task) = tasks.get(index) else { break };
                    let made = run(task);
                    if let Ok(mut done) = done.lock() {
                        done.push((index, made));
                    }
                }
            });
        }
    });
    let mut done: Vec<(usize, T)> = done.into_inner().unwrap_or_default();
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, made)| made).collect()
}
