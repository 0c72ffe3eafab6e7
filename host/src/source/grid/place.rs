//! Where the count of the rows falls behind the grid for good.
//!
//! A row may come late (a driver was busy, a FIFO was read in one go), and those after it catch up:
//! nothing is lost. A loss is what no row catches up with. So the least lateness of the next rows is
//! held against the least lateness of those before: delays leave it where it is, a loss raises it by
//! the number of samples.

use std::collections::VecDeque;

use super::least::{Least, ahead};

/// Part of a period by which a level may be off and still counts as whole periods: half way between
/// none and a half, so that neither a coarse stamp nor the period's own error makes a sample.
const SLACK: f64 = 0.25;

/// Rows over which the level before a loss is taken at least. A clock that is off by a hundredth of
/// [`SLACK`] a row, more than any oscillator, does not pass for a loss over them.
const SHORTEST_HORIZON: usize = 64;

/// Samples that are not there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Loss {
    /// The first row behind them.
    pub row: usize,
    /// How many.
    pub samples: u64,
}

/// Rows placed on a grid.
pub struct Placing {
    /// What is missing, by ascending row.
    pub losses: Vec<Loss>,
    /// A row from which on there are more rows than the stamps have room for: then the grid, or what
    /// was taken for a loss before, is wrong.
    pub crowded: Option<usize>,
}

/// Places rows with stamps `times` on a grid of `period`, given that every `window` rows at least
/// one was on time.
pub fn place(times: &[f64], period: f64, window: usize) -> Placing {
    let late = |(row, time): (usize, &f64)| (time - times[0]) / period - row as f64;
    let late: Vec<f64> = times.iter().enumerate().map(late).collect();
    let rows = late.len();
    let horizon = (2 * window).max(SHORTEST_HORIZON).min((rows / 4).max(1));
    let mut walk = Walk {
        coming: ahead(&late, window),
        late,
        window,
        horizon,
        before: Least::default(),
        placed: Vec::with_capacity(rows),
        levels: VecDeque::with_capacity(horizon),
        lost: 0.0,
        noticed: None,
        told: 0,
    };
    let (mut losses, mut crowded) = (Vec::new(), None);
    for row in 0..rows {
        losses.extend(walk.loss(row));
        if walk.is_crowded(row) {
            crowded = crowded.or(Some(row));
        }
    }
    Placing { losses, crowded }
}

/// The way along the rows. Lateness is in periods, against a grid without losses.
struct Walk {
    late: Vec<f64>,
    /// Least of the next `window` rows, for each.
    coming: Vec<f64>,
    window: usize,
    /// Rows that the level before is taken over.
    horizon: usize,
    /// The rows so far, against the grid with what is lost.
    before: Least,
    placed: Vec<f64>,
    /// `coming` of the last `horizon` rows, against the same.
    levels: VecDeque<f64>,
    lost: f64,
    /// A loss that shows, and the row where it is.
    noticed: Option<(usize, f64)>,
    /// Row from which on it is clear again what lies behind the last loss.
    told: usize,
}

impl Walk {
    fn is_whole(&self, row: usize) -> bool {
        row + self.window <= self.late.len()
    }

    /// The loss right before `row`, which is taken in.
    fn loss(&mut self, row: usize) -> Option<Loss> {
        if row > 0 && self.noticed.is_none() && self.is_whole(row) {
            self.noticed = self.notice(row);
        }
        let loss = self.noticed.take_if(|(at, _)| *at == row);
        if let Some((_, samples)) = loss {
            self.lost += samples;
            self.told = row + self.window / 2;
        }
        let placed = self.late[row] - self.lost;
        self.before.push(row, placed);
        self.placed.push(placed);
        loss.map(|(row, samples)| Loss {
            row,
            samples: samples as u64,
        })
    }

    /// A loss within the `window` that begins at `row`: where, and of how many.
    fn notice(&mut self, row: usize) -> Option<(usize, f64)> {
        let since = row.saturating_sub(self.horizon);
        let level = self.lost + self.before.since(since)?;
        let missing = |row: usize| self.coming[row] - level;
        if missing(row) < 1.0 - SLACK {
            return None;
        }
        let usual = self.lost + middle(&self.placed[since..]);
        let next = self.late[row..row + self.window].iter();
        let next: Vec<f64> = next.map(|late| late - usual).collect();
        // A late row before the loss hides part of it, by half a window at most.
        let clear = (row + self.window / 2).min(self.late.len() - self.window);
        let samples = missing(clear).round().max(1.0);
        Some((row + split(&next, samples), samples))
    }

    /// Whether the rows from `row` on come before their time, by the level of `horizon` rows ago.
    fn is_crowded(&mut self, row: usize) -> bool {
        // Beside a loss, which row is before it and which behind is not known as well as this.
        let is_clear = self.noticed.is_none() && row >= self.told;
        let level = match self.levels.back() {
            Some(&last) if !is_clear => last,
            _ => self.coming[row] - self.lost,
        };
        self.levels.push_back(level);
        if self.levels.len() <= self.horizon {
            return false;
        }
        let then = self.levels.pop_front().unwrap_or(level);
        self.is_whole(row) && level - then <= SLACK - 1.0
    }
}

/// The value in the middle.
fn middle(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The row among the `next`, late by so much more than usual, from which on they lie nearer to
/// `samples` than to none.
fn split(next: &[f64], samples: f64) -> usize {
    let (mut best, mut most, mut sum) = (0, f64::NEG_INFINITY, 0.0);
    for (row, late) in next.iter().enumerate().rev() {
        sum += late.abs() - (late - samples).abs();
        if sum >= most {
            (best, most) = (row, sum);
        }
    }
    best
}
