//! Trouble on the link: reported, counted, recovered from, and what follows is right.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use inm_host::internals::link::{Connect, LinkError, Port};
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::virtual_board::{VirtualConnect, Witness};
use inm_tests::port::{Damage, DamagedConnect};
use inm_tests::record::Record;

/// Bytes of a full batch on the link, at most.
const BATCH_BYTES: u64 = 423;

struct Outcome {
    record: Record,
    produced: Vec<[u32; 3]>,
    damaged_frames: u64,
    lost_samples: u64,
    replayed: Record,
}

/// Records `samples` from a virtual board through `damage`.
fn record(damage: Damage, samples: u64, reconnect: Option<Duration>) -> Outcome {
    let witness: Witness = Arc::new(Mutex::new(Vec::new()));
    let mut board = VirtualConnect::published(11, 0.0);
    board.witness = Some(Arc::clone(&witness));
    let damaged = DamagedConnect::new(&mut board, damage).expect("the virtual board opens");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("run.inmcap");
    let plan = Plan {
        samples: Some(samples),
        reconnect,
        ..Plan::default()
    };
    let mut live = BoardSource::start(Box::new(damaged), plan, Some(&path), Stop::default())
        .expect("the virtual board starts");
    let record = Record::read(&mut live);
    let mut capture = CaptureSource::open(&path).expect("the capture opens");
    let replayed = Record::read(&mut capture);
    let produced = witness.lock().expect("not poisoned").clone();
    Outcome {
        record,
        produced,
        damaged_frames: live.damaged().0,
        lost_samples: live.losses().lost_samples,
        replayed,
    }
}

/// A position well inside the stream of samples.
const INSIDE: u64 = 60_000;

#[test]
fn flipped_bits_cost_their_frame_and_nothing_else() {
    let flip = vec![INSIDE, INSIDE + 5 * BATCH_BYTES, INSIDE + 40 * BATCH_BYTES];
    let hit = flip.len() as u64;
    let outcome = record(
        Damage {
            flip,
            ..Damage::default()
        },
        20_000,
        None,
    );
    assert!(outcome.record.error.is_none(), "{:?}", outcome.record.error);
    // A flip may make a zero, which cuts one frame into two faults, or hit a closing zero, which
    // joins two frames into one.
    assert!(
        (hit..=2 * hit).contains(&outcome.damaged_frames),
        "{}",
        outcome.damaged_frames
    );
    assert!(outcome.lost_samples >= 32, "{}", outcome.lost_samples);
    assert!(
        outcome.lost_samples <= 2 * 32 * hit,
        "{}",
        outcome.lost_samples
    );
    let counted: u64 = outcome
        .record
        .gaps
        .iter()
        .map(|gap| gap.to.expect("a loss on the link has a known length") - gap.from)
        .sum();
    assert_eq!(counted, outcome.lost_samples);
    assert!(outcome.record.tells("damaged frame"));
    outcome.record.assert_follows(&outcome.produced);
    assert!(
        outcome.replayed.codes() == outcome.record.codes(),
        "the capture tells the same"
    );
    assert_eq!(outcome.replayed.gaps, outcome.record.gaps);
}

#[test]
fn a_lost_byte_costs_its_frame_and_nothing_else() {
    let drop = vec![INSIDE + 7];
    let outcome = record(
        Damage {
            drop,
            ..Damage::default()
        },
        20_000,
        None,
    );
    assert!(outcome.record.error.is_none(), "{:?}", outcome.record.error);
    assert!(
        (1..=2).contains(&outcome.damaged_frames),
        "{}",
        outcome.damaged_frames
    );
    assert!(
        (1..=64).contains(&outcome.lost_samples),
        "{}",
        outcome.lost_samples
    );
    outcome.record.assert_follows(&outcome.produced);
}

#[test]
fn a_damaged_reply_to_start_costs_nothing() {
    let damage = Damage {
        garbled_start: true,
        ..Damage::default()
    };
    let outcome = record(damage, 20_000, None);
    assert!(outcome.record.error.is_none(), "{:?}", outcome.record.error);
    assert!((1..=2).contains(&outcome.damaged_frames));
    assert_eq!(outcome.lost_samples, 0);
    assert_eq!(outcome.record.samples[0].0, 0);
    outcome.record.assert_follows(&outcome.produced);
}

#[test]
fn a_port_that_comes_back_goes_on_where_the_board_is() {
    let unheard = 30_000;
    let damage = Damage {
        vanish: Some(INSIDE),
        failing_opens: 2,
        unheard,
        ..Damage::default()
    };
    let outcome = record(damage, 20_000, Some(Duration::from_secs(20)));
    assert!(outcome.record.error.is_none(), "{:?}", outcome.record.error);
    let silence = unheard as u64 / BATCH_BYTES * 32;
    assert!(
        outcome.lost_samples + 64 >= silence,
        "{}",
        outcome.lost_samples
    );
    assert!(
        outcome.lost_samples <= silence + 256,
        "{}",
        outcome.lost_samples
    );
    outcome.record.assert_follows(&outcome.produced);
    assert!(
        outcome.replayed.tells("the port went away"),
        "{:?}",
        outcome.replayed.news
    );
    assert!(
        outcome.replayed.tells("the port came back"),
        "{:?}",
        outcome.replayed.news
    );
    assert!(
        outcome.replayed.codes() == outcome.record.codes(),
        "the capture tells the same"
    );
}

#[test]
fn a_port_that_goes_away_again_within_a_second_is_waited_for() {
    let damage = Damage {
        vanish: Some(INSIDE),
        vanish_again: Some(100),
        unheard: 3000,
        ..Damage::default()
    };
    let outcome = record(damage, 20_000, Some(Duration::from_secs(20)));
    assert!(outcome.record.error.is_none(), "{:?}", outcome.record.error);
    outcome.record.assert_follows(&outcome.produced);
    assert!(
        outcome.replayed.codes() == outcome.record.codes(),
        "the capture tells the same"
    );
}

/// A port behind which another board is each time that it is opened; the last one stays.
struct Swapped {
    boards: Vec<Box<dyn Connect>>,
    next: usize,
}

impl Connect for Swapped {
    fn name(&self) -> String {
        "swapped".to_owned()
    }

    fn waits(&self) -> bool {
        true
    }

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        let last = self.boards.len() - 1;
        let board = &mut self.boards[self.next.min(last)];
        self.next += 1;
        board.open()
    }
}

/// A record of a board whose port vanishes, with these boards behind it when it is back.
fn record_swapped(serials: &[u32], reconnect: Duration) -> Record {
    let damage = Damage {
        vanish: Some(INSIDE),
        ..Damage::default()
    };
    let board = |serial| {
        let mut board = VirtualConnect::published(11, 0.0);
        board.serial = [0, 0, serial];
        board
    };
    let first = DamagedConnect::new(&mut board(1), damage).expect("the virtual board opens");
    let mut boards: Vec<Box<dyn Connect>> = vec![Box::new(first)];
    boards.extend(serials.iter().map(|&serial| Box::new(board(serial)) as _));
    let plan = Plan {
        samples: Some(20_000),
        reconnect: Some(reconnect),
        ..Plan::default()
    };
    let swapped = Box::new(Swapped { boards, next: 0 });
    let mut live =
        BoardSource::start(swapped, plan, None, Stop::default()).expect("the virtual board starts");
    Record::read(&mut live)
}

#[test]
fn another_board_is_refused_by_name() {
    let record = record_swapped(&[2], Duration::from_millis(700));
    let error = record.error.expect("another board").to_string();
    let numbers = [2, 1].map(|serial| format!("{serial:024x}"));
    assert!(
        numbers.iter().all(|number| error.contains(number)),
        "{error}"
    );
    assert!(
        error.contains("plug the board of this recording"),
        "{error}"
    );
}

#[test]
fn the_board_is_waited_for_while_another_is_there() {
    let record = record_swapped(&[2, 1], Duration::from_secs(20));
    assert!(record.error.is_none(), "{:?}", record.error);
    assert_eq!(record.gaps.len(), 1, "{:?}", record.gaps);
    let cause = &record.gaps[0].cause;
    assert!(
        cause.starts_with("the port went away and had restarted"),
        "{cause}"
    );
}

#[test]
fn a_port_that_stays_away_ends_the_record_and_keeps_it() {
    let damage = Damage {
        vanish: Some(INSIDE),
        failing_opens: u32::MAX,
        ..Damage::default()
    };
    let outcome = record(damage, 1 << 40, Some(Duration::from_millis(700)));
    let error = outcome
        .record
        .error
        .as_ref()
        .expect("the port is gone")
        .to_string();
    assert!(error.contains("the port went away"), "{error}");
    assert!(error.contains("cable"), "the remedy: {error}");
    assert!(outcome.record.samples.len() > 3000);
    assert!(
        outcome.replayed.codes() == outcome.record.codes(),
        "the capture tells the same"
    );
}
