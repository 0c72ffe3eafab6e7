//! Both ends of the link keep the same bins, whatever is flagged, missing or damaged.

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
