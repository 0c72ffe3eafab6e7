//! Proof that the chain lost nothing: the board's own bins against those of what arrived.

use inm_emulator::Fault;
use inm_host::internals::source::Source;
use inm_host::internals::source::audit::{Proof, State};
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::virtual_board::VirtualConnect;
use inm_tests::port::{Damage, DamagedConnect};
use inm_tests::record::Record;

const SEED: u64 = 23;

struct Outcome {
    live: Record,
    /// What was proven live, and the end of the record.
    proof: Proof,
    end: u64,
    flagged: [u64; 3],
    replayed: Record,
    replayed_proof: Proof,
}

/// Records `samples` of a virtual board at `speed` (0: as fast as it goes) with these faults,
/// through this damage, and replays the capture.
fn record(speed: f64, faults: Vec<(usize, u64, Fault)>, damage: Damage, samples: u64) -> Outcome {
    let mut board = VirtualConnect::published(SEED, speed);
    board.faults = faults;
    let damaged = DamagedConnect::new(&mut board, damage).expect("the virtual board opens");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("run.inmcap");
    let plan = Plan {
        samples: Some(samples),
        ..Plan::default()
    };
    let mut source = BoardSource::start(Box::new(damaged), plan, Some(&path), Stop::default())
        .expect("the virtual board starts");
    let live = Record::read(&mut source);
    assert!(live.error.is_none(), "{:?}", live.error);
    let mut capture = CaptureSource::open(&path).expect("the capture opens");
    let replayed = Record::read(&mut capture);
    Outcome {
        live,
        proof: source.proof().expect("a board is behind it"),
        end: source.next_index(),
        flagged: source.losses().flagged,
        replayed,
        replayed_proof: capture.proof().expect("a board was behind it"),
    }
}

/// Proven from its first to its last sample, live and in the replay.
fn assert_proven(outcome: &Outcome) {
    let end = outcome.end;
    let whole = Proof {
        state: State::Proven {
            epoch: 0,
            index: end,
        },
        proven: end,
        ..Proof::default()
    };
    assert_eq!(outcome.proof, whole, "seed {SEED}");
    assert_eq!(outcome.replayed_proof, whole, "seed {SEED}");
}

#[test]
fn a_sound_chain_is_proven_to_its_last_sample() {
    let outcome = record(0.0, Vec::new(), Damage::default(), 20_000);
    assert_proven(&outcome);
    assert!(outcome.end >= 20_000);
    assert_eq!(outcome.live.news, Vec::<String>::new());
}

#[test]
fn flagged_words_and_recoveries_do_not_touch_the_proof() {
    let stuck = Fault::BusStuck {
        high: true,
        conversions: Some(5),
    };
    let faults = vec![
        (0, 3000, stuck),
        (
            1,
            5000,
            Fault::Overload {
                input: i32::MAX >> 1,
                conversions: 40,
            },
        ),
        (2, 9000, Fault::DrdyStops),
    ];
    let outcome = record(0.0, faults, Damage::default(), 20_000);
    assert!(
        outcome.flagged.iter().all(|&words| words > 0),
        "{:?}",
        outcome.flagged
    );
    assert!(!outcome.live.gaps.is_empty(), "the recovery of Z is a gap");
    assert_proven(&outcome);
}

/// A damaged frame is told, the board begins its bins anew, and the rest is proven.
#[test]
fn a_damaged_frame_breaks_the_proof_and_it_begins_anew() {
    // The board may be as far ahead as the queues of a virtual link are long, half a megabyte:
    // 40 000 samples. Then comes the second up to the beginning.
    let damage = Damage {
        flip: vec![60_000],
        ..Damage::default()
    };
    let outcome = record(0.0, Vec::new(), damage, 70_000);
    let State::Proven { epoch, index } = outcome.proof.state else {
        panic!(
            "not proven again: {:?}, {:?}",
            outcome.proof, outcome.live.news
        );
    };
    assert_eq!(index, outcome.end, "to the last sample");
    assert!(epoch > 0 && epoch < index, "{epoch} to {index}");
    assert_eq!((outcome.proof.breaks, outcome.proof.disagreements), (1, 0));
    // The first two seconds were proven before the loss, which is in the third.
    let lost = outcome.live.gaps[0].from;
    let proven_first = outcome.proof.proven - (index - epoch);
    assert!(
        proven_first >= 2000 && proven_first <= lost,
        "{proven_first} of {lost}"
    );
    for text in [
        format!("not proven since sample {lost}"),
        format!("begins at sample {epoch}"),
        format!("proven from sample {epoch} to"),
    ] {
        assert!(outcome.live.tells(&text), "{text}: {:?}", outcome.live.news);
        assert!(
            outcome.replayed.tells(&text),
            "{text}: {:?}",
            outcome.replayed.news
        );
    }
    assert_eq!(
        outcome.replayed_proof, outcome.proof,
        "the capture tells the same"
    );
}

/// Losses before, in and after the second up to the new beginning.
#[test]
fn losses_in_a_row_end_in_a_proof() {
    // The host asks once a second: the record has to last longer, 1.75 s.
    let damage = Damage {
        flip: vec![60_000, 61_000, 80_000, 90_000],
        ..Damage::default()
    };
    let outcome = record(20.0, Vec::new(), damage, 70_000);
    assert_eq!(outcome.proof.disagreements, 0);
    assert!(
        matches!(outcome.proof.state, State::Proven { epoch, index } if epoch > 0 && index == outcome.end),
        "{:?}, {:?}",
        outcome.proof,
        outcome.live.news
    );
    assert_eq!(outcome.replayed_proof, outcome.proof);
}
