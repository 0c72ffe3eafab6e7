//! What the header of a capture says is what was: of the record itself, not of a time before it.

use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use inm_firmware::keep::Kept;
use inm_host::internals::capture::{ClockSource, Header, Reader, RegistersOf};
use inm_host::internals::link::{Clock, Connect, LinkError, Patience, Port};
use inm_host::internals::source::Source;
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::virtual_board::VirtualConnect;
use inm_host::{AnalysisOptions, Report, analyse};
use inm_protocol::{
    Decoder, Filter, Phase, Rate, Request, Restart, SensorCalibration, Settings, ToBoard, ToHost,
};
use inm_tests::record::Record;

/// Not the board's own: its registers differ from those of a board that has just been switched on.
const SETTINGS: Settings = Settings {
    rate: Rate::Sps500,
    filter: Filter::Fir {
        phase: Phase::Minimum,
        high_pass: Some(0x1234),
    },
};

fn record(path: &Path) {
    let plan = Plan {
        settings: Some(SETTINGS),
        samples: Some(2000),
        ..Plan::default()
    };
    let board = Box::new(VirtualConnect::published(4, 0.0));
    let mut live = BoardSource::start(board, plan, Some(path), Stop::default())
        .expect("the virtual board starts");
    assert!(Record::read(&mut live).error.is_none());
}

/// The capture with a text of its header replaced.
fn edited(path: &Path, from: &str, to: &str) {
    let bytes = std::fs::read(path).expect("a capture");
    let at = bytes
        .windows(from.len())
        .position(|part| part == from.as_bytes());
    let at = at.unwrap_or_else(|| panic!("`{from}` is in the header"));
    let whole = [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat();
    std::fs::write(path, whole).expect("written");
}

#[test]
fn the_registers_are_those_of_the_record() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.inmcap");
    record(&path);
    let header = Reader::open(&path).expect("a capture").header().clone();
    // What the board read back while it streamed, as its health records say.
    let bytes = std::fs::read(&path).expect("a capture");
    let mut frames = bytes
        .splitn(3, |&byte| byte == b'\n')
        .nth(2)
        .expect("frames");
    let mut decoder: Decoder = Decoder::default();
    let mut told = Vec::new();
    while let Some(message) = decoder.next(&mut frames) {
        if let Ok(ToHost::Health(health)) = message
            && health.streaming
        {
            told.push(health.registers);
        }
    }
    assert!(!told.is_empty(), "four seconds have health records");
    for registers in told {
        assert_eq!(header.registers, registers);
    }
    assert_eq!(header.registers_of, RegistersOf::Record);
    assert_eq!(header.board.restart, Some(Restart::Power));
    assert_eq!(header.board.clock, ClockSource::Emulated);
}

/// A seed of the fuzz target `header`: the scale of a recording came back one bit off.
#[test]
fn the_numbers_of_a_header_are_read_as_they_were_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.inmcap");
    let plan = Plan {
        samples: Some(100),
        ..Plan::default()
    };
    let board = Box::new(VirtualConnect::published(4, 0.0));
    let mut live = BoardSource::start(board, plan, Some(&path), Stop::default())
        .expect("the virtual board starts");
    assert!(Record::read(&mut live).error.is_none());
    let read = CaptureSource::open(&path).expect("a capture");
    assert_eq!(read.header(), live.header());
}

#[test]
fn a_clock_that_is_good_to_a_hundredth_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.inmcap");
    record(&path);
    let told = |path: &Path| {
        let mut source = CaptureSource::open(path).expect("a capture");
        Record::read(&mut source).tells("internal oscillator")
    };
    assert!(!told(&path));
    edited(&path, "\"clock\":\"emulated\"", "\"clock\":\"internal\"");
    assert!(told(&path));
}

#[test]
fn the_rate_by_the_stamps_is_measured_and_compared() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.inmcap");
    record(&path);
    let analysis = || {
        let mut source = CaptureSource::open(&path).expect("a capture");
        let analysis = analyse(&mut source, &AnalysisOptions::default(), |_| {});
        let analysis = analysis.expect("an analysis");
        assert_eq!(source.clocks(), analysis.source.clocks);
        analysis
    };
    let sound = analysis();
    let measured_hz = sound
        .source
        .measured_rate_hz
        .expect("four seconds of stamps");
    // A tick of the stamps at either end, of four seconds.
    assert!((measured_hz / 500.0 - 1.0).abs() < 1e-6, "{measured_hz}");
    assert!(!sound.text().contains("stamps"), "{}", sound.text());

    // The same stamps by a timer that is 1000 ppm faster.
    let header = Reader::open(&path).expect("a capture").header().clone();
    let timer_hz = header.board.timer_hz;
    let faster = timer_hz + timer_hz / 1000;
    edited(
        &path,
        &format!("\"timer_hz\":{timer_hz}"),
        &format!("\"timer_hz\":{faster}"),
    );
    let off = analysis();
    let measured_hz = off.source.measured_rate_hz.expect("four seconds of stamps");
    assert!((measured_hz / 500.5 - 1.0).abs() < 1e-6, "{measured_hz}");
    let told = off.text();
    assert!(
        told.contains("500.5000/s, +1000 ppm from the rate"),
        "{told}"
    );
    assert!(off.page().contains("+1000 ppm from the rate"));
}

/// A board with firmware from before calibrations were kept, which does not understand the question for one.
struct Unaware {
    board: VirtualConnect,
    asked: Arc<AtomicU32>,
}

struct UnawarePort {
    board: Box<dyn Port>,
    asked: Arc<AtomicU32>,
}

impl Connect for Unaware {
    fn name(&self) -> String {
        "unaware".to_owned()
    }

    fn waits(&self) -> bool {
        true
    }

    fn clock(&self) -> Clock {
        self.board.clock()
    }

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        Ok(Box::new(UnawarePort {
            board: self.board.open()?,
            asked: Arc::clone(&self.asked),
        }))
    }
}

impl Read for UnawarePort {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        self.board.read(buf)
    }
}

impl Write for UnawarePort {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        let mut decoder: Decoder = Decoder::default();
        let mut frame = buf;
        let mut told = buf.to_vec();
        while let Some(message) = decoder.next(&mut frame) {
            if let Ok(ToBoard::Command(command)) = message
                && matches!(command.request, Request::ReadSensorCalibration(_))
            {
                self.asked.fetch_add(1, Ordering::Relaxed);
                // Ahead of the end of the frame: as little of it is understood as of one that is damaged.
                let last = told.len() - 2;
                told[last] ^= 1;
            }
        }
        self.board.write_all(&told)?;
        Ok(buf.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.board.flush()
    }
}

/// The header of a record, and the board's time until it began.
fn begun(asked: Option<&Arc<AtomicU32>>, kept: &SensorCalibration) -> (Header, Duration) {
    let board = VirtualConnect::published(4, 0.0);
    let mut flash = board.kept.lock().expect("nobody panics with it");
    Kept::replace(&mut *flash, kept.range, Some(*kept)).expect("the flash is sound");
    drop(flash);
    let clock = board.clock();
    let connect: Box<dyn Connect> = match asked {
        Some(asked) => Box::new(Unaware {
            board,
            asked: Arc::clone(asked),
        }),
        None => Box::new(board),
    };
    let plan = Plan {
        samples: Some(100),
        ..Plan::default()
    };
    let before = clock.now();
    let live = BoardSource::start(connect, plan, None, Stop::default());
    let took = clock.now().duration_since(before);
    let header = live.expect("the board starts").header().clone();
    (header, took)
}

#[test]
fn a_board_that_keeps_no_calibrations_does_not_delay_the_start() {
    let kept = SensorCalibration {
        gravity_um_s2: 9_810_000,
        rows: [370_000_000, 1, 370_000_000, 2, 3, 370_000_000],
        ..SensorCalibration::default()
    };
    let (aware, usual) = begun(None, &kept);
    assert_eq!(aware.calibration, Some(kept));
    let asked = Arc::default();
    let (unaware, took) = begun(Some(&asked), &kept);
    assert_eq!(unaware.calibration, None);
    assert!(unaware.axes.iter().all(|axis| axis.zero == 0.0));
    let asked = asked.load(Ordering::Relaxed);
    assert!(asked > 1, "a question that was lost is asked again");
    // A command is 0.4 s on its way to a virtual board; not one reply was waited for in vain.
    let more = took.saturating_sub(usual);
    assert!(more < Patience::default().wait, "{took:?}, {usual:?}");
}
