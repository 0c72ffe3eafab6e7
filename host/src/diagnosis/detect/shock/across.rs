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
    let both = [false, true].map(|levelled| without_found(values, runs, found, levelled));
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
            let heights = both
                .each_ref()
                .map(|values| usual.height(values, start, least, &mut memory));
            let [height, _] = heights;
            let is_high = heights.iter().all(|one| one.z >= least);
            if is_high && height.cycles * window < len {
                all.push((start, height));
            }
        }
    }
    all
}

/// Some samples without what was `found`. Each stretch is a line between the levels before and behind it in its run; or all
/// that comes behind is `levelled` too, so that nothing is left of a jump.
fn without_found(
    values: &[f64],
    runs: &[Range<usize>],
    found: &[Stretch],
    levelled: bool,
) -> Vec<f64> {
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
        let [from, to] = [before.or(behind), behind.or(before)].map(|one| one.unwrap_or(0.0));
        let rise = to - from;
        let length = hole.len() as f64;
        for (n, value) in all[hole.clone()].iter_mut().enumerate() {
            let part = if levelled {
                0.0
            } else {
                (n as f64 + 0.5) / length
            };
            *value = from + rise * part;
        }
        shift += if levelled { rise } else { 0.0 };
        next = hole.end;
    }
    all[next..].iter_mut().for_each(|one| *one -= shift);
    all
}
