//! Readings of both clocks on the way through a record, in bounded memory.

use super::line::{late_s, span_s};
use super::{Measured, Pair, ratio};

/// Most readings that are kept: more than an hour of them one by one, and far more than the blocks that a rate is
/// made of.
const MOST: usize = 4096;

/// Readings of both clocks since the board last started; of several starts the longest counts.
#[derive(Debug, Default)]
pub struct Pairs {
    /// Stamp and host's time of the first reading since the board started, and of the last.
    run: Option<[(u64, u64); 2]>,
    now: Vec<Pair>,
    longest: Vec<Pair>,
}

impl Pairs {
    /// Takes a reading: ticks of the board's timer, which has `timer_hz` in a second, and microseconds of the host.
    /// A clock that goes back is another one: the board has restarted.
    pub fn push(&mut self, stamp: u64, host_us: u64, timer_hz: u32) {
        let run = match self.run {
            Some([first, last]) if stamp > last.0 && host_us >= last.1 => [first, (stamp, host_us)],
            _ => {
                self.end_run();
                [(stamp, host_us); 2]
            }
        };
        self.run = Some(run);
        if self.now.len() == MOST {
            self.now = thinned(&self.now);
        }
        self.now.push(Pair {
            board_s: (stamp - run[0].0) as f64 / f64::from(timer_hz.max(1)),
            host_s: (host_us - run[0].1) as f64 * 1e-6,
        });
    }

    fn end_run(&mut self) {
        let ended = std::mem::take(&mut self.now);
        if span_s(&ended) > span_s(&self.longest) {
            self.longest = ended;
        }
    }

    /// Seconds of the board's clock in one of the host's, over the longest time that the board ran.
    pub fn ratio(&self) -> Option<Measured> {
        let now = span_s(&self.now) >= span_s(&self.longest);
        ratio(if now { &self.now } else { &self.longest })
    }
}

/// Of each two the less late.
fn thinned(pairs: &[Pair]) -> Vec<Pair> {
    let (Some(first), Some(last)) = (pairs.first(), pairs.last()) else {
        return Vec::new();
    };
    let slope = (last.board_s - first.board_s) / (last.host_s - first.host_s);
    // A host's clock that stood still has no slope, and any reading is as good.
    let slope = if slope.is_normal() { slope } else { 1.0 };
    let late = |one: &&Pair| late_s(one, slope);
    let least = |two: &[Pair]| {
        two.iter()
            .min_by(|a, b| late(a).total_cmp(&late(b)))
            .copied()
    };
    pairs.chunks(2).filter_map(least).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMER_HZ: u32 = 1_000_000;

    /// Readings once a second by a board's clock that is `ppm` fast and begins at `ticks`.
    fn read(pairs: &mut Pairs, ticks: u64, from_s: u64, count: u64, ppm: i64) {
        for k in 0..count {
            let board_us = k * (1_000_000_i64 + ppm) as u64;
            pairs.push(ticks + board_us, (from_s + k) * 1_000_000, TIMER_HZ);
        }
    }

    #[test]
    fn of_a_board_that_restarted_the_longest_life_counts() {
        for lives in [[(30, 40), (300, -70)], [(300, -70), (30, 40)]] {
            let mut pairs = Pairs::default();
            let mut from_s = 5;
            for (count, ppm) in lives {
                read(&mut pairs, 700, from_s, count, ppm);
                from_s += count + 9;
            }
            let ppm = 1e6 * (pairs.ratio().expect("enough").value - 1.0);
            assert!((ppm + 70.0).abs() < 1e-3, "{lives:?}: {ppm}");
        }
    }

    #[test]
    fn a_month_takes_no_more_memory_than_an_hour_and_says_as_much() {
        let mut pairs = Pairs::default();
        read(&mut pairs, u64::from(u32::MAX), 0, 30 * 86_400, 25);
        assert!(pairs.now.len() <= MOST, "{}", pairs.now.len());
        let ratio = pairs.ratio().expect("enough");
        assert!((1e6 * (ratio.value - 1.0) - 25.0).abs() < 1e-6, "{ratio:?}");
    }

    #[test]
    fn clocks_that_stand_still_say_nothing() {
        let mut pairs = Pairs::default();
        for stamp in 0..2 * MOST as u64 {
            pairs.push(stamp, 7, TIMER_HZ);
        }
        assert_eq!(pairs.ratio(), None);
        pairs.push(3, 8, TIMER_HZ);
        assert_eq!(pairs.ratio(), None);
    }
}
