//! What is on the disk after a loss of power, at any moment of a recording: every prefix of what the
//! recording wrote and brought to the disk is read back.

use std::io::{self, Cursor, Write};
use std::path::Path;
use std::sync::{Arc, Mutex};

use inm_host::internals::capture::{Durable, Header, Writer};
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::virtual_board::VirtualConnect;
use inm_protocol::{AXES, Settings};
use inm_tests::night::conversions;
use inm_tests::record::Record;

/// What was done to the file.
enum Step {
    Wrote(Vec<u8>),
    Synced,
    NameSynced,
}

/// A file that notes down what is done to it.
struct Noted(Arc<Mutex<Vec<Step>>>);

impl Noted {
    fn note(&self, step: Step) {
        self.0.lock().expect("not poisoned").push(step);
    }
}

impl Write for Noted {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.note(Step::Wrote(bytes.to_vec()));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Durable for Noted {
    fn sync(&mut self) -> io::Result<()> {
        self.note(Step::Synced);
        Ok(())
    }

    fn sync_name(&mut self) -> io::Result<()> {
        self.note(Step::NameSynced);
        Ok(())
    }
}

/// Seconds of the recording, in real time: several times the period of the disk.
const SECONDS: u64 = 3;

/// Records in real time; what was done to the file.
fn record() -> Vec<Step> {
    let steps = Arc::new(Mutex::new(Vec::new()));
    let file = Noted(Arc::clone(&steps));
    let create = |header: &Header| Writer::begin(Box::new(file), Path::new("noted"), header);
    let plan = Plan {
        settings: Some(Settings::default()),
        samples: Some(2000 * SECONDS),
        ..Plan::default()
    };
    let board = Box::new(VirtualConnect::published(3, 1.0));
    let mut live = BoardSource::start_into(board, plan, Some(create), Stop::default())
        .expect("the virtual board starts");
    let received = Record::read(&mut live);
    assert!(received.error.is_none(), "{:?}", received.error);
    drop(live);
    let steps = Arc::into_inner(steps).expect("the file is closed");
    steps.into_inner().expect("not poisoned")
}

fn read(bytes: &[u8]) -> Result<Record, String> {
    let input = Box::new(Cursor::new(bytes.to_vec()));
    let source = CaptureSource::read(input, Path::new("cut"));
    source
        .map(|mut source| Record::read(&mut source))
        .map_err(|error| error.to_string())
}

/// Whatever became of what the disk had not got, all frames up to the last sync are read.
fn check(synced: &[u8], waiting: &[u8], whole: &[[u32; AXES]]) {
    let held = conversions(synced) as usize;
    let half = &waiting[..waiting.len() / 2];
    let tails = [
        Vec::new(),
        half.to_vec(),
        waiting.to_vec(),
        // The length reached the disk and the bytes did not.
        vec![0; waiting.len()],
        [half, &vec![0xff; waiting.len() - half.len()]].concat(),
    ];
    for tail in tails {
        let record = read(&[synced, &tail].concat()).expect("the header is on the disk");
        let codes = record.codes();
        assert!(codes.len() >= held, "{} of {held} conversions", codes.len());
        assert!(whole.starts_with(&codes), "a sample that was not recorded");
        assert_eq!(record.gaps, []);
        assert_eq!(
            record.error.is_some(),
            codes.is_empty(),
            "{:?}",
            record.error
        );
    }
}

#[test]
fn after_a_loss_of_power_all_frames_up_to_the_last_sync_are_read() {
    let steps = record();
    // Header and name before anything of the record.
    assert!(
        matches!(
            &steps[..3],
            [Step::Wrote(_), Step::Synced, Step::NameSynced]
        ),
        "header and name are on the disk at once"
    );
    assert!(matches!(steps.last(), Some(Step::Synced)), "the end, too");
    let all: Vec<u8> = steps
        .iter()
        .filter_map(|step| match step {
            Step::Wrote(bytes) => Some(&bytes[..]),
            _ => None,
        })
        .collect::<Vec<_>>()
        .concat();
    let whole = read(&all).expect("a capture").codes();
    assert!(whole.len() as u64 >= 2000 * SECONDS);
    let syncs = steps.iter().filter(|step| matches!(step, Step::Synced));
    // One a second, the header's and the end's.
    assert!(syncs.count() as u64 > SECONDS, "once a second");

    let (mut synced, mut waiting) = (Vec::new(), Vec::new());
    for step in &steps {
        match step {
            Step::Wrote(bytes) => waiting.extend_from_slice(bytes),
            Step::Synced => synced.append(&mut waiting),
            Step::NameSynced => {}
        }
        if synced.is_empty() {
            // Nothing was recorded yet, and nobody takes it for a recording.
            assert!(read(&waiting[..waiting.len() / 2]).is_err());
        } else {
            check(&synced, &waiting, &whole);
        }
    }
}
