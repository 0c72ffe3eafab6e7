//! Frames of a capture that come twice, change places or get lost: whatever is left is right.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::source::frames::Frames;
use inm_host::internals::virtual_board::VirtualConnect;
use inm_protocol::{Answer, Batch, Code, MAX_FRAME, Reply, Settings, ToHost, encode};
use inm_tests::record::Record;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Random captures; each has some ten frames out of place.
const RUNS: u64 = 300;

/// Frames with their closing zeros.
fn frames(bytes: &[u8]) -> Vec<Vec<u8>> {
    bytes
        .split_inclusive(|&byte| byte == 0)
        .map(<[u8]>::to_vec)
        .collect()
}

fn read(path: &Path) -> (Record, u64) {
    let mut capture = CaptureSource::open(path).expect("the capture opens");
    let record = Record::read(&mut capture);
    (record, capture.losses().restarts)
}

/// Puts some frames of the stream out of place, but for the end note.
fn disturb(frames: &mut Vec<Vec<u8>>, random: &mut Pcg64) {
    for _ in 0..random.random_range(1..20) {
        let last = frames.len() - 2;
        let at = random.random_range(0..last);
        match random.random_range(0..3) {
            0 => {
                let again = frames[random.random_range(0..=at)].clone();
                frames.insert(at, again);
            }
            1 => frames.swap(at, (at + random.random_range(1..6)).min(last)),
            _ => {
                frames.remove(at);
            }
        }
    }
}

#[test]
fn frames_repeated_swapped_and_lost_leave_no_wrong_sample() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("run.inmcap");
    let plan = Plan {
        samples: Some(4000),
        ..Plan::default()
    };
    let connect = Box::new(VirtualConnect::published(3, 0.0));
    let mut live = BoardSource::start(connect, plan, Some(&path), Stop::default()).expect("starts");
    let truth = Record::read(&mut live);
    assert!(truth.error.is_none());
    let truth: BTreeMap<u64, [u32; 3]> = truth
        .samples
        .iter()
        .map(|&(index, codes, _)| (index, codes))
        .collect();
    let bytes = std::fs::read(&path).expect("the capture reads");
    let mut lines = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    let (header, _) = lines.nth(1).expect("two lines");
    let (header, stream) = bytes.split_at(header + 1);
    let disturbed = folder.path().join("disturbed.inmcap");
    for seed in 0..RUNS {
        let mut frames = frames(stream);
        disturb(&mut frames, &mut Pcg64::seed_from_u64(seed));
        std::fs::write(&disturbed, [header, &frames.concat()].concat()).expect("writable");
        let (record, restarts) = read(&disturbed);
        assert_eq!(restarts, 0, "seed {seed}: no board has started again");
        let mut seen = HashSet::new();
        for (index, codes, _) in &record.samples {
            assert!(
                seen.insert(*index),
                "seed {seed}: sample {index} is there twice"
            );
            assert_eq!(truth.get(index), Some(codes), "seed {seed}: sample {index}");
        }
    }
}

/// One board, whose `Configure` and `Start` were answered in this order; batches come in places.
#[test]
fn an_old_reply_that_comes_late_begins_no_stream() {
    let reply = |id| {
        ToHost::Reply(Reply {
            id,
            result: Ok(Answer::Settings(Settings::default())),
        })
    };
    let batch = |seq: u32| {
        let mut batch = Batch {
            seq,
            first: 32 * u64::from(seq),
            stamp: 1000 + 32 * 500 * u64::from(seq),
            ..Batch::default()
        };
        for _ in 0..32 {
            batch.codes.push([Code(2); 3]).expect("room");
        }
        ToHost::Samples(batch)
    };
    let old = [u16::MAX, 4, 7];
    let new = [0, 5, 9];
    for (old, new) in old.into_iter().zip(new) {
        let mut frames = Frames::default();
        for message in [
            reply(new),
            batch(1),
            batch(2),
            reply(old),
            batch(0),
            batch(3),
        ] {
            let mut frame = [0; MAX_FRAME];
            let len = encode(&message, &mut frame).expect("it fits");
            frames.push(&frame[..len]);
        }
        frames.finish();
        assert_eq!(frames.losses().restarts, 0, "{old} behind {new}");
        assert_eq!(frames.next_index(), 128, "{old} behind {new}");
    }
}
