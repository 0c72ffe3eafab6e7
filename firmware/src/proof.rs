//! The bins that both ends of the link keep, and by which the host proves that nothing was lost.
//!
//! ```text
//!   conversion --> ProofBins of the board --> BinsMark in the health record --+
//!        |                                                                    +--> equal?
//!        +--> batch, frame, line, decoder --> ProofBins of the host ----------+
//! ```
//!
//! What enters, and where, stands here once, so that the two ends cannot disagree about it. The
//! board takes conversions one at a time and the host runs of them, which is quicker there; the
//! bins come out the same. The proof reaches from the word that was judged on the board to the
//! word that the host works with.

use core::ops::Range;

use inm_allan::BoardBins;
use inm_protocol::{AXES, Batch, BinsMark, Code, Flags};

/// Bins of X, Y and Z, begun at one conversion: 47 KiB.
///
/// A word without flags enters its axis at its index. Everything else is simply not there, and
/// the next good word finds how far the index has moved: a flagged word is a gap of its axis,
/// missing conversions are one of all three.
#[derive(Debug, Clone)]
pub struct ProofBins {
    epoch: u64,
    axes: [BoardBins; AXES],
}

impl ProofBins {
    /// Empty, to begin with conversion 0.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            epoch: 0,
            axes: [const { BoardBins::new() }; AXES],
        }
    }

    /// Begins anew with conversion `epoch`; those before it are passed over.
    pub fn begin(&mut self, epoch: u64) {
        self.epoch = epoch;
        for bins in &mut self.axes {
            // Stops at 2^63 conversions, which only a damaged number can name.
            bins.restart(epoch);
        }
    }

    /// Conversion with which the bins begin.
    #[must_use]
    pub fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Takes one conversion. Indices ascend.
    #[inline]
    pub fn conversion(&mut self, index: u64, codes: &[Code; AXES], flags: &[Flags; AXES]) {
        if index < self.epoch {
            return;
        }
        for ((bins, code), flags) in self.axes.iter_mut().zip(codes).zip(flags) {
            if flags.is_none() {
                pass_over(bins, index);
                bins.push(code.0);
            }
        }
    }

    /// Takes good words of one axis (0 to 2), the first of which has index `first`. Indices
    /// ascend.
    ///
    /// For hosts: needs about 100 KiB of stack.
    pub fn run(&mut self, axis: usize, first: u64, codes: &[i32]) {
        let early = self.epoch.saturating_sub(first);
        let codes = usize::try_from(early)
            .ok()
            .and_then(|early| codes.get(early..));
        if let (Some(bins), Some(codes @ [_, ..])) = (self.axes.get_mut(axis), codes) {
            pass_over(bins, first + early);
            bins.push_slice(codes);
        }
    }

    /// What the bins hold of the conversions before `index`, which come to none that was taken;
    /// `None` if they have not begun.
    #[must_use]
    pub fn mark(&mut self, index: u64) -> Option<BinsMark> {
        if index <= self.epoch {
            return None;
        }
        Some(BinsMark {
            epoch: self.epoch,
            index,
            digests: self.axes.each_mut().map(|bins| {
                pass_over(bins, index);
                bins.digest()
            }),
        })
    }
}

impl Default for ProofBins {
    fn default() -> Self {
        Self::new()
    }
}

/// Whatever lies between the last word and the one at `index` is missing.
#[inline]
fn pass_over(bins: &mut BoardBins, index: u64) {
    let missing = index.saturating_sub(bins.next_index());
    if missing > 0 {
        bins.skip(missing);
    }
}

/// The words of `axis` in `batch` that have no flag, as places in the batch.
pub fn good_runs(batch: &Batch, axis: u8) -> impl Iterator<Item = Range<usize>> {
    let len = batch.codes.len();
    let bad = batch.flags.iter();
    let bad = bad.filter(move |flag| flag.axis == axis && !flag.flags.is_none());
    let bad = bad.map(|flag| usize::from(flag.conversion)).chain([len]);
    bad.scan(0, move |begin, bad| {
        // The board lists its flags in order; in any other, a run comes out empty.
        let run = *begin..bad.min(len);
        *begin = bad + 1;
        Some(run)
    })
    .filter(|run| !run.is_empty())
}

#[cfg(test)]
mod tests {
    use inm_protocol::{BATCH_LEN, Flag};

    use super::*;

    const SEED: u64 = 5;

    struct Dice(u64);

    impl Dice {
        fn word(&mut self) -> u32 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 32) as u32
        }

        fn one_in(&mut self, n: u32) -> bool {
            self.word().is_multiple_of(n)
        }
    }

    /// A stream with flagged words and gaps, as batches.
    fn batches(count: usize) -> Vec<Batch> {
        let mut dice = Dice(SEED);
        let mut next = 0;
        let mut flagged = [false; AXES];
        (0..count)
            .map(|_| {
                if dice.one_in(10) {
                    next += u64::from(dice.word() % 300);
                }
                let mut batch = Batch {
                    first: next,
                    ..Batch::default()
                };
                let len = if dice.one_in(8) { 5 } else { BATCH_LEN };
                for conversion in 0..len as u8 {
                    let codes = [(); AXES].map(|()| Code(dice.word().cast_signed()));
                    batch.codes.push(codes).expect("room");
                    for axis in 0..AXES as u8 {
                        let flagged = &mut flagged[usize::from(axis)];
                        *flagged ^= dice.one_in(if *flagged { 5 } else { 200 });
                        if *flagged {
                            let flags = Flags::TORN;
                            let flag = Flag {
                                conversion,
                                axis,
                                flags,
                            };
                            batch.flags.push(flag).expect("room");
                        }
                    }
                }
                next = batch.end();
                batch
            })
            .collect()
    }

    fn take_conversions(bins: &mut ProofBins, batch: &Batch) {
        for (place, codes) in (0_u8..).zip(&batch.codes) {
            let mut flags = [Flags::NONE; AXES];
            for flag in batch.flags.iter().filter(|flag| flag.conversion == place) {
                flags[usize::from(flag.axis)] = flag.flags;
            }
            bins.conversion(batch.first + u64::from(place), codes, &flags);
        }
    }

    fn take_runs(bins: &mut ProofBins, batch: &Batch) {
        for axis in 0..AXES {
            let codes: Vec<i32> = batch.codes.iter().map(|codes| codes[axis].0).collect();
            for run in good_runs(batch, axis as u8) {
                bins.run(axis, batch.first + run.start as u64, &codes[run]);
            }
        }
    }

    #[test]
    fn conversions_and_runs_and_any_marks_between_come_out_the_same() {
        let mut board = ProofBins::new();
        let mut host = ProofBins::new();
        for (i, batch) in batches(2000).iter().enumerate() {
            take_conversions(&mut board, batch);
            take_runs(&mut host, batch);
            // The board marks more often than the host: health records may be lost.
            let told = i.is_multiple_of(7).then(|| board.mark(batch.end()));
            if i.is_multiple_of(21) {
                assert_eq!(told, Some(host.mark(batch.end())), "batch {i}, seed {SEED}");
                assert!(told.flatten().is_some(), "batch {i}");
            }
        }
    }

    #[test]
    fn bins_begun_later_hold_what_came_since() {
        let batches = batches(400);
        let epoch = batches[150].first + 3;
        let mut board = ProofBins::new();
        board.begin(epoch);
        let mut host = ProofBins::new();
        for batch in &batches[..100] {
            take_runs(&mut host, batch);
            take_conversions(&mut board, batch);
        }
        assert_eq!(board.mark(batches[99].end()), None, "not begun");
        host.begin(epoch);
        // The host may have missed anything before the beginning.
        batches[150..]
            .iter()
            .for_each(|batch| take_runs(&mut host, batch));
        batches[100..]
            .iter()
            .for_each(|batch| take_conversions(&mut board, batch));
        let end = batches[399].end();
        let mark = board.mark(end).expect("begun");
        assert_eq!((mark.epoch, mark.index), (epoch, end));
        assert_eq!(host.mark(end), Some(mark), "seed {SEED}");
    }

    #[test]
    fn one_bit_and_one_flag_show_on_their_axis() {
        let batches = batches(50);
        let digests = |batches: &[Batch]| {
            let mut bins = ProofBins::new();
            batches
                .iter()
                .for_each(|batch| take_conversions(&mut bins, batch));
            bins.mark(batches[49].end()).expect("begun").digests
        };
        let true_ones = digests(&batches);
        let place = batches[20]
            .codes
            .iter()
            .zip(0_u8..)
            .position(|(_, place)| {
                batches[20]
                    .flags
                    .iter()
                    .all(|flag| flag.conversion != place)
            })
            .expect("a conversion with three good words");
        for axis in 0..AXES {
            let mut wrong = batches.clone();
            wrong[20].codes[place][axis].0 ^= 1;
            let mut flagged = batches.clone();
            flagged[20]
                .flags
                .insert(
                    0,
                    Flag {
                        conversion: place as u8,
                        axis: axis as u8,
                        flags: Flags::STUCK,
                    },
                )
                .expect("room");
            for damaged in [wrong, flagged] {
                let found = digests(&damaged);
                for other in 0..AXES {
                    assert_eq!(found[other] == true_ones[other], other != axis);
                }
            }
        }
    }

    #[test]
    fn flags_from_the_wire_may_be_anything() {
        let mut batch = batches(1).remove(0);
        batch.flags.clear();
        for (conversion, axis) in [(9, 0), (4, 0), (200, 0), (2, 77)] {
            let flags = Flags::TORN;
            batch
                .flags
                .push(Flag {
                    conversion,
                    axis,
                    flags,
                })
                .expect("room");
        }
        let runs: Vec<_> = good_runs(&batch, 0).collect();
        assert!(
            runs.iter()
                .all(|run| run.start < run.end && run.end <= batch.codes.len())
        );
    }
}
