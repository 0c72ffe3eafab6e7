use inm_protocol::{Code, Flag, Flags, Trouble};

use super::super::Values;
use super::ranges::{mark, split_ranges};
use super::*;

/// Stamp of conversion 0, and ticks of a data period.
const BOOT: u64 = 700_000;
const TICKS: u64 = 500;

fn batch(seq: u32, first: u64, len: usize) -> Batch {
    let codes = (0..len)
        .map(|i| [Code((first as usize + i) as i32); AXES])
        .collect();
    Batch {
        seq,
        first,
        stamp: BOOT + TICKS * first,
        codes,
        ..Batch::default()
    }
}

/// The same batch of a numbered stream.
fn of(stream: u16, batch: Batch) -> Batch {
    Batch { stream, ..batch }
}

fn notice(stream: u16, index: u64) -> Event {
    Event {
        index,
        axis: Some(2),
        trouble: Trouble::Stalled,
        stream,
    }
}

fn run(batches: &[Batch]) -> (Vec<Chunk>, Losses) {
    let mut assembler = Assembler::default();
    for batch in batches {
        if assembler.leaves_out(batch) {
            continue;
        }
        assembler.push(batch);
        assembler.flush();
    }
    assembler.finish();
    let chunks = std::iter::from_fn(|| assembler.pop()).collect();
    (chunks, assembler.losses())
}

fn codes(chunk: &Chunk) -> (u64, Vec<i32>) {
    match chunk {
        Chunk::Samples(block) => match &block.columns[0].values {
            Values::Codes(codes) => (block.first, codes.clone()),
            Values::Floats(_) => panic!("codes stay codes"),
        },
        other => panic!("samples expected, got {other:?}"),
    }
}

#[test]
fn contiguous_batches_lose_nothing() {
    let (chunks, losses) = run(&[batch(0, 0, 32), batch(1, 32, 32), batch(2, 64, 7)]);
    let all: Vec<i32> = chunks.iter().flat_map(|c| codes(c).1).collect();
    assert_eq!(all, (0..71).collect::<Vec<_>>());
    assert_eq!(losses, Losses::default());
}

#[test]
fn a_lost_batch_is_a_gap_of_its_length() {
    let (chunks, losses) = run(&[batch(0, 0, 32), batch(2, 64, 32)]);
    let gap = Gap {
        from: 32,
        to: Some(64),
        cause: "1 batch was lost on the link".into(),
    };
    assert!(chunks.contains(&Chunk::Gap(gap)), "{chunks:?}");
    assert_eq!(
        (losses.lost_samples, losses.lost_batches, losses.gaps),
        (32, 1, 1)
    );
    assert_eq!(codes(chunks.last().expect("samples after the gap")).0, 64);
}

#[test]
fn a_restart_of_the_count_is_a_gap_of_unknown_length() {
    let again = Batch {
        stamp: 3 * BOOT,
        ..batch(0, 0, 32)
    };
    let (chunks, losses) = run(&[batch(0, 0, 32), again]);
    assert!(
        matches!(
            &chunks[1],
            Chunk::Gap(Gap {
                from: 32,
                to: None,
                ..
            })
        ),
        "{chunks:?}"
    );
    assert_eq!(
        codes(&chunks[2]).0,
        33,
        "the count goes on, one place left open"
    );
    assert_eq!(losses.restarts, 1);
}

#[test]
fn a_clipped_word_is_marked_with_what_rings_around_it() {
    let mut clipped = batch(1, 32, 32);
    let flag = Flag {
        conversion: 2,
        axis: 1,
        flags: Flags::OVER_RANGE,
    };
    clipped.flags.push(flag).expect("room");
    let (chunks, losses) = run(&[batch(0, 0, 32), clipped, batch(2, 64, 32), batch(3, 96, 32)]);
    let mut marked: Vec<u64> = Vec::new();
    for chunk in &chunks {
        if let Chunk::Samples(block) = chunk {
            assert!(block.columns[0].invalid.is_empty());
            let ranges = block.columns[1].invalid.iter().cloned().flatten();
            marked.extend(ranges.map(|i| block.first + i as u64));
        }
    }
    assert_eq!(marked, (34 - 31..=34 + 62).collect::<Vec<u64>>());
    assert_eq!(losses.flagged, [0, 1, 0]);
}

#[test]
fn a_fault_spoils_what_came_before_its_notice() {
    let mut assembler = Assembler::default();
    for seq in 0..40 {
        assembler.push(&batch(seq, 32 * u64::from(seq), 32));
        assembler.flush();
        if seq == 30 {
            // The notice overtakes the batch that holds its conversion.
            assembler.spoil(2, &notice(0, 1000), 500);
        }
    }
    assembler.finish();
    let mut spoilt = Vec::new();
    while let Some(Chunk::Samples(block)) = assembler.pop() {
        assert!(block.columns[0].invalid.is_empty());
        let ranges = block.columns[2].invalid.iter().cloned().flatten();
        spoilt.extend(ranges.map(|i| block.first + i as u64));
    }
    assert_eq!(spoilt, (500..1000).collect::<Vec<u64>>());
}

/// Samples of axis 2 that must not be used.
fn spoilt(assembler: &mut Assembler) -> Vec<u64> {
    let mut spoilt = Vec::new();
    while let Some(chunk) = assembler.pop() {
        if let Chunk::Samples(block) = chunk {
            assert!(block.columns[0].invalid.is_empty());
            let ranges = block.columns[2].invalid.iter().cloned().flatten();
            spoilt.extend(ranges.map(|i| block.first + i as u64));
        }
    }
    spoilt
}

#[test]
fn a_notice_behind_a_gap_spoils_what_was_before_it() {
    let mut assembler = Assembler::default();
    for seq in [0, 1, 2, 3, 4, 6, 7] {
        assembler.push(&batch(seq, 32 * u64::from(seq), 32));
        assembler.flush();
    }
    assembler.spoil(2, &notice(0, 240), 128);
    assembler.finish();
    let expected: Vec<u64> = (112..160).chain(192..240).collect();
    assert_eq!(spoilt(&mut assembler), expected);
}

#[test]
fn a_notice_that_was_lost_spoils_all_since_the_last_confirmation() {
    let mut assembler = Assembler::default();
    for seq in 0..40 {
        assembler.push(&batch(seq, 32 * u64::from(seq), 32));
        assembler.flush();
        if seq == 19 {
            assembler.confirm(0, 640, false);
        }
    }
    assembler.miss_notice([false, false, true]);
    assembler.confirm(0, 1280, true);
    assembler.finish();
    let from = 640 - SLIP_NOTICE;
    assert_eq!(spoilt(&mut assembler), (from..1280).collect::<Vec<_>>());
}

/// A board that confirms what it says is taken at its word: no confirmation, no trust.
#[test]
fn an_end_that_the_board_has_not_confirmed_is_spoilt() {
    let mut assembler = Assembler::default();
    for seq in 0..20 {
        assembler.push(&batch(seq, 32 * u64::from(seq), 32));
        if seq == 18 {
            assembler.confirm(0, 608, false);
        }
    }
    assembler.finish();
    let mut spoilt = Vec::new();
    while let Some(Chunk::Samples(block)) = assembler.pop() {
        let ranges = block.columns[0].invalid.iter().cloned().flatten();
        spoilt.extend(ranges.map(|i| block.first + i as u64));
    }
    assert_eq!(spoilt, (608 - SLIP_NOTICE..640).collect::<Vec<_>>());
}

#[test]
fn marks_merge_and_split() {
    let mut ranges = vec![0..2, 5..6, 9..12];
    mark(&mut ranges, 2..5);
    assert_eq!(ranges, [0..6, 9..12]);
    mark(&mut ranges, 7..8);
    assert_eq!(ranges, [0..6, 7..8, 9..12]);
    assert_eq!(split_ranges(&mut ranges, 10), [0..6, 7..8, 9..10]);
    assert_eq!(ranges, [0..2]);
}

fn received(chunks: &[Chunk]) -> Vec<(u64, i32)> {
    let blocks = chunks
        .iter()
        .filter(|chunk| matches!(chunk, Chunk::Samples(_)));
    let samples = blocks.flat_map(|chunk| {
        let (first, codes) = codes(chunk);
        (first..).zip(codes).collect::<Vec<_>>()
    });
    samples.collect()
}

#[test]
fn frames_that_come_twice_are_taken_once() {
    let ahead = [batch(0, 0, 32), batch(1, 32, 32), batch(2, 64, 32)];
    for again in &ahead {
        let mut all = ahead.to_vec();
        all.extend([again.clone(), batch(3, 96, 32)]);
        let (chunks, losses) = run(&all);
        let expected: Vec<(u64, i32)> = (0..128).map(|i| (i, i as i32)).collect();
        assert_eq!(received(&chunks), expected);
        assert_eq!((losses.left_out, losses.gaps), (1, 0));
    }
}

#[test]
fn frames_that_change_places_are_missing_and_never_at_a_wrong_place() {
    let swapped = [
        batch(0, 0, 32),
        batch(1, 32, 32),
        batch(3, 96, 32),
        batch(2, 64, 32),
        batch(4, 128, 32),
    ];
    let (chunks, losses) = run(&swapped);
    let good = (0..64).chain(96..160);
    let expected: Vec<(u64, i32)> = good.map(|i| (i, i as i32)).collect();
    assert_eq!(received(&chunks), expected);
    assert_eq!((losses.left_out, losses.lost_samples), (1, 32));
}

#[test]
fn a_jump_that_no_record_can_hold_is_a_gap_of_unknown_length() {
    for jump in [LONGEST_GAP + 1, 1_000_000_000_000, u64::MAX - 100] {
        let (chunks, losses) = run(&[
            batch(0, 0, 32),
            Batch {
                stamp: BOOT,
                ..batch(1, 32, 32)
            },
            Batch {
                first: 64_u64.wrapping_add(jump),
                ..batch(2, 0, 32)
            },
        ]);
        let samples = received(&chunks);
        assert_eq!(samples.len(), 96, "{jump}");
        assert!(samples.iter().all(|&(at, _)| at < 100), "{jump}");
        assert_eq!((losses.lost_samples, losses.gaps), (0, 1), "{jump}");
    }
    // Nor does a record begin there.
    let first = Batch {
        first: u64::MAX - 5,
        ..batch(9, 0, 32)
    };
    assert_eq!(received(&run(&[first]).0)[0].0, 0);
}

/// The port was away over a stop and a start, and the new stream's count is ahead of the old one's.
#[test]
fn a_stream_whose_start_was_not_heard_is_not_taken_for_the_old_one() {
    let late = of(7, batch(1, 32, 32));
    let (chunks, losses) = run(&[
        of(7, batch(0, 0, 32)),
        of(7, batch(2, 64, 32)),
        of(8, batch(3, 96, 32)),
        late,
        of(8, batch(4, 128, 32)),
    ]);
    let old = (0..32).chain(64..96).map(|i| (i, i as i32));
    let new = (97..161).map(|i| (i, i as i32 - 1));
    let good: Vec<(u64, i32)> = old.chain(new).collect();
    assert_eq!(received(&chunks), good);
    assert_eq!(
        (losses.restarts, losses.gaps, losses.lost_samples),
        (1, 2, 32)
    );
    assert_eq!(losses.left_out, 1, "the frame of the old stream");
}

#[test]
fn what_is_told_of_a_stream_ahead_of_its_first_batch_is_of_that_stream() {
    let mut assembler = Assembler::default();
    for seq in 0..4 {
        assembler.push(&of(7, batch(seq, 32 * u64::from(seq), 32)));
    }
    assembler.confirm(7, 128, true);
    assembler.flush();
    // Of the next stream: its first two batches are lost.
    assembler.confirm(8, 0, false);
    assembler.spoil(2, &notice(8, 100), 128);
    for seq in 2..8 {
        assembler.push(&of(8, batch(seq, 32 * u64::from(seq), 32)));
        assembler.flush();
    }
    assembler.confirm(8, 256, true);
    assembler.finish();
    // Conversions 64 to 100 of the new stream stand behind the place that is left open.
    assert_eq!(spoilt(&mut assembler), (129..165).collect::<Vec<_>>());
}

/// A notice that is lost leaves no hole: no sample of a stream is handed on before the board has told
/// how many there were, from the first on.
#[test]
fn a_numbered_stream_waits_for_its_board_from_the_first_sample() {
    for (stream, handed_on) in [(0, true), (7, false)] {
        let mut assembler = Assembler::default();
        for seq in 0..30 {
            assembler.push(&of(stream, batch(seq, 32 * u64::from(seq), 32)));
            assembler.flush();
        }
        assert_eq!(assembler.pop().is_some(), handed_on);
    }
}
