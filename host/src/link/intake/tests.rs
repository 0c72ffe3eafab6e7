use std::time::{Duration, Instant};

use inm_protocol::{Decoder, ToHost};

use super::*;

/// Sends these bytes, some at a time, and then nothing; tells when all are read.
struct Sends {
    bytes: VecDeque<u8>,
    all_read: Sender<()>,
}

impl Read for Sends {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let most = buf.len().min(100);
        match self.bytes.read(&mut buf[..most])? {
            0 => {
                let _ = self.all_read.send(());
                thread::sleep(Duration::from_millis(1));
                Err(ErrorKind::TimedOut.into())
            }
            len => Ok(len),
        }
    }
}

impl Write for Sends {
    /// More to read with each frame.
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        self.bytes.extend(buf);
        Ok(buf.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn sends(len: usize) -> (Box<Sends>, Receiver<()>) {
    let (all_read, read) = mpsc::channel();
    let bytes = (0..len).map(|i| 1 + (i % 250) as u8).collect();
    (Box::new(Sends { bytes, all_read }), read)
}

fn take(intake: &mut Intake, len: usize) -> Vec<u8> {
    let mut taken = Vec::new();
    let deadline = Instant::now() + Duration::from_secs(20);
    while taken.len() < len && Instant::now() < deadline {
        let mut buf = [0; 64];
        let most = buf.len().min(len - taken.len());
        match intake.read(&mut buf[..most]) {
            Ok(len) => taken.extend_from_slice(&buf[..len]),
            Err(error) => assert!(is_wait(&error), "{error}"),
        }
    }
    taken
}

#[test]
fn a_port_is_read_while_nobody_takes_what_arrives() {
    let (port, read) = sends(100_000);
    let mut intake = Intake::new(port);
    // Nothing is taken, and yet the port is empty.
    read.recv_timeout(Duration::from_secs(20)).expect("read");
    let taken = take(&mut intake, 100_000);
    let expected: Vec<u8> = (0..100_000).map(|i| 1 + (i % 250) as u8).collect();
    assert!(taken == expected);
}

#[test]
fn what_finds_no_room_is_counted_and_dated_at_its_place() {
    let (port, read) = sends(1000);
    let before = Timestamp::now().as_millisecond();
    let mut intake = Intake::with_room(port, 600);
    read.recv_timeout(Duration::from_secs(20)).expect("read");
    let kept = take(&mut intake, 600);
    assert_eq!(kept.len(), 600);
    // What comes now finds room, behind the note of what is lost.
    intake.write_all(&[7; 10]).expect("written");
    intake.flush().expect("sent");
    let mut decoder = Decoder::new();
    let mut note = None;
    while note.is_none() {
        let byte = take(&mut intake, 1);
        assert_eq!(byte.len(), 1, "no note comes");
        note = decoder.next::<ToHost>(&mut &byte[..]);
    }
    let Some(Ok(ToHost::Note(Note::Overrun {
        unix_ms,
        until_ms,
        bytes,
    }))) = note
    else {
        panic!("{note:?}");
    };
    assert_eq!(bytes, 400);
    assert!(before <= unix_ms && unix_ms <= until_ms);
    assert_eq!(take(&mut intake, 10), [7; 10]);
}

#[test]
fn a_port_that_is_dropped_is_closed() {
    let (port, read) = sends(0);
    let intake = Intake::new(port);
    read.recv_timeout(Duration::from_secs(20)).expect("read");
    drop(intake);
    // The port's own end of the channel is gone with it.
    while read.try_recv().is_ok() {}
    assert_eq!(read.try_recv(), Err(mpsc::TryRecvError::Disconnected));
}
