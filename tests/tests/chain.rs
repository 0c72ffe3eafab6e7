//! From the converter's pins to the host's samples: every code, bit for bit.

use std::sync::{Arc, Mutex};

use inm_host::internals::capture::Reader;
use inm_host::internals::source::Source;
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::virtual_board::{VirtualConnect, Witness};
use inm_protocol::{Filter, Phase, Rate, Settings};
use inm_tests::record::Record;

fn check(settings: Settings, seed: u64, samples: u64) {
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
    let mut live = BoardSource::start(Box::new(board), plan, Some(&path), Stop::default())
        .expect("the virtual board starts");
    let received = Record::read(&mut live);
    assert!(
        received.error.is_none(),
        "seed {seed}: {:?}",
        received.error
    );
    assert_eq!(received.gaps, [], "seed {seed}");
    assert_eq!(received.news, Vec::<String>::new(), "seed {seed}");
    assert!(received.samples.len() as u64 >= samples);
    assert!(
        received
            .samples
            .iter()
            .all(|(_, _, good)| *good == [true; 3]),
        "seed {seed}"
    );
    received.assert_follows(&witness.lock().expect("not poisoned"));

    // The capture holds the same samples, and says that it was ended on purpose.
    let mut replay = CaptureSource::open(&path).expect("the capture opens");
    assert!(
        Record::read(&mut replay).codes() == received.codes(),
        "seed {seed}"
    );
    assert!(replay.status().ended);
    assert_eq!(replay.signal().rate_hz, f64::from(settings.rate.hz()));
    let header = Reader::open(&path)
        .expect("the header reads")
        .header()
        .clone();
    assert_eq!(header.settings, settings);
}

#[test]
fn every_code_arrives_at_every_rate() {
    for rate in Rate::ALL {
        let settings = Settings {
            rate,
            ..Settings::default()
        };
        check(settings, u64::from(rate.hz()), 3 * u64::from(rate.hz()));
    }
}

#[test]
fn every_code_arrives_with_minimum_phase_and_high_pass() {
    let filter = Filter::Fir {
        phase: Phase::Minimum,
        high_pass: Some(0x0337),
    };
    check(
        Settings {
            rate: Rate::Sps2000,
            filter,
        },
        7,
        6000,
    );
}
