//! A part of a record: some of its axes, some of its time.

use std::ops::Range;

use super::audit::Proof;
use super::options::Selector;
use super::{Block, Chunk, Column, Gap, Source, SourceError, Values};
use crate::clocks::Clocks;
use crate::signal::Signal;

/// The samples of `inner` within a range of its index, counted from the start of the range,
/// on chosen axes.
pub struct Part<S> {
    inner: S,
    signal: Signal,
    axes: Vec<usize>,
    range: Range<u64>,
    ended: bool,
}

impl<S: Source> Part<S> {
    /// The axes named in `axes` (all if there is none), from `from_s` up to `to_s` seconds.
    ///
    /// # Errors
    /// If an axis is not there, or the times leave nothing.
    pub fn new(
        inner: S,
        axes: &[Selector],
        from_s: Option<f64>,
        to_s: Option<f64>,
    ) -> Result<Self, SourceError> {
        let whole = inner.signal();
        let bad = |message: String, remedy: &str| SourceError {
            place: whole.name.clone(),
            message,
            remedy: remedy.to_owned(),
        };
        let find = |selector: &Selector| {
            let place = match selector {
                Selector::Number(number) => Some(*number).filter(|&n| n < whole.axes.len()),
                Selector::Name(name) => whole.axes.iter().position(|axis| axis.name == *name),
            };
            place.ok_or_else(|| {
                let names: Vec<&str> = whole.axes.iter().map(|axis| axis.name.as_str()).collect();
                bad(
                    format!(
                        "there is no axis `{selector}`; the axes are {}",
                        names.join(", ")
                    ),
                    "name them, or number them from 0",
                )
            })
        };
        let axes: Vec<usize> = if axes.is_empty() {
            (0..whole.axes.len()).collect()
        } else {
            axes.iter().map(find).collect::<Result<_, _>>()?
        };
        let index = |seconds: f64| (seconds * whole.rate_hz).round().max(0.0) as u64;
        let range = from_s.map_or(0, index)..to_s.map_or(u64::MAX, index);
        if range.is_empty() {
            return Err(bad("no sample lies between --from and --to".to_owned(), ""));
        }
        let signal = Signal {
            axes: axes.iter().map(|&axis| whole.axes[axis].clone()).collect(),
            ..whole.clone()
        };
        Ok(Self {
            inner,
            signal,
            axes,
            range,
            ended: false,
        })
    }

    fn cut_block(&self, block: &Block) -> Option<Block> {
        let first = block.first.max(self.range.start);
        let end = block.end().min(self.range.end);
        if first >= end {
            return None;
        }
        let inside = (first - block.first) as usize..(end - block.first) as usize;
        let columns = self
            .axes
            .iter()
            .map(|&axis| cut_column(&block.columns[axis], &inside));
        Some(Block {
            first: first - self.range.start,
            columns: columns.collect(),
        })
    }

    fn cut_gap(&self, gap: Gap) -> Option<Gap> {
        let from = gap.from.max(self.range.start);
        let to = gap.to.map(|to| to.min(self.range.end));
        if from >= self.range.end || to.is_some_and(|to| to <= from) {
            return None;
        }
        Some(Gap {
            from: from - self.range.start,
            to: to.map(|to| to - self.range.start),
            cause: gap.cause,
        })
    }
}

impl<S: Source> Source for Part<S> {
    fn signal(&self) -> &Signal {
        &self.signal
    }

    fn proof(&self) -> Option<Proof> {
        self.inner.proof()
    }

    fn clocks(&self) -> Option<Clocks> {
        self.inner.clocks()
    }

    fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError> {
        while !self.ended {
            let kept = match self.inner.next_chunk()? {
                None => return Ok(None),
                Some(Chunk::Samples(block)) => {
                    self.ended = block.end() >= self.range.end;
                    self.cut_block(&block).map(Chunk::Samples)
                }
                Some(Chunk::Gap(gap)) => self.cut_gap(gap).map(Chunk::Gap),
                Some(news @ Chunk::News(_)) => Some(news),
            };
            if kept.is_some() {
                return Ok(kept);
            }
        }
        Ok(None)
    }
}

fn cut_column(column: &Column, inside: &Range<usize>) -> Column {
    let values = match &column.values {
        Values::Codes(codes) => Values::Codes(codes[inside.clone()].to_vec()),
        Values::Floats(floats) => Values::Floats(floats[inside.clone()].to_vec()),
    };
    let shift = |bad: &Range<usize>| {
        bad.start.max(inside.start).saturating_sub(inside.start)
            ..bad.end.min(inside.end).saturating_sub(inside.start)
    };
    let invalid = column
        .invalid
        .iter()
        .map(shift)
        .filter(|bad| !bad.is_empty())
        .collect();
    Column { values, invalid }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Axis, Unit};

    struct Blocks(Signal, Vec<Chunk>);

    impl Source for Blocks {
        fn signal(&self) -> &Signal {
            &self.0
        }

        fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError> {
            Ok((!self.1.is_empty()).then(|| self.1.remove(0)))
        }
    }

    fn record() -> Blocks {
        let axis = |name: &str| Axis {
            name: name.to_owned(),
            unit: Unit::Counts,
            scale: 1.0,
            zero: 0.0,
            chain: None,
        };
        let signal = Signal {
            name: "record".to_owned(),
            rate_hz: 10.0,
            axes: vec![axis("X"), axis("Y")],
            start: None,
        };
        let block = |first: i32| {
            let column = |sign: i32, invalid: Vec<Range<usize>>| Column {
                values: Values::Codes((first..first + 10).map(|code| sign * code).collect()),
                invalid,
            };
            Chunk::Samples(Block {
                first: first as u64,
                columns: vec![column(1, vec![]), column(-1, [2..6].into())],
            })
        };
        let gap = Chunk::Gap(Gap {
            from: 10,
            to: Some(20),
            cause: "test".to_owned(),
        });
        Blocks(signal, vec![block(0), gap, block(20), block(30)])
    }

    fn read(mut source: impl Source) -> Vec<Chunk> {
        std::iter::from_fn(|| source.next_chunk().expect("no error")).collect()
    }

    #[test]
    fn time_and_axes_are_cut() {
        let axes = [Selector::Name("Y".to_owned())];
        let part = Part::new(record(), &axes, Some(0.4), Some(2.3)).expect("a part");
        assert_eq!(part.signal().axes.len(), 1);
        let block = |first, codes: Vec<i32>, invalid: Vec<Range<usize>>| {
            let columns = vec![Column {
                values: Values::Codes(codes),
                invalid,
            }];
            Chunk::Samples(Block { first, columns })
        };
        let gap = Chunk::Gap(Gap {
            from: 6,
            to: Some(16),
            cause: "test".to_owned(),
        });
        let expected = vec![
            block(0, vec![-4, -5, -6, -7, -8, -9], [0..2].into()),
            gap,
            block(16, vec![-20, -21, -22], [2..3].into()),
        ];
        assert_eq!(read(part), expected);
    }

    #[test]
    fn nothing_left_is_an_error() {
        assert!(Part::new(record(), &[], Some(2.0), Some(1.0)).is_err());
        let missing = [Selector::Number(2)];
        let error = Part::new(record(), &missing, None, None)
            .err()
            .expect("no third axis");
        assert!(error.to_string().contains("X, Y"), "{error}");
    }
}
