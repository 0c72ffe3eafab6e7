//! A record without some stretches of its time.

use std::ops::Range;

use super::audit::Proof;
use super::{Block, Chunk, Source, SourceError};
use crate::clocks::Clocks;
use crate::signal::Signal;

/// A source whose samples in given stretches must not be used.
pub struct Excluding {
    inner: Box<dyn Source>,
    /// By index, ascending, none of them touching another.
    stretches: Vec<Range<u64>>,
}

impl Excluding {
    /// All of `inner` but these stretches, seconds since its start.
    pub fn new(inner: Box<dyn Source>, stretches_s: &[Range<f64>]) -> Self {
        let rate_hz = inner.signal().rate_hz;
        let index = |time_s: f64| (time_s * rate_hz).ceil() as u64;
        let all = stretches_s
            .iter()
            .map(|one| index(one.start)..index(one.end));
        Self {
            stretches: joined(all.collect()),
            inner,
        }
    }

    fn spoil(&self, block: &mut Block) {
        let (first, end) = (block.first, block.end());
        let inside = self.stretches.iter().filter_map(|one| {
            let (from, to) = (one.start.max(first), one.end.min(end));
            (from < to).then(|| (from - first) as usize..(to - first) as usize)
        });
        let inside: Vec<Range<usize>> = inside.collect();
        if inside.is_empty() {
            return;
        }
        for column in &mut block.columns {
            let all = column.invalid.drain(..).chain(inside.iter().cloned());
            column.invalid = joined(all.collect());
        }
    }
}

/// The same stretches, ascending; those that touch are one.
fn joined<T: Ord + Copy>(mut stretches: Vec<Range<T>>) -> Vec<Range<T>> {
    stretches.sort_by_key(|one| one.start);
    let mut joined: Vec<Range<T>> = Vec::with_capacity(stretches.len());
    for one in stretches {
        match joined.last_mut() {
            Some(last) if one.start <= last.end => last.end = last.end.max(one.end),
            _ => joined.push(one),
        }
    }
    joined
}

impl Source for Excluding {
    fn signal(&self) -> &Signal {
        self.inner.signal()
    }

    fn proof(&self) -> Option<Proof> {
        self.inner.proof()
    }

    fn clocks(&self) -> Option<Clocks> {
        self.inner.clocks()
    }

    fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError> {
        let mut chunk = self.inner.next_chunk()?;
        if let Some(Chunk::Samples(block)) = &mut chunk {
            self.spoil(block);
        }
        Ok(chunk)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Axis, Unit};
    use crate::source::{Column, Values};

    struct Twice(Signal, u64);

    impl Source for Twice {
        fn signal(&self) -> &Signal {
            &self.0
        }

        fn proof(&self) -> Option<Proof> {
            None
        }

        /// Two blocks of ten samples, of which the fourth is bad.
        fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError> {
            let first = self.1;
            self.1 += 10;
            let column = Column {
                values: Values::Codes(vec![1; 10]),
                invalid: [3..4].into(),
            };
            let block = Block {
                first,
                columns: vec![column],
            };
            Ok((first < 20).then_some(Chunk::Samples(block)))
        }
    }

    #[test]
    fn stretches_are_bad_samples_of_every_block_that_they_reach() {
        let signal = Signal {
            name: "record".to_owned(),
            rate_hz: 10.0,
            axes: vec![Axis {
                name: "X".to_owned(),
                unit: Unit::Counts,
                scale: 1.0,
                zero: 0.0,
                chain: None,
            }],
            start: None,
        };
        // The last two touch; a stretch begins at the first sample at or after its time.
        let stretches = [1.75..9.0, 0.05..0.15, 0.4..0.6, 0.55..0.7];
        let mut source = Excluding::new(Box::new(Twice(signal, 0)), &stretches);
        let mut invalid = Vec::new();
        while let Some(Chunk::Samples(block)) = source.next_chunk().expect("no error") {
            invalid.push(block.columns[0].invalid.clone());
        }
        assert_eq!(invalid, [vec![1..2, 3..7], vec![3..4, 8..10]]);
    }
}
