//! The course of a jump, as the mean of all of them says it, and the moments that it gives each.
//!
//! Jumps that stand alone say how high all are. What a record has about each jump beyond what is known so far is then added
//! to the course, jump by jump in the same way, until nothing is left on average (Jacobi's method for the least squares of all
//! courses together; a course no longer than half of a dwell makes it converge).

use std::ops::Range;

use crate::diagnosis::record::switching::{Edge, Switching};
use crate::numeric::taper::hann;

/// Samples on either side of a jump that its course may take, at most: those over which a converter's filter spreads it.
const LONGEST: usize = 64;

/// The same at least: a level is the mean of as many.
const SHORTEST: usize = 4;

/// Jumps that stand alone, at least, by which their height is known: their scatter is known to a fifth.
const LEAST: usize = 12;

/// Standard errors beyond which the course departs from a sharp one: normal noise does so in one of 16 000 samples.
const DEPARTS: f64 = 4.0;

/// Deviations of a mean square of `n` jumps beyond the usual one, `sqrt(2 / n)` each, from which jumps differ at a sample.
const DIFFERS: f64 = 6.0;

/// A jump at its moment: the first sample after it, and whether it goes up.
pub type Moment = (usize, bool);

/// What is known of all jumps of a record together.
#[derive(Debug, Clone)]
pub struct Known {
    /// Distance of the levels, in the unit of the record.
    pub height: f64,
    /// Its standard deviation.
    pub height_sd: f64,
    /// How a jump comes about.
    pub edge: Edge,
}

/// Mean, mean square about it, and number of what jumps have at one sample.
struct Row {
    mean: f64,
    square: f64,
    count: f64,
}

impl Known {
    /// Of the jumps at some `moments` of `values` (NaN where none is), as if they were sharp; `None` where too few stand alone.
    pub fn first(values: &[f64], moments: &[Moment]) -> Option<Self> {
        let [height, height_sd] = rise(values, moments)?;
        Some(Self {
            height,
            height_sd,
            edge: Edge::default(),
        })
    }

    /// The same after what is left about the jumps, with all of them at their moments taken out.
    pub fn again(&self, values: &[f64], moments: &[Moment]) -> Option<Self> {
        let mut left = values.to_vec();
        self.wave(moments).take_out(&mut left);
        let [more, height_sd] = rise(&left, moments)?;
        let reach = reach(moments);
        let rows: Vec<Row> = (0..2 * reach)
            .map(|place| Row::new(&left, moments, place, reach))
            .collect();
        let before = &self.edge.beside;
        let known = |place: usize| {
            let ahead = (place + before.len() / 2).checked_sub(reach);
            ahead.and_then(|place| before.get(place)).unwrap_or(&0.0)
        };
        let course: Vec<f64> = (0..2 * reach)
            .map(|place| known(place) + rows[place].mean / self.height)
            .collect();
        Some(Self {
            height: self.height + more,
            height_sd,
            edge: edge(&course, &rows, self.height),
        })
    }

    /// The jumps at these moments as they are in the record.
    pub fn wave(&self, moments: &[Moment]) -> Switching {
        let up = moments.first().is_some_and(|one| one.1);
        Switching {
            moments: moments.iter().map(|one| one.0).collect(),
            first: if up { self.height } else { -self.height },
            edge: self.edge.clone(),
        }
    }

    /// The sample `within` which a jump fits best that goes up or not, among the samples there; the first after it.
    pub fn moment(&self, values: &[f64], within: Range<usize>, up: bool) -> Option<usize> {
        let height = if up { self.height } else { -self.height };
        let half = self.edge.beside.len() / 2;
        let misfit = |at: usize| {
            let off = within.clone().filter_map(|n| {
                let sharp = if n < at { -0.5 } else { 0.5 };
                let place = (n + half).checked_sub(at);
                let beside = place.and_then(|place| self.edge.beside.get(place));
                let off = values[n] - height * (sharp + beside.unwrap_or(&0.0));
                off.is_finite().then_some(off)
            });
            let (sum, squares, count) = off.fold((0.0, 0.0, 0.0), |(sum, squares, count), off| {
                (sum + off, squares + off * off, count + 1.0)
            });
            // Whatever the level between the two is.
            squares - sum * sum / f64::max(count, 1.0)
        };
        let all = within.clone().skip(1).map(|at| (at, misfit(at)));
        let best = all.min_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(at, _)| at)
    }
}

impl Row {
    /// Of what is left at a place of a course that begins `reach` samples ahead of a jump, turned to go up.
    fn new(left: &[f64], moments: &[Moment], place: usize, reach: usize) -> Self {
        let at = |(at, up): &Moment| {
            let value = left.get((at + place).checked_sub(reach)?)?;
            let upright = if *up { *value } else { -value };
            upright.is_finite().then_some(upright)
        };
        let there: Vec<f64> = moments.iter().filter_map(at).collect();
        let count = there.len().max(1) as f64;
        let mean = there.iter().sum::<f64>() / count;
        let squares = there.iter().map(|one| (one - mean).powi(2));
        Self {
            mean,
            square: squares.sum::<f64>() / count,
            count,
        }
    }
}

/// Samples on either side that a course takes: half of a dwell, within its limits.
fn reach(moments: &[Moment]) -> usize {
    let [Some(first), Some(last)] = [moments.first(), moments.last()] else {
        return SHORTEST;
    };
    let dwell = (last.0 - first.0) / moments.len().max(1);
    (dwell / 2).clamp(SHORTEST, LONGEST)
}

/// By how much the level is higher after a jump up than before it, or lower after one down, where they stand alone, and the
/// standard deviation of that. Beyond the course that a jump takes, where enough of them stand so far apart: within it a
/// higher jump and a course that ends lower are one.
fn rise(values: &[f64], moments: &[Moment]) -> Option<[f64; 2]> {
    let mut reach = 2 * reach(moments).next_power_of_two();
    loop {
        let half = reach / 2;
        let of = |(at, up): Moment| {
            let before = mean(&values[at - reach..at - half])?;
            let after = mean(&values[at + half..at + reach])?;
            Some(if up { after - before } else { before - after })
        };
        let alone = standing_alone(moments, reach, values.len());
        let all: Vec<f64> = alone.into_iter().filter_map(of).collect();
        if all.len() >= LEAST.max(moments.len() / 4) {
            let count = all.len() as f64;
            let rise = all.iter().sum::<f64>() / count;
            let square = all.iter().map(|one| (one - rise).powi(2)).sum::<f64>() / count;
            return Some([rise, (square / count).sqrt()]);
        }
        reach = half;
        if reach < SHORTEST {
            return None;
        }
    }
}

/// Jumps that no other comes as near to, nor an end of the record.
fn standing_alone(moments: &[Moment], reach: usize, len: usize) -> Vec<Moment> {
    let is_alone = |place: &usize| {
        let (at, _) = moments[*place];
        let before = place.checked_sub(1).map_or(0, |one| moments[one].0);
        let after = moments.get(place + 1).map_or(len, |one| one.0);
        at >= before + reach && at + reach <= after
    };
    let places = (0..moments.len()).filter(is_alone);
    places.map(|place| moments[place]).collect()
}

/// Mean of the values that are there.
fn mean(values: &[f64]) -> Option<f64> {
    let there = values.iter().filter(|one| one.is_finite());
    let (sum, count) = there.fold((0.0, 0.0), |(sum, count), one| (sum + one, count + 1.0));
    (count > 0.0).then_some(sum / count)
}

/// The edge of a mean `course`, in heights beyond a sharp one, about which jumps scatter by these rows.
fn edge(course: &[f64], rows: &[Row], height: f64) -> Edge {
    let reach = course.len() / 2;
    let quarter = reach / 4;
    let departs = |(part, row): (&f64, &Row)| {
        part.abs() > DEPARTS * (row.square / row.count).sqrt() / height.abs()
    };
    let is_sharp = !course.iter().zip(rows).any(departs);
    // Cut off sharply, what chance makes of the mean course would be noise where a filter leaves none.
    let rise = quarter.max(1) as f64;
    let tapered = |(place, part): (usize, &f64)| {
        let from_end = place.min(course.len() - 1 - place) as f64 + 0.5;
        hann(from_end.min(rise), 2.0 * rise) * part
    };
    // Of walk, what is farthest from a jump scatters most.
    let ends = rows[..quarter].iter().chain(&rows[rows.len() - quarter..]);
    let usual = ends.map(|row| row.square).sum::<f64>() / (2 * quarter).max(1) as f64;
    let differs = |place: &usize| {
        let row = &rows[*place];
        row.square > usual * (1.0 + DIFFERS * (2.0 / row.count).sqrt())
    };
    let far = |place: usize| match place < reach {
        true => reach - place,
        false => place + 1 - reach,
    };
    let inner = quarter..course.len() - quarter;
    Edge {
        beside: match is_sharp {
            true => Vec::new(),
            false => course.iter().enumerate().map(tapered).collect(),
        },
        unsure: inner.filter(differs).map(far).max().unwrap_or(0),
    }
}
