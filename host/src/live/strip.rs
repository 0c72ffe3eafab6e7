//! The last seconds of the signal, thin enough to be drawn: least and largest sample of each stretch.

use std::collections::VecDeque;

use crate::signal::{Axis, Signal};
use crate::source::{Block, Column, Values};

/// Seconds that are kept: long enough to see a step or someone walking by, short enough that one sample
/// that leaves the others still shows.
const KEPT_S: f64 = 30.0;

/// Stretches that they are kept in: about one a pixel of a picture. With three axes that is 30 kB.
const STRETCHES: usize = 600;

/// See above.
#[derive(Debug, Clone, Default)]
pub struct Strip {
    axes: Vec<Axis>,
    rate_hz: f64,
    stretches: VecDeque<Stretch>,
}

/// Consecutive samples: their number counts from the beginning of the record.
#[derive(Debug, Clone)]
struct Stretch {
    number: u64,
    /// Least and largest value of each axis that counts, in its unit.
    ends: Vec<Option<(f64, f64)>>,
}

impl Strip {
    /// An empty strip of a record described by `signal`.
    pub fn new(signal: &Signal) -> Self {
        Self {
            axes: signal.axes.clone(),
            rate_hz: signal.rate_hz,
            stretches: VecDeque::with_capacity(STRETCHES),
        }
    }

    /// The axes of the record.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Takes the next samples. A count that begins anew begins an empty strip.
    pub fn push(&mut self, block: &Block) {
        let length = self.length();
        let first = block.first / length;
        if self
            .stretches
            .back()
            .is_some_and(|last| last.number > first)
        {
            self.stretches.clear();
        }
        for (axis, column) in block.columns.iter().enumerate() {
            let mut bad = column.invalid.iter().peekable();
            for at in 0..column.values.len() {
                while bad.next_if(|range| range.end <= at).is_some() {}
                if bad.peek().is_some_and(|range| range.start <= at) {
                    continue;
                }
                let value = self.value(axis, column, at);
                self.enter((block.first + at as u64) / length, axis, value);
            }
        }
    }

    /// Time since the beginning of the record, seconds, and least and largest value of an axis about then,
    /// oldest first.
    pub fn points(&self, axis: usize) -> Vec<(f64, f64, f64)> {
        let stretch_s = self.length() as f64 / self.rate_hz;
        let points = self.stretches.iter().filter_map(|stretch| {
            let (least, most) = (*stretch.ends.get(axis)?)?;
            Some((stretch.number as f64 * stretch_s, least, most))
        });
        points.collect()
    }

    /// Samples in a stretch.
    fn length(&self) -> u64 {
        (KEPT_S * self.rate_hz / STRETCHES as f64).ceil().max(1.0) as u64
    }

    fn value(&self, axis: usize, column: &Column, at: usize) -> f64 {
        let Axis { scale, zero, .. } = self.axes[axis];
        let raw = match &column.values {
            Values::Codes(codes) => f64::from(codes[at]),
            Values::Floats(floats) => floats[at],
        };
        scale * (raw - zero)
    }

    fn enter(&mut self, number: u64, axis: usize, value: f64) {
        let found = self
            .stretches
            .iter_mut()
            .rev()
            .find(|one| one.number <= number);
        let found = found.filter(|one| one.number == number);
        let stretch = match found {
            Some(stretch) => stretch,
            None => self.begin(number),
        };
        let (least, most) = stretch.ends[axis].unwrap_or((value, value));
        stretch.ends[axis] = Some((least.min(value), most.max(value)));
    }

    fn begin(&mut self, number: u64) -> &mut Stretch {
        while self
            .stretches
            .front()
            .is_some_and(|one| one.number + STRETCHES as u64 <= number)
        {
            self.stretches.pop_front();
        }
        self.stretches.push_back(Stretch {
            number,
            ends: vec![None; self.axes.len()],
        });
        let last = self.stretches.len() - 1;
        &mut self.stretches[last]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Unit;

    fn strip(rate_hz: f64) -> Strip {
        let axis = Axis {
            name: "X".into(),
            unit: Unit::Volt,
            scale: 0.5,
            zero: 2.0,
            chain: None,
        };
        Strip::new(&Signal {
            name: "test".into(),
            rate_hz,
            axes: vec![axis],
            start: None,
        })
    }

    fn block(first: u64, codes: Vec<i32>, invalid: Vec<std::ops::Range<usize>>) -> Block {
        let values = Values::Codes(codes);
        Block {
            first,
            columns: vec![Column { values, invalid }],
        }
    }

    #[test]
    fn a_stretch_has_its_least_and_largest_sample_in_the_unit_of_the_axis() {
        // Sixty samples a second make three a stretch.
        let mut strip = strip(60.0);
        strip.push(&block(0, vec![2, 4, 6, 100, 8, 10, 200], vec![3..4, 6..7]));
        assert_eq!(strip.points(0), [(0.0, 0.0, 2.0), (0.05, 3.0, 4.0)]);
    }

    #[test]
    fn no_more_than_the_last_seconds_are_kept() {
        let mut strip = strip(20.0);
        for first in 0..5000 {
            strip.push(&block(first, vec![2], vec![]));
        }
        let points = strip.points(0);
        assert_eq!(points.len(), STRETCHES);
        assert_eq!(points[STRETCHES - 1].0, 4999.0 * (1.0 / 20.0));
        // Behind a gap, however long, only what is young enough.
        strip.push(&block(5300, vec![2], vec![]));
        assert_eq!(strip.points(0).len(), 300);
        strip.push(&block(1 << 60, vec![2], vec![]));
        assert_eq!(strip.points(0).len(), 1);
        strip.push(&block(0, vec![2], vec![]));
        assert_eq!(strip.points(0).len(), 1);
    }
}
