//! What a virtual board records does not depend on how fast the machine is.

use std::sync::Arc;

use super::*;
use crate::source::board::{BoardSource, Plan, Stop};
use crate::source::{Chunk, Source};

const SEED: u64 = 5;

/// A record of a second by a host that rests for so long after every chunk.
fn record(rest: Duration) -> Vec<Chunk> {
    record_of(VirtualConnect::published(SEED, 0.0), rest)
}

fn record_of(connect: VirtualConnect, rest: Duration) -> Vec<Chunk> {
    let plan = Plan {
        samples: Some(2000),
        ..Plan::default()
    };
    let connect = Box::new(connect);
    let mut source =
        BoardSource::start(connect, plan, None, Stop::default()).expect("a virtual board");
    let mut chunks = Vec::new();
    while let Some(chunk) = source.next_chunk().expect("no loss") {
        chunks.push(chunk);
        thread::sleep(rest);
    }
    chunks
}

#[test]
fn a_slow_host_records_what_a_fast_one_does() {
    let [fast, slow] = [0, 20].map(|rest_ms| record(Duration::from_millis(rest_ms)));
    let count = |chunks: &[Chunk]| -> usize {
        let samples = chunks.iter().map(|chunk| match chunk {
            Chunk::Samples(block) => block.len(),
            _ => 0,
        });
        samples.sum()
    };
    let counts = [count(&fast), count(&slow)];
    assert!(counts[0] >= 2000, "seed {SEED}: {counts:?} samples");
    // To the last sample: when the board stops follows from what the host had read.
    assert!(fast == slow, "seed {SEED}: {counts:?} samples");
}

/// A machine that left the board's thread no time for longer than the host is patient made the
/// board silent: it was asked again, and started again.
#[test]
fn a_board_that_gets_no_time_records_what_a_fast_one_does() {
    /// Longer than the silence that a host bears, and than three waits for a reply.
    const HELD_UP: Duration = Duration::from_millis(4700);
    let witness = Witness::default();
    let (held, holds) = mpsc::channel();
    let holder = Arc::clone(&witness);
    let holding = thread::spawn(move || {
        let words = holder.lock();
        held.send(()).expect("awaited");
        thread::sleep(HELD_UP);
        drop(words);
    });
    holds.recv().expect("held");
    // The thread stands still at its first word.
    let board = VirtualConnect {
        witness: Some(witness),
        ..VirtualConnect::published(SEED, 0.0)
    };
    let slow = record_of(board, Duration::ZERO);
    holding.join().expect("no panic");
    assert!(slow == record(Duration::ZERO), "seed {SEED}");
}

/// A mark within a frame cut it, and the frame's samples were lost.
#[test]
fn marks_cost_no_sample_and_stand_in_their_order() {
    let plan = Plan {
        samples: Some(50_000),
        ..Plan::default()
    };
    let connect = Box::new(VirtualConnect::published(SEED, 0.0));
    let mut source =
        BoardSource::start(connect, plan, None, Stop::default()).expect("a virtual board");
    let marks = source.marks();
    let (mut set, mut told) = (Vec::new(), Vec::new());
    while let Some(chunk) = source.next_chunk().expect("no loss") {
        match chunk {
            Chunk::Samples(_) => {
                let text = set.len().to_string();
                // More than may wait are not taken, and that is said.
                if marks.set(&text).is_ok() {
                    set.push(text);
                }
            }
            Chunk::News(news) => told.extend(news.strip_prefix("mark ").map(str::to_owned)),
            Chunk::Gap(gap) => panic!("seed {SEED}: {gap:?}"),
        }
    }
    assert!(set.len() > 10, "seed {SEED}: {} marks", set.len());
    let texts = told.iter().filter_map(|news| news.rsplit(": ").next());
    let texts: Vec<&str> = texts.collect();
    // The one set behind the last samples has no place.
    set.truncate(set.len() - 1);
    assert!(
        texts == set || texts[..texts.len() - 1] == set[..],
        "seed {SEED}: {texts:?}"
    );
    assert_eq!(source.damaged(), (0, 0), "seed {SEED}");
}
