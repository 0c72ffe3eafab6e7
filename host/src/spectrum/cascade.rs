//! The cascade of one axis: each level sums the power of its segments and feeds the next through
//! the decimator.
//!
//! Memory is a few tens of kilobytes a level, and there are as many levels as the record's length
//! has factors of eight: it does not grow otherwise.

#[cfg(test)]
mod tests;

use super::{
    decimate::{Decimator, FACTOR},
    history::{History, SlowRun},
    segments::{Pair, PairSink, Plan, Power, Segments},
};

/// Samples handed to the levels at once: few enough to stay in the processor's first cache.
const CHUNK: usize = 2048;

/// Samples that come out of order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("sample {first} comes after sample {next} was due; indices must not go back")]
pub struct OutOfOrder {
    /// Index of the first sample of the block.
    pub first: u64,
    /// The lowest index that would have been right.
    pub next: u64,
}

/// One level: segments, what feeds the next level, and the samples while they are few.
#[derive(Debug, Clone)]
pub(super) struct Level {
    segments: Segments,
    decimator: Decimator,
    pub(super) history: History,
    output: Vec<f64>,
}

impl Level {
    fn new(level: usize, plan: &Plan) -> Self {
        Self {
            segments: Segments::new(level, plan),
            decimator: Decimator::default(),
            history: History::default(),
            output: Vec::new(),
        }
    }

    /// Power sums up to now.
    pub(super) fn power(&self) -> Power {
        self.segments.power()
    }
}

/// Streaming spectrum of one axis.
///
/// Values are taken relative to the first good sample, so that a large offset (gravity) costs no
/// accuracy. A jump of the index is a gap, and so is a value that is not finite.
#[derive(Debug, Clone)]
pub struct Cascade {
    plan: Plan,
    levels: Vec<Level>,
    next: u64,
    samples: u64,
    running: bool,
    reference: Option<f64>,
    chunk: Vec<f64>,
}

impl Default for Cascade {
    fn default() -> Self {
        Self::new(&Plan::new())
    }
}

impl Cascade {
    /// An empty cascade; `plan` may be shared between axes.
    pub fn new(plan: &Plan) -> Self {
        Self {
            plan: plan.clone(),
            levels: vec![Level::new(0, plan)],
            next: 0,
            samples: 0,
            running: false,
            reference: None,
            chunk: Vec::with_capacity(CHUNK),
        }
    }

    /// Good samples taken.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Index that follows the last sample.
    pub fn next_index(&self) -> u64 {
        self.next
    }

    /// The first good sample, which all others were taken relative to.
    pub fn reference(&self) -> Option<f64> {
        self.reference
    }

    /// The whole record at the fastest rate at which it fits into
    /// [`history::CAPACITY`](super::history::CAPACITY) samples: how many times slower
    /// that is than the samples, and the gap-free runs, less the shortest ones.
    ///
    /// `None` where gaps leave nothing at such a rate.
    pub fn slow(&self) -> Option<(u64, &[SlowRun])> {
        self.levels
            .iter()
            .enumerate()
            .find_map(|(level, one)| Some((FACTOR.pow(level as u32), one.history.runs()?)))
    }

    pub(super) fn levels(&self) -> &[Level] {
        &self.levels
    }

    pub(super) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Takes consecutive codes; `first` is the absolute index of the first.
    ///
    /// # Errors
    /// [`OutOfOrder`] if `first` lies before the end of an earlier block; nothing is taken.
    pub fn push_codes(&mut self, first: u64, codes: &[i32]) -> Result<(), OutOfOrder> {
        self.push_any(first, codes, f64::from, true, &mut ())
    }

    /// Takes consecutive values; `first` is the absolute index of the first. Values that are not
    /// finite are gaps.
    ///
    /// # Errors
    /// [`OutOfOrder`] if `first` lies before the end of an earlier block; nothing is taken.
    pub fn push_values(&mut self, first: u64, values: &[f64]) -> Result<(), OutOfOrder> {
        self.push_with(first, values, |value| value, &mut ())
    }

    /// As [`Self::push_values`], for any type of sample, handing every transform to `sink`.
    ///
    /// # Errors
    /// [`OutOfOrder`] if `first` lies before the end of an earlier block; nothing is taken.
    pub fn push_with<T: Copy>(
        &mut self,
        first: u64,
        samples: &[T],
        to_f64: impl Fn(T) -> f64,
        sink: &mut impl PairSink,
    ) -> Result<(), OutOfOrder> {
        self.push_any(first, samples, to_f64, false, sink)
    }

    /// `finite` promises that all samples are.
    fn push_any<T: Copy>(
        &mut self,
        first: u64,
        samples: &[T],
        to_f64: impl Fn(T) -> f64,
        finite: bool,
        sink: &mut impl PairSink,
    ) -> Result<(), OutOfOrder> {
        if first < self.next {
            return Err(OutOfOrder {
                first,
                next: self.next,
            });
        }
        let mut index = first;
        for piece in samples.chunks(CHUNK) {
            let mut chunk = std::mem::take(&mut self.chunk);
            chunk.clear();
            let reference = self.reference.unwrap_or_else(|| {
                piece
                    .iter()
                    .map(|&x| to_f64(x))
                    .find(|x| x.is_finite())
                    .unwrap_or(0.0)
            });
            chunk.extend(piece.iter().map(|&x| to_f64(x) - reference));
            // Counted rather than searched: without an early end the loop can be vectorised.
            let bad = |chunk: &[f64]| chunk.iter().map(|x| u64::from(!x.is_finite())).sum::<u64>();
            if finite || bad(&chunk) == 0 {
                self.run(index, &chunk, reference, sink);
            } else {
                let mut at = index;
                for run in chunk.split_inclusive(|x| !x.is_finite()) {
                    let good = run.len() - usize::from(run.last().is_some_and(|x| !x.is_finite()));
                    self.run(at, &run[..good], reference, sink);
                    at += run.len() as u64;
                    if good < run.len() && self.running {
                        self.finish(sink);
                    }
                }
            }
            self.chunk = chunk;
            index += piece.len() as u64;
        }
        Ok(())
    }

    /// Reports that samples up to `next` are missing or that the record ends here: what waited for
    /// them is concluded.
    pub fn finish(&mut self, sink: &mut impl PairSink) {
        for level in &mut self.levels {
            level.segments.finish_run(sink);
            level.decimator.reset();
            level.history.finish_run();
        }
        self.running = false;
    }

    fn run(&mut self, first: u64, samples: &[f64], reference: f64, sink: &mut impl PairSink) {
        if samples.is_empty() {
            return;
        }
        if self.running && first != self.next {
            self.finish(sink);
        }
        self.running = true;
        self.reference = Some(reference);
        self.next = first + samples.len() as u64;
        self.samples += samples.len() as u64;
        let mut input = std::mem::take(&mut self.levels[0].output);
        input.clear();
        input.extend_from_slice(samples);
        let mut at = first;
        let mut depth = 0;
        loop {
            let level = &mut self.levels[depth];
            level.segments.push(at, &input, sink);
            level.history.push(at, &input);
            let mut output = std::mem::take(&mut level.output);
            at = level
                .decimator
                .process(self.plan.arch(), at, &input, &mut output);
            level.output = std::mem::replace(&mut input, output);
            if input.is_empty() {
                break;
            }
            depth += 1;
            if depth == self.levels.len() {
                self.levels.push(Level::new(depth, &self.plan));
            }
        }
    }
}

/// A closure over pairs is a sink.
impl<F: FnMut(Pair<'_>)> PairSink for F {
    fn pair(&mut self, pair: Pair<'_>) {
        self(pair);
    }
}
