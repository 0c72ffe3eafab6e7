//! The longest stretch of batches without a gap, by which the data rate is measured.

use inm_protocol::Batch;

/// A stretch of batches without a gap: from the first to the last, in the board's own count, and what lies
/// between each two of them.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Conversions.
    pub conversions: u64,
    /// Ticks of the stamps.
    pub ticks: u64,
    /// Batches after the first.
    intervals: u64,
    /// Ticks a conversion from the first batch to the second: sums are of what lies beyond it, so that their
    /// squares keep their digits.
    guess: f64,
    /// Sums over the intervals of the squares of conversions and of ticks beyond the guess, and of their
    /// products.
    squares: [f64; 3],
}

impl Stretch {
    fn push(&mut self, conversions: u64, ticks: u64) {
        let count = conversions as f64;
        if self.intervals == 0 {
            self.guess = ticks as f64 / count.max(1.0);
        }
        let beyond = ticks as f64 - self.guess * count;
        self.conversions += conversions;
        self.ticks += ticks;
        self.intervals += 1;
        for (sum, square) in
            self.squares
                .iter_mut()
                .zip([count * count, beyond * beyond, count * beyond])
        {
            *sum += square;
        }
    }

    /// Standard deviation of the ticks between two stamps about what their conversions take, and its degrees of
    /// freedom; `None` with one interval. Each stamp is late by what it is late by, whichever two they are: so
    /// uncertain is the whole stretch, too.
    pub fn spread(&self) -> Option<(f64, f64)> {
        let freedom = self.intervals.checked_sub(1).filter(|more| *more > 0)? as f64;
        let slope = self.ticks as f64 / self.conversions as f64 - self.guess;
        let [counts, beyond, products] = self.squares;
        let square = beyond - 2.0 * slope * products + slope * slope * counts;
        Some(((square.max(0.0) / freedom).sqrt(), freedom))
    }
}

/// The present stretch and the longest so far.
#[derive(Debug, Default)]
pub(super) struct Stretches {
    /// Index and stamp of the last batch, in the board's own count.
    last: (u64, u64),
    now: Stretch,
    longest: Stretch,
}

impl Stretches {
    /// The next batch; `goes_on` if no gap is ahead of it.
    pub(super) fn push(&mut self, batch: &Batch, goes_on: bool) {
        let (index, stamp) = std::mem::replace(&mut self.last, (batch.first, batch.stamp));
        match (
            batch.first.checked_sub(index),
            batch.stamp.checked_sub(stamp),
        ) {
            (Some(conversions), Some(ticks)) if goes_on => self.now.push(conversions, ticks),
            _ => self.now = Stretch::default(),
        }
        if self.now.ticks > self.longest.ticks {
            self.longest = self.now;
        }
    }

    /// The longest, from its first batch to its last.
    pub(super) fn longest(&self) -> Stretch {
        self.longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(first: u64, stamp: u64) -> Batch {
        Batch {
            first,
            stamp,
            ..Batch::default()
        }
    }

    /// Stamps that are in turn on time and `late` ticks late, a batch of ten conversions every 1000 ticks.
    #[test]
    fn the_spread_is_that_of_the_stamps() {
        let mut stretches = Stretches::default();
        for (late, count) in [(7, 40), (2, 500)] {
            for k in 0..=count {
                stretches.push(&batch(10 * k, 1000 * k + late * (k % 2)), k > 0);
            }
        }
        let longest = stretches.longest();
        assert_eq!((longest.conversions, longest.ticks), (5000, 500_000));
        let (spread, freedom) = longest.spread().expect("many");
        assert_eq!(freedom, 499.0);
        // Each interval is off by two ticks, one way or the other.
        let expected = (500.0_f64 * 4.0 / 499.0).sqrt();
        assert!((spread / expected - 1.0).abs() < 1e-9, "{spread}");
    }

    #[test]
    fn stamps_that_go_back_begin_a_stretch() {
        let mut stretches = Stretches::default();
        for (first, stamp) in [(0, 9000), (10, 10_000), (20, 500), (30, 1500)] {
            stretches.push(&batch(first, stamp), first > 0);
        }
        let longest = stretches.longest();
        assert_eq!((longest.conversions, longest.ticks), (10, 1000));
        assert_eq!(longest.spread(), None);
    }
}
