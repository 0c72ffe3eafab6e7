//! The rate of the board's clock by a pulse a second: which whole second each pulse is of, and a line through them.
//!
//! A pulse says when a second begins and not which. So they are counted on: one is of the same receiver as those
//! before it where it comes a whole number of their seconds later. What does not is put aside, and is the first of
//! others where the next one follows it: a receiver that has found its satellites steps once, a disturbance comes
//! from nowhere. Of several such runs the longest counts.
//!
//! The board's time ahead of whole seconds is a line, whose slope is what its clock is off by. What lies off it is the
//! jitter of the receiver, of the board's tick and of its crystal, and says how well the slope is known. Neighbours may
//! have it in common (a receiver rounds to a tick of its own, a crystal is warmed), so the line goes through the means of
//! [`BLOCKS`] stretches of time: what they have in common within one is in its mean. Least squares, each stretch by the
//! number of its pulses; the interval is that of a slope, by Student's distribution.

use inm_protocol::{Pulse, PulseCounters};

use super::Measured;
use super::line::{BLOCKS, FEWEST, FROM};

/// Part by which the board's clock may be off before it is known by the pulses: twice what the oscillator inside a
/// microcontroller is.
const UNKNOWN: f64 = 2e-2;

/// Part by which it may change while none comes, once it is known: the oscillator inside, over some 10 K.
const CHANGES: f64 = 1e-3;

/// Seconds by which a pulse may be off its place: a thousand times what a receiver's is that knows the time.
const JITTER_S: f64 = 1e-3;

/// Seconds by which the place of the next may be unknown at most, so that it is of one second and no other.
const SURE_S: f64 = 0.25;

/// Most readings that are kept: an hour one by one. Beyond it two neighbours become their mean.
const MOST: usize = 4096;

/// Pulses that count together: the mean of their seconds, and of the board's time ahead of them.
#[derive(Debug, Clone, Copy)]
struct Reading {
    second: f64,
    ahead_s: f64,
    count: f64,
}

/// Pulses that are whole seconds apart.
#[derive(Debug, Clone, Default)]
struct Run {
    /// Stamps of the first and the last, and which second the last is of, counted from the first.
    ends: Option<(u64, u64, u64)>,
    pulses: u64,
    readings: Vec<Reading>,
}

/// The pulses of a record, in bounded memory.
#[derive(Debug, Default)]
pub struct Pulses {
    timer_hz: u32,
    now: Run,
    /// What followed nothing, and those that follow it.
    aside: Run,
    longest: Run,
    tally: Option<Tally>,
}

/// What was told of the pulses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tally {
    /// Pulses that arrived.
    pub arrived: u64,
    /// Pulses that the board told, or would have told, between the first and the last that arrived, and that did not.
    pub lost: u64,
    /// What the board counted since the first that arrived.
    pub counters: PulseCounters,
    last: u32,
    before: PulseCounters,
}

impl Pulses {
    /// Takes a pulse by a timer of `timer_hz` ticks a second. A stamp that goes back is of a board that has restarted.
    pub fn push(&mut self, pulse: &Pulse, timer_hz: u32) {
        self.timer_hz = timer_hz.max(1);
        self.count(pulse);
        if pulse.doubled {
            return;
        }
        let stamp = pulse.stamp;
        if self.now.ends.is_some_and(|(_, last, _)| stamp <= last) {
            self.end();
            self.aside = Run::default();
        }
        if self.now.follow(stamp, self.timer_hz) {
            return;
        }
        let begun = self.aside.ends.map(|(first, ..)| first);
        if !self.aside.follow(stamp, self.timer_hz) {
            self.aside = Run::default();
            self.aside.follow(stamp, self.timer_hz);
        } else if begun > self.now.ends.map(|(_, last, _)| last) {
            // Two in step, and none of the others came between.
            self.end();
            self.now = std::mem::take(&mut self.aside);
        }
    }

    /// The run at hand is over.
    fn end(&mut self) {
        let ended = std::mem::take(&mut self.now);
        if ended.seconds() > self.longest.seconds() {
            self.longest = ended;
        }
    }

    fn count(&mut self, pulse: &Pulse) {
        let Pulse {
            number, counters, ..
        } = *pulse;
        // A board that has restarted counts from nothing.
        let after = |tally: &Tally| number.wrapping_sub(tally.last).cast_signed() > 0;
        match &mut self.tally {
            Some(tally) if after(tally) => {
                tally.arrived += 1;
                tally.lost += u64::from(number.wrapping_sub(tally.last)) - 1;
                let grown =
                    |new: u32, old: u32, had: u32| had.saturating_add(new.wrapping_sub(old));
                let (had, old) = (tally.counters, tally.before);
                tally.counters = PulseCounters {
                    early: grown(counters.early, old.early, had.early),
                    doubled: grown(counters.doubled, old.doubled, had.doubled),
                    missing: grown(counters.missing, old.missing, had.missing),
                    odd: grown(counters.odd, old.odd, had.odd),
                };
                (tally.last, tally.before) = (number, counters);
            }
            Some(tally) => {
                tally.arrived += 1;
                (tally.last, tally.before) = (number, counters);
            }
            None => {
                self.tally = Some(Tally {
                    arrived: 1,
                    lost: 0,
                    counters: PulseCounters::default(),
                    last: number,
                    before: counters,
                });
            }
        }
    }

    /// What was told of them; `None` where there was none.
    pub fn tally(&self) -> Option<&Tally> {
        self.tally.as_ref()
    }

    /// Seconds of the board's clock in one of the pulses, over the longest run; `None` with fewer than [`FEWEST`].
    pub fn ratio(&self) -> Option<Measured> {
        let now = self.now.seconds() >= self.longest.seconds();
        let run = if now { &self.now } else { &self.longest };
        run.ratio(self.timer_hz)
    }
}

impl Run {
    /// Whole seconds from the first to the last.
    fn seconds(&self) -> u64 {
        self.ends.map_or(0, |(_, _, second)| second)
    }

    /// Takes a pulse that is the first, or follows; else nothing happens, and `false`.
    fn follow(&mut self, stamp: u64, timer_hz: u32) -> bool {
        let Some((first, last, second)) = self.ends else {
            self.take(stamp, stamp, 0, timer_hz);
            return true;
        };
        let nominal = f64::from(timer_hz);
        let (pace, known) = match self.pulses < FEWEST as u64 {
            true => (nominal, UNKNOWN),
            false => ((last - first) as f64 / second as f64, CHANGES),
        };
        let exact = stamp.saturating_sub(last) as f64 / pace;
        let whole = exact.round();
        let unknown_s = JITTER_S + whole * known;
        if whole < 1.0 || unknown_s > SURE_S || (exact - whole).abs() > unknown_s {
            return false;
        }
        self.take(first, stamp, second + whole as u64, timer_hz);
        true
    }

    fn take(&mut self, first: u64, stamp: u64, second: u64, timer_hz: u32) {
        self.ends = Some((first, stamp, second));
        self.pulses += 1;
        if self.readings.len() == MOST {
            self.readings = self.readings.chunks(2).filter_map(mean).collect();
        }
        // In whole ticks: of a month a float would have lost some.
        let ticks = i128::from(stamp - first) - i128::from(second) * i128::from(timer_hz);
        self.readings.push(Reading {
            second: second as f64,
            ahead_s: ticks as f64 / f64::from(timer_hz),
            count: 1.0,
        });
    }

    fn ratio(&self, timer_hz: u32) -> Option<Measured> {
        if self.pulses < FEWEST as u64 {
            return None;
        }
        let tick_s = 1.0 / f64::from(timer_hz);
        let blocks = self.blocks();
        let line = if self.pulses >= FROM as u64 && blocks.len() >= FEWEST {
            line(&blocks, tick_s)
        } else {
            line(&self.readings, tick_s)
        }?;
        // A clock that drifts past the tick is rounded the same way for long: by a tick over all of it, evenly either way.
        let rounded = tick_s / 3.0_f64.sqrt() / self.seconds() as f64;
        Some(Measured {
            sd: line.sd.hypot(rounded),
            ..line
        })
    }

    /// The means of stretches of time.
    fn blocks(&self) -> Vec<Reading> {
        let length = self.seconds() as f64 / BLOCKS as f64;
        let block = |one: &Reading| ((one.second / length) as usize).min(BLOCKS - 1);
        let blocks = self.readings.chunk_by(|one, two| block(one) == block(two));
        blocks.filter_map(mean).collect()
    }
}

/// The mean of some, by their numbers; `None` of none.
fn mean(readings: &[Reading]) -> Option<Reading> {
    let count: f64 = readings.iter().map(|one| one.count).sum();
    let of = |value: fn(&Reading) -> f64| {
        let sum: f64 = readings.iter().map(|one| one.count * value(one)).sum();
        sum / count
    };
    (count > 0.0).then(|| Reading {
        second: of(|one| one.second),
        ahead_s: of(|one| one.ahead_s),
        count,
    })
}

/// Least squares, each reading by its number of pulses; `tick_s` is what a stamp is rounded to.
fn line(readings: &[Reading], tick_s: f64) -> Option<Measured> {
    let middle = mean(readings)?;
    let (mut square, mut product) = (0.0, 0.0);
    for one in readings {
        let time_s = one.second - middle.second;
        square += one.count * time_s.powi(2);
        product += one.count * time_s * (one.ahead_s - middle.ahead_s);
    }
    let slope = product / square;
    let freedom = readings.len() as f64 - 2.0;
    if !(square > 0.0 && freedom >= 1.0) {
        return None;
    }
    let off = |one: &Reading| one.ahead_s - middle.ahead_s - slope * (one.second - middle.second);
    let spread: f64 = readings
        .iter()
        .map(|one| one.count * off(one).powi(2))
        .sum();
    // No less than what rounding leaves of a single stamp.
    let variance = (spread / freedom).max(tick_s * tick_s / 12.0);
    Some(Measured {
        value: 1.0 + slope,
        sd: (variance / square).sqrt(),
        freedom,
    })
}

#[cfg(test)]
mod tests;
