//! Dwells too short for the means in which jumps were seen: the level goes over to the other one and comes back.

use super::differences::Sums;
use super::edge::{Known, Moment};
use crate::diagnosis::statistic::spread::middle_spread;

/// Spreads of what a mean stands out by, from which a dwell is read off: of a million means normal noise reaches it in one of
/// 500 records.
const BEYOND: f64 = 6.0;

/// Share of the height that it reaches at least: half, as what is nearer to the other level is of that.
const SHARE: f64 = 0.5;

/// Puts dwells of up to `longest` samples into `moments` that stand out of what is `left`; whether there were any.
pub fn add(left: &[f64], longest: usize, known: &Known, moments: &mut Vec<Moment>) -> bool {
    let sums = Sums::new(left);
    let before = moments.len();
    let mut samples = longest;
    while samples > 0 {
        for from in of_length(&sums, samples, longest, known, moments) {
            let place = moments.partition_point(|one| one.0 <= from);
            let up = place.checked_sub(1).map_or_else(
                || moments.first().is_some_and(|one| one.1),
                |last| !moments[last].1,
            );
            let both = [(from, up), (from + samples, !up)];
            moments.splice(place..place, both);
        }
        samples /= 2;
    }
    moments.len() > before
}

/// Where the level is the other one for so many samples, between two jumps.
fn of_length(
    sums: &Sums,
    samples: usize,
    beside: usize,
    known: &Known,
    moments: &[Moment],
) -> Vec<usize> {
    let stands_out = |from: usize| {
        let before = sums.mean(from.checked_sub(beside)?..from)?;
        let to = from + samples;
        let after = (to + beside <= sums.len()).then(|| sums.mean(to..to + beside))??;
        Some(sums.mean(from..to)? - 0.5 * (before + after))
    };
    let all: Vec<f64> = (0..sums.len())
        .map(|from| stands_out(from).unwrap_or(f64::NAN))
        .collect();
    let there: Vec<f64> = all.iter().copied().filter(|one| one.is_finite()).collect();
    let least = (BEYOND * middle_spread(&there)).max(SHARE * known.height);
    let mut found: Vec<usize> = Vec::new();
    let mut next_jump = 0;
    for (from, value) in all.iter().enumerate() {
        while moments.get(next_jump).is_some_and(|one| one.0 <= from) {
            next_jump += 1;
        }
        // Ahead of a jump up the level is the lower one, and goes up in between.
        let goes_up = match moments.get(next_jump) {
            Some(next) => next.1,
            None => moments.last().is_some_and(|last| !last.1),
        };
        let out = if goes_up { *value } else { -value };
        let ends_before = moments
            .get(next_jump)
            .is_none_or(|next| from + samples < next.0);
        let begins_after = next_jump
            .checked_sub(1)
            .is_none_or(|last| moments[last].0 < from);
        if !(out > least && ends_before && begins_after) {
            continue;
        }
        match found.last_mut() {
            // Of those that lie over one another the plainest.
            Some(last) if from < *last + samples + 1 => {
                if value.abs() > all[*last].abs() {
                    *last = from;
                }
            }
            _ => found.push(from),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::noise;
    use crate::diagnosis::record::switching::Edge;

    const HEIGHT: f64 = 8.0;

    /// Dwells found in noise that has the height for so many samples at these places of the lower level.
    fn found(seed: u64, there: &[(usize, usize)], longest: usize) -> Vec<Moment> {
        let mut left = noise(seed);
        for &(from, samples) in there {
            left[from..from + samples]
                .iter_mut()
                .for_each(|value| *value += HEIGHT);
        }
        let known = Known {
            height: HEIGHT,
            height_sd: 0.0,
            edge: Edge::default(),
        };
        let mut moments = vec![(15_000, true), (16_000, false)];
        add(&left, longest, &known, &mut moments);
        moments
    }

    #[test]
    fn short_dwells_stand_out_between_jumps() {
        let all = found(1, &[(3000, 20), (7000, 6), (11_000, 2), (18_000, 9)], 32);
        assert_eq!(all.len(), 10, "seed 1: {all:?}");
        assert!(
            all.windows(2)
                .all(|two| two[0].0 < two[1].0 && two[0].1 != two[1].1)
        );
        for (pair, from) in all.chunks(2).zip([3000, 7000, 11_000, 15_000, 18_000]) {
            assert!(
                pair[0].1 && pair[0].0.abs_diff(from) <= 16,
                "seed 1: {all:?}"
            );
        }
    }

    #[test]
    fn what_goes_away_from_the_other_level_is_no_dwell() {
        // Where the level is the upper one already.
        assert_eq!(found(2, &[(15_400, 20)], 32).len(), 2, "seed 2");
        assert_eq!(found(3, &[], 32).len(), 2, "seed 3");
    }
}
