//! A pulse a second: from a receiver's edge at the board's input to the data rate in a report.

use std::path::Path;

use inm_host::internals::source::Source;
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::virtual_board::{ClocksOff, VirtualConnect};
use inm_host::{Clocks, Diagnosis, DiagnosisOptions, Report, diagnose};
use inm_tests::record::Record;
use rand::SeedableRng;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

/// Samples a second of the virtual board, and the length of a record.
const RATE_HZ: f64 = 2000.0;
const SAMPLES: u64 = 120_000;

/// Ticks a second that the virtual board's timer has in truth, by the converters' time.
const TICKS: f64 = 1e6;

/// Standard uncertainties by which a number may be off: 0.1 % of Student's law with ten degrees of freedom.
const FAR: f64 = 4.6;

/// A board whose clocks are off, with a receiver that is drawn: it jitters and misses some.
fn board(seed: u64, off: ClocksOff) -> VirtualConnect {
    let mut random = Pcg64::seed_from_u64(seed + 1000);
    let mut within = |from: f64, to: f64| {
        let law = Uniform::new(from, to).expect("a range");
        law.sample(&mut random)
    };
    let mut board = VirtualConnect::published(seed, 0.0).with_pulses(seed);
    board.off = off;
    let receiver = board.receiver.as_mut().expect("it has one");
    receiver.jitter_s = within(1e-6, 1e-5);
    receiver.missing = within(0.05, 0.3);
    board
}

/// Clocks that are up to so much off.
fn drawn(seed: u64, most_ppm: f64) -> ClocksOff {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut within = |from: f64, to: f64| {
        let law = Uniform::new(from, to).expect("a range");
        law.sample(&mut random)
    };
    ClocksOff {
        converters_ppm: within(-most_ppm, most_ppm),
        crystal_ppm: within(-most_ppm, most_ppm),
    }
}

/// Records a board and reads the capture again: what was said live is said of it.
fn recorded(path: &Path, board: VirtualConnect) -> Clocks {
    let plan = Plan {
        samples: Some(SAMPLES),
        ..Plan::default()
    };
    let mut live = BoardSource::start(Box::new(board), plan, Some(path), Stop::default())
        .expect("the virtual board starts");
    assert!(Record::read(&mut live).error.is_none());
    let mut replay = CaptureSource::open(path).expect("a capture");
    Record::read(&mut replay);
    assert_eq!(live.clocks(), replay.clocks());
    live.clocks().expect("stamps")
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
fn the_rate_by_a_pulse_a_second_is_that_of_the_converters() {
    let folder = tempfile::tempdir().expect("a folder");
    for seed in [81, 82, 83] {
        let off = drawn(seed, 3000.0);
        let path = folder.path().join(format!("run-{seed}.inmcap"));
        let board = board(seed, off);
        let receiver = board.receiver;
        let clocks = recorded(&path, board);
        let told = format!("seed {seed}, {off:?}, {receiver:?}: {clocks:?}");
        println!("{told}");
        let [converters, crystal] =
            [off.converters_ppm, off.crystal_ppm].map(|ppm| 1.0 + 1e-6 * ppm);
        // It is said to have a whole number of ticks.
        let said_hz = (TICKS * converters / crystal).round();
        let over_pps = clocks.board_over_pps.expect("it has pulses");
        let truth = TICKS * converters / said_hz;
        assert!((over_pps.value - truth).abs() < FAR * over_pps.sd, "{told}");
        // A minute of jitter of 10 us: 0.1 ppm, to the spread of ten degrees of freedom.
        assert!(over_pps.sd < 2e-7, "{told}");
        let rate = clocks.rate_by_pps_hz.expect("as well");
        let error = (rate.value - RATE_HZ * converters).abs();
        assert!(error < FAR * rate.sd, "{told}");
        // Far surer than by the way of bytes to the host.
        let by_host = clocks.rate_by_host_hz.expect("noted down");
        assert!(rate.sd < by_host.sd / 10.0, "{told}");
        assert_eq!(clocks.best().0, rate, "{told}");
    }
}

/// 80 ppm are within what two crystals may differ by, so no evidence by the host's clock; the pulses leave one of them.
#[test]
fn a_diagnosis_takes_the_word_of_the_pulses_and_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    for (converters_ppm, named) in [(80.0, true), (30.0, false)] {
        let path = folder.path().join(format!("{converters_ppm}.inmcap"));
        let off = ClocksOff {
            converters_ppm,
            crystal_ppm: -20.0,
        };
        recorded(&path, board(84, off));
        let diagnosis = diagnosis(&path);
        let text = diagnosis.text();
        assert!(text.contains("Data rate by a pulse a second: "), "{text}");
        assert!(text.contains("it counts before the host's clock"), "{text}");
        assert!(text.contains("of the pulse a second"), "{text}");
        for axis in &diagnosis.axes {
            let mut found = axis.findings.iter();
            let found = found.find(|one| one.effect.name() == "timebase");
            assert_eq!(found.is_some(), named, "{converters_ppm}: {text}");
            let Some(found) = found else { continue };
            let ratio = found.parameters()["ratio"].value;
            assert!((ratio - 1.000_08).abs() < 1e-6, "{ratio}");
        }
    }
}
