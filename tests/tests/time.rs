//! The time of a record: both clocks in the capture, the data rate by them, and what a diagnosis makes of it.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Duration;

use inm_host::internals::capture::Reader;
use inm_host::internals::source::Source;
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::virtual_board::{ClocksOff, VirtualConnect};
use inm_host::{AnalysisOptions, Diagnosis, DiagnosisOptions, Report, analyse, diagnose};
use inm_protocol::{Decoder, Health, Note, ToHost};
use inm_tests::port::{Damage, DamagedConnect};
use inm_tests::record::Record;
use rand::SeedableRng;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

/// Samples a second of the virtual board, and the length of a record.
const RATE_HZ: f64 = 2000.0;
const SAMPLES: u64 = 80_000;

/// Standard uncertainties by which a number may be off: 0.1 % of Student's law with ten degrees of freedom.
const FAR: f64 = 4.6;

/// A record of a virtual board whose clocks are off, and what was said of its clocks while it was made.
fn record(folder: &Path, seed: u64, off: ClocksOff) -> PathBuf {
    let path = folder.join(format!("run-{seed}.inmcap"));
    let plan = Plan {
        samples: Some(SAMPLES),
        ..Plan::default()
    };
    let board = VirtualConnect {
        off,
        ..VirtualConnect::published(seed, 0.0)
    };
    let mut live = BoardSource::start(Box::new(board), plan, Some(&path), Stop::default())
        .expect("the virtual board starts");
    assert!(Record::read(&mut live).error.is_none(), "seed {seed}");
    // A replay says what was said live.
    let mut replay = CaptureSource::open(&path).expect("a capture");
    Record::read(&mut replay);
    assert!(live.clocks().is_some(), "seed {seed}");
    assert_eq!(live.clocks(), replay.clocks(), "seed {seed}");
    path
}

/// Parts in a million from 400 to 4000, one way or the other: what a board has that took a wrong crystal.
fn drawn(seed: u64) -> ClocksOff {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut draw = || {
        let size: f64 = Uniform::new(-1.0, 1.0)
            .expect("a range")
            .sample(&mut random);
        400.0_f64.mul_add(size.signum(), 3600.0 * size)
    };
    ClocksOff {
        converters_ppm: draw(),
        crystal_ppm: draw(),
    }
}

fn diagnosis(path: &Path) -> Diagnosis {
    let mut source = CaptureSource::open(path).expect("a capture");
    let options = DiagnosisOptions {
        views: false,
        ..DiagnosisOptions::default()
    };
    diagnose(&mut source, options, &|_, _| {}).expect("a diagnosis")
}

#[test]
fn the_data_rate_is_known_by_both_clocks_and_a_wrong_one_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    for seed in [71, 72] {
        let off = drawn(seed);
        let path = record(folder.path(), seed, off);
        let diagnosis = diagnosis(&path);
        let clocks = diagnosis.source.clocks.expect("a capture has them");
        let [converters, crystal] =
            [off.converters_ppm, off.crystal_ppm].map(|ppm| 1.0 + 1e-6 * ppm);
        let board = clocks.rate_by_board_hz;
        // The timer is said to have a whole number of ticks in a second, a million or so.
        let truth_hz = RATE_HZ * converters / crystal;
        let error = (board.value - truth_hz).abs() - 0.5e-6 * truth_hz;
        assert!(error < FAR * board.sd, "seed {seed}, {off:?}: {board:?}");
        assert!(board.sd < 1e-6 * RATE_HZ, "seed {seed}: {board:?}");
        let host = clocks.rate_by_host_hz.expect("it was noted down");
        let truth_hz = RATE_HZ * converters;
        let error = (host.value - truth_hz).abs() - 0.5e-6 * truth_hz;
        assert!(error < FAR * host.sd, "seed {seed}, {off:?}: {host:?}");
        assert!(host.sd < 5e-5 * RATE_HZ, "seed {seed}: {host:?}");
        println!("seed {seed}, {off:?}: {clocks:?}");
        for axis in &diagnosis.axes {
            let found = axis
                .findings
                .iter()
                .find(|one| one.effect.name() == "timebase");
            let found = found.unwrap_or_else(|| panic!("seed {seed}, {off:?}: {clocks:?}"));
            assert!(found.rivals.is_empty(), "seed {seed}");
            let ratio = found.parameters()["ratio"].value;
            let far = FAR * host.sd / RATE_HZ;
            assert!((ratio - converters).abs() < far, "seed {seed}: {ratio}");
        }
        assert!(
            diagnosis.text().contains("by the host's clock"),
            "seed {seed}"
        );
    }
}

#[test]
fn a_sound_board_has_no_wrong_clock() {
    let folder = tempfile::tempdir().expect("a folder");
    let sound = ClocksOff {
        // Within what crystals differ by.
        converters_ppm: 40.0,
        crystal_ppm: -40.0,
    };
    let diagnosis = diagnosis(&record(folder.path(), 73, sound));
    let clocks = diagnosis.source.clocks.expect("a capture has them");
    let board = clocks.rate_by_board_hz.value / RATE_HZ;
    assert!((board - 1.000_08).abs() < 1e-6, "{clocks:?}");
    for axis in &diagnosis.axes {
        let found = axis
            .findings
            .iter()
            .any(|one| one.effect.name() == "timebase");
        assert!(!found, "{clocks:?}");
    }
}

/// What a capture holds behind its header, message by message, with its bytes.
fn messages(path: &Path) -> Vec<(ToHost, usize)> {
    let mut reader = Reader::open(path).expect("a capture");
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).expect("read");
    let (mut decoder, mut rest): (Decoder, _) = (Decoder::default(), &bytes[..]);
    let mut messages = Vec::new();
    let mut before = rest.len();
    while let Some(message) = decoder.next::<ToHost>(&mut rest) {
        // A port that goes away cuts a frame.
        messages.extend(message.ok().map(|message| (message, before - rest.len())));
        before = rest.len();
    }
    messages
}

/// One note for each health record, behind it, of its stamp, and never ahead of it in time.
#[test]
fn the_notes_of_the_clocks_are_those_of_health_records() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = record(folder.path(), 74, ClocksOff::default());
    let reader = Reader::open(&path).expect("a capture");
    let timer_hz = f64::from(reader.header().board.timer_hz);
    let mut health: Vec<Health> = Vec::new();
    let mut pairs = Vec::new();
    let mut noted = 0;
    for (message, bytes) in messages(&path) {
        match message {
            ToHost::Health(one) => health.push(one),
            ToHost::Note(Note::Clock { stamp, host_us, .. }) => {
                assert_eq!(health.last().map(|one| one.stamp), Some(stamp));
                pairs.push((stamp as f64 / timer_hz, host_us as f64 * 1e-6));
                noted += bytes;
            }
            _ => {}
        }
    }
    // Two came while the board was asked for something at the beginning, and one at the end.
    assert!(
        pairs.len() + 3 >= health.len(),
        "{} of {}",
        pairs.len(),
        health.len()
    );
    assert!(
        noted <= 32 * pairs.len(),
        "{noted} bytes of {}",
        pairs.len()
    );
    // Ahead of a health record on the line are a full batch at most, 4.6 ms, and what else was told.
    let late: Vec<f64> = pairs.iter().map(|(board, host)| host - board).collect();
    let least = late.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(late.iter().all(|late| late - least < 0.01), "{late:?}");
}

/// The host's clock goes on while the port is away, and after it.
#[test]
fn a_port_that_was_away_has_not_stopped_the_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.inmcap");
    let damage = Damage {
        // Some seconds into the record.
        vanish: Some(100_000),
        // Between two attempts the host waits for 300 ms of its own time, which is the machine's here.
        failing_opens: 2,
        ..Damage::default()
    };
    let board = DamagedConnect::new(&mut VirtualConnect::published(75, 0.0), damage);
    let plan = Plan {
        samples: Some(20_000),
        reconnect: Some(Duration::from_secs(60)),
        ..Plan::default()
    };
    let board = Box::new(board.expect("it opens"));
    let mut live =
        BoardSource::start(board, plan, Some(&path), Stop::default()).expect("it starts");
    assert!(Record::read(&mut live).error.is_none());
    let mut noted: [Vec<u64>; 2] = Default::default();
    let mut away = false;
    for (message, _) in messages(&path) {
        match message {
            ToHost::Note(Note::PortLost { .. }) => away = true,
            ToHost::Note(Note::Clock { host_us, .. }) => {
                noted[usize::from(away)].push(host_us);
            }
            _ => {}
        }
    }
    let [before, after] = &noted;
    assert!(before.len() > 1 && after.len() > 1, "{noted:?}");
    assert!(before.is_sorted() && after.is_sorted(), "{noted:?}");
    assert!(after[0] > before[before.len() - 1] + 600_000, "{noted:?}");
}

/// What an older release wrote has no such notes, and its rate is by the stamps alone.
#[test]
fn a_capture_from_before_has_the_rate_of_its_stamps() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
    for name in ["board.inmcap", "board-2.inmcap"] {
        let mut source = CaptureSource::open(&folder.join(name)).expect("a capture");
        let analysis = analyse(&mut source, &AnalysisOptions::default(), |_| {});
        let source = analysis.expect("an analysis").source;
        let clocks = source.clocks.expect("stamps");
        assert_eq!(
            Some(clocks.rate_by_board_hz.value),
            source.measured_rate_hz,
            "{name}"
        );
        assert_eq!(clocks.rate_by_host_hz, None, "{name}");
        let half = clocks.rate_by_board_hz.half_95().expect("an interval");
        let off = (clocks.rate_by_board_hz.value - source.rate_hz).abs();
        assert!(off < 2.0 * half, "{name}: {clocks:?}");
    }
}
