//! From the converter's pins to the host's samples: every code, bit for bit.

use std::sync::{Arc, Mutex};

use inm_host::capture::Reader;
use inm_host::link::Connect;
use inm_host::source::board::{BoardSource, Plan, Stop};
use inm_host::source::capture::CaptureSource;
use inm_host::source::virtual_board::{VirtualConnect, Witness};
use inm_host::source::{Chunk, Source, Values};
use inm_protocol::{AXES, Filter, Phase, Rate, Settings};

/// All samples of a source; it must have no gap and no word that must not be used.
fn codes(source: &mut dyn Source) -> Vec<[u32; AXES]> {
    let mut all = Vec::new();
    while let Some(chunk) = source.next_chunk().expect("the source reads to its end") {
        match chunk {
            Chunk::Samples(block) => {
                assert_eq!(block.first, all.len() as u64, "the index counts samples");
                let columns: Vec<&[i32]> = block
                    .columns
                    .iter()
                    .map(|column| {
                        assert_eq!(column.invalid, [], "no word is flagged");
                        match &column.values {
                            Values::Codes(codes) => codes.as_slice(),
                            Values::Floats(_) => panic!("codes stay codes"),
                        }
                    })
                    .collect();
                for i in 0..block.len() {
                    all.push([0, 1, 2].map(|axis| columns[axis][i] as u32));
                }
            }
            Chunk::Gap(gap) => panic!("a gap: {gap:?}"),
            Chunk::News(news) => panic!("news on a sound chain: {news}"),
        }
    }
    all
}

fn record(settings: Settings, seed: u64, samples: u64) {
    let witness: Witness = Arc::new(Mutex::new(Vec::new()));
    let mut board = VirtualConnect::published(seed, 0.0);
    board.witness = Some(Arc::clone(&witness));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("run.inmcap");
    let plan = Plan {
        settings: Some(settings),
        samples: Some(samples),
        ..Plan::default()
    };
    let connect: Box<dyn Connect> = Box::new(board);
    let mut live = BoardSource::start(connect, plan, Some(&path), Stop::default())
        .expect("the virtual board starts");
    let received = codes(&mut live);
    assert!(
        received.len() as u64 >= samples,
        "{} samples",
        received.len()
    );

    let produced = witness.lock().expect("not poisoned");
    let start = produced
        .windows(4)
        .position(|window| window == &received[..4])
        .expect("the first samples are among the words produced");
    assert!(
        produced[start..].starts_with(&received),
        "seed {seed}: the host's codes are not the converters'"
    );

    // The capture holds the same samples, and says that it was ended on purpose.
    let mut replay = CaptureSource::open(&path).expect("the capture opens");
    assert_eq!(codes(&mut replay), received);
    assert!(replay.status().ended);
    let header = Reader::open(&path)
        .expect("the header reads")
        .header()
        .clone();
    assert_eq!(header.settings, settings);
    assert_eq!(header.rate_hz, f64::from(settings.rate.hz()));
}

#[test]
fn every_code_arrives_at_every_rate() {
    for rate in Rate::ALL {
        let settings = Settings {
            rate,
            ..Settings::default()
        };
        record(settings, u64::from(rate.hz()), 3 * u64::from(rate.hz()));
    }
}

#[test]
fn every_code_arrives_with_minimum_phase_and_high_pass() {
    let filter = Filter::Fir {
        phase: Phase::Minimum,
        high_pass: Some(0x0337),
    };
    record(
        Settings {
            rate: Rate::Sps2000,
            filter,
        },
        7,
        6000,
    );
}
