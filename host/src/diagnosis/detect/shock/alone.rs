//! Single samples far off that come close to one another by chance: without them nothing is left of a stretch.

use std::ops::Range;

use super::scan::{NOTHING, Scan};
use super::stretch::Stretch;
use crate::diagnosis::statistic::p_value;
use crate::numeric::order::median;

/// Samples on either side that one is held against.
const BESIDE: usize = 2;

/// How many times as far as the middle one a sample lies from those beside it that is far off: a choice. Of normal numbers one
/// in a million does.
const FAR: f64 = 8.0;

/// Samples from one to the next at least: a choice. What comes closer together is something that lasts.
const APART: usize = 8;

/// Samples that are many, of which some come closer together by chance: a choice. How many is known to a quarter.
const MANY: usize = 16;

/// Probability of as many close to one another below which they are none by chance: a choice.
const BY_CHANCE: f64 = 1e-3;

/// Samples of a stretch for each that may be far off: a choice. With more, it is what the stretch consists of, unless the
/// record has so many that some stretch holds as many by chance; never one in so few as the second.
const SHARE: usize = 32;
const MOST: usize = 8;

/// Whether nothing is left of a `stretch` without single samples, each by itself: of what is `near`, in windows of `longest`
/// samples at most.
pub fn are_all(scan: &Scan<'_>, stretch: &Stretch, near: &Range<usize>, longest: usize) -> bool {
    let Some(singles) = Singles::of(scan, stretch, near) else {
        return false;
    };
    let mut without = scan.values()[near.clone()].to_vec();
    for at in singles.far {
        bridge(&mut without, &singles.seen, at);
    }
    scan.highest(&(0..without.len()), &singles.place, &without, longest) < NOTHING
}

/// How many single samples of a `stretch` lie far off, each by itself, of what is `near`; none where they are not by chance.
pub fn count(scan: &Scan<'_>, stretch: &Stretch, near: &Range<usize>) -> usize {
    Singles::of(scan, stretch, near).map_or(0, |singles| singles.within)
}

/// Single samples near a stretch that lie far off.
struct Singles {
    /// Samples that were measured, counted from the first that is near.
    seen: Vec<usize>,
    /// Which of these lie far off.
    far: Vec<usize>,
    /// The stretch, counted likewise.
    place: Range<usize>,
    /// How many lie in it.
    within: usize,
}

impl Singles {
    /// Those of a `stretch`, of what is `near`; `None` where there are none, or not by chance.
    fn of(scan: &Scan<'_>, stretch: &Stretch, near: &Range<usize>) -> Option<Self> {
        let values = &scan.values()[near.clone()];
        let seen: Vec<usize> = (0..values.len())
            .filter(|n| scan.is_seen(near.start + n))
            .collect();
        let far = far_off(values, &seen)?;
        let place = stretch.samples.start - near.start..stretch.samples.end - near.start;
        let within = far.iter().filter(|at| place.contains(&seen[**at])).count();
        let close = far
            .windows(2)
            .filter(|two| seen[two[1]] - seen[two[0]] < APART);
        let is_few = within <= 1 + place.len() / SHARE || is_by_chance(scan, within, place.len());
        let are_some =
            within > 0 && is_few && come_together(scan, close.count(), far.len(), values.len());
        are_some.then_some(Self {
            seen,
            far,
            place,
            within,
        })
    }
}

/// Whether a record holds so many single samples far off that some stretch of a `length` has so many `within` by chance.
fn is_by_chance(scan: &Scan<'_>, within: usize, length: usize) -> bool {
    if within > length / MOST {
        return false;
    }
    let samples = scan.values().len() as f64;
    let all = in_record(scan);
    // Those within may be what is asked about.
    let expected = all.saturating_sub(within) as f64 * length as f64 / samples;
    let stretches = samples / length as f64;
    p_value::searched(p_value::poisson(within as u64, expected), stretches) > BY_CHANCE
}

/// How many single samples of a record lie far off.
fn in_record(scan: &Scan<'_>) -> usize {
    scan.far_off(|scan| {
        let seen: Vec<usize> = (0..scan.values().len())
            .filter(|n| scan.is_seen(*n))
            .collect();
        far_off(scan.values(), &seen).map_or(0, |far| far.len())
    })
}

/// Whether so many `close` pairs of `all` come about by chance among so many samples: as often as there are samples far off, or,
/// where they are few, as often as in the rest of the record.
pub fn come_together(scan: &Scan<'_>, close: usize, all: usize, samples: usize) -> bool {
    if close == 0 {
        return true;
    }
    let (count, of) = if all >= MANY {
        (all - 1, samples)
    } else {
        (in_record(scan).saturating_sub(all), scan.values().len())
    };
    let share = count as f64 / of as f64;
    let expected = share * share * (APART - 1) as f64 * samples as f64;
    count >= MANY - 1 && p_value::poisson(close as u64, expected) > BY_CHANCE
}

/// Which of some samples that are `seen` lie far off those beside them; `None` where most do not change.
fn far_off(values: &[f64], seen: &[usize]) -> Option<Vec<usize>> {
    let off = |at: usize| {
        let beside = at.saturating_sub(BESIDE)..(at + BESIDE + 1).min(seen.len());
        let mut beside: Vec<f64> = beside.map(|one| values[seen[one]]).collect();
        median(&mut beside).map_or(0.0, |middle| (values[seen[at]] - middle).abs())
    };
    let all: Vec<f64> = (0..seen.len()).map(off).collect();
    let usual = median(&mut all.clone()).filter(|usual| *usual > 0.0)?;
    let far = (0..all.len()).filter(|at| all[*at] > FAR * usual);
    Some(far.collect())
}

/// Puts a line from the sample seen before to the one behind in the place of one, and of what was drawn by it.
fn bridge(values: &mut [f64], seen: &[usize], at: usize) {
    let before = at.checked_sub(1).map(|one| seen[one]);
    let behind = seen.get(at + 1).copied();
    let gone: Range<usize> = before.map_or(0, |n| n + 1)..behind.unwrap_or(values.len());
    let Some(level) = before.or(behind).map(|n| values[n]) else {
        return;
    };
    let [from, to] = [before, behind].map(|n| n.map_or(level, |n| values[n]));
    let parts = (gone.len() + 1) as f64;
    for (part, value) in values[gone].iter_mut().enumerate() {
        *value = from + (part + 1) as f64 / parts * (to - from);
    }
}
