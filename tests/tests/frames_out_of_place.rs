//! Frames of a capture that come twice, change places or get lost: whatever is left is right.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::virtual_board::VirtualConnect;
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
