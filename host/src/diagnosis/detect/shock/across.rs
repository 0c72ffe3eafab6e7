//! What is longer than what short windows found of it: the middle of a bump, whose ends alone are too quick for them.
//!
//! Long windows look beside what was found, and across it, where it is taken out: what stands out still is not what was found.

use std::ops::Range;

use super::stretch::Stretch;
use super::usual::{Height, Usual};

/// Windows in some `runs` across what was `found` in shorter ones, of those that are `from` or higher without it, where they stand
/// out much further than it does, at a frequency that is too low for the windows that it was found in.
pub fn across(
    usual: &Usual,
    values: &[f64],
    runs: &[Range<usize>],
    found: &[Stretch],
    from: f64,
) -> Vec<(usize, Height)> {
    /// How much further: a choice, four times the nats.
    const FURTHER: f64 = 2.0;
    let values = without_found(values, runs, found);
    let len = usual.windows.len();
    let mut memory = (usual.windows.scratch(), Vec::new());
    let mut all = Vec::new();
    for Stretch {
        samples, window, ..
    } in found
    {
        let Some(run) = runs.iter().find(|run| run.contains(&samples.start)) else {
            continue;
        };
        let near =
            samples.start.saturating_sub(len).max(run.start)..(samples.end + len).min(run.end);
        for start in usual.windows.starts(&near) {
            let within = found
                .iter()
                .filter(|one| one.samples.start < start + len && start < one.samples.end);
            let least = within.fold(from, |least, one| least.max(FURTHER * one.z));
            let height = usual.height(&values, start, least, &mut memory);
            if height.z >= least && height.cycles * window < len {
                all.push((start, height));
            }
        }
    }
    all
}

/// Some samples without what was `found`: each stretch has the level of those before it in its run, and so has what comes
/// behind, so that nothing is left of a jump either.
fn without_found(values: &[f64], runs: &[Range<usize>], found: &[Stretch]) -> Vec<f64> {
    let mut all = values.to_vec();
    let (mut shift, mut next) = (0.0, 0);
    for hole in found.iter().map(|one| &one.samples) {
        let Some(run) = runs.iter().find(|run| run.contains(&hole.start)) else {
            continue;
        };
        all[next..hole.start]
            .iter_mut()
            .for_each(|one| *one -= shift);
        // A level that is the mean of half as many errs by less than the noise of a window.
        let reach = hole.len() / 2 + 1;
        let level = |part: Range<usize>| {
            let count = part.len() as f64;
            (count > 0.0).then(|| all[part].iter().sum::<f64>() / count)
        };
        let before = level(hole.start.saturating_sub(reach).max(run.start).max(next)..hole.start);
        let behind = level(hole.end..(hole.end + reach).min(run.end)).map(|one| one - shift);
        if let (Some(before), Some(behind)) = (before, behind) {
            shift += behind - before;
        }
        let level = before.or(behind).unwrap_or(0.0);
        all[hole.clone()].fill(level);
        next = hole.end;
    }
    all[next..].iter_mut().for_each(|one| *one -= shift);
    all
}
