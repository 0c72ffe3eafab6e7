//! A port that is read whatever the rest of the program does.
//!
//! ```text
//!   port <--> a thread that does nothing else --> queue of a minute --> who records
//! ```
//!
//! A UART sends whether or not somebody reads, and the system keeps some 4 kB (85 ms of a full link)
//! for a program that does not. Where even the queue is full, what arrives is thrown away, counted,
//! and a note with the count stands among the bytes at its place.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use inm_protocol::Note;
use jiff::Timestamp;

use super::port::{READ_TIMEOUT, is_wait};
use super::{Connect, LinkError, Port};
use crate::capture::note_frame;

/// Bytes that wait at most: a minute of a link that is full at 921 600 bit/s.
const ROOM: usize = 60 * 92_160;

/// The near end of the queue, a port itself; the port behind it is closed when this is dropped.
pub struct Intake {
    shared: Arc<Shared>,
    to_port: Option<Sender<Vec<u8>>>,
    written: Vec<u8>,
    reader: Option<JoinHandle<()>>,
}

/// What the two threads share.
struct Shared {
    queue: Mutex<Queue>,
    arrived: Condvar,
}

/// Bytes on their way.
struct Queue {
    bytes: VecDeque<u8>,
    room: usize,
    overrun: Option<Overrun>,
    /// Why nothing more will come.
    gone: Option<ErrorKind>,
}

/// What is being thrown away.
struct Overrun {
    from_ms: i64,
    bytes: u64,
}

impl Intake {
    /// Begins to read `port`.
    pub fn new(port: Box<dyn Port>) -> Self {
        Self::with_room(port, ROOM)
    }

    fn with_room(mut port: Box<dyn Port>, room: usize) -> Self {
        let shared = Arc::new(Shared {
            queue: Mutex::new(Queue {
                bytes: VecDeque::new(),
                room,
                overrun: None,
                gone: None,
            }),
            arrived: Condvar::new(),
        });
        let (to_port, frames) = mpsc::channel();
        let far = Arc::clone(&shared);
        let reader = thread::spawn(move || {
            let ended = carry(port.as_mut(), &frames, &far);
            far.lock().end(ended);
            far.arrived.notify_one();
        });
        Self {
            shared,
            to_port: Some(to_port),
            written: Vec::new(),
            reader: Some(reader),
        }
    }
}

/// Opens the port in such a way that nothing is lost while the caller does something else.
///
/// # Errors
/// [`LinkError::Open`].
pub fn open_to_record(connect: &mut dyn Connect) -> Result<Box<dyn Port>, LinkError> {
    let port = connect.open()?;
    Ok(if connect.waits() {
        port
    } else {
        Box::new(Intake::new(port))
    })
}

/// Reads until the port is gone or the near end is dropped, which has no error.
fn carry(port: &mut dyn Port, frames: &Receiver<Vec<u8>>, shared: &Shared) -> Option<ErrorKind> {
    let mut buf = [0; 1 << 14];
    loop {
        loop {
            match frames.try_recv() {
                Ok(frame) => match port.write_all(&frame) {
                    Ok(()) => {}
                    // Nobody takes it: as good as lost on the way, and asked again.
                    Err(error) if is_wait(&error) => {}
                    Err(error) => return Some(error.kind()),
                },
                Err(mpsc::TryRecvError::Empty) => break,
                Err(mpsc::TryRecvError::Disconnected) => return None,
            }
        }
        match port.read(&mut buf) {
            Ok(len) => {
                shared.lock().put(&buf[..len]);
                shared.arrived.notify_one();
            }
            Err(error) if is_wait(&error) => {}
            Err(error) => return Some(error.kind()),
        }
    }
}

impl Shared {
    /// A thread that panicked had nothing half done: every change is one call.
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Queue {
    /// Takes bytes, or throws them away. Once it does, it goes on until half of the room is free:
    /// one long gap is better than many.
    fn put(&mut self, bytes: &[u8]) {
        if self.overrun.is_some() && self.bytes.len() <= self.room / 2 {
            self.end_overrun();
        }
        let full = self.bytes.len() + bytes.len() > self.room;
        if full || self.overrun.is_some() {
            let overrun = self.overrun.get_or_insert_with(|| Overrun {
                from_ms: Timestamp::now().as_millisecond(),
                bytes: 0,
            });
            overrun.bytes += bytes.len() as u64;
        } else {
            self.bytes.extend(bytes);
        }
    }

    fn end_overrun(&mut self) {
        if let Some(Overrun { from_ms, bytes }) = self.overrun.take() {
            self.bytes.extend(note_frame(Note::Overrun {
                unix_ms: from_ms,
                until_ms: Timestamp::now().as_millisecond(),
                bytes,
            }));
        }
    }

    fn end(&mut self, why: Option<ErrorKind>) {
        self.end_overrun();
        self.gone = why;
    }
}

impl Read for Intake {
    /// What waits, at once; else what comes within the time that a port waits.
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let queue = self.shared.lock();
        let nothing = |queue: &mut Queue| queue.bytes.is_empty() && queue.gone.is_none();
        let waited = self
            .shared
            .arrived
            .wait_timeout_while(queue, READ_TIMEOUT, nothing);
        let (mut queue, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if queue.bytes.is_empty() {
            return Err(queue.gone.unwrap_or(ErrorKind::TimedOut).into());
        }
        queue.bytes.read(buf)
    }
}

impl Write for Intake {
    /// Leaves with the next [`Write::flush`], a frame at once.
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        self.written.extend_from_slice(buf);
        Ok(buf.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let frame = std::mem::take(&mut self.written);
        let sent = self.to_port.as_ref().map(|to_port| to_port.send(frame));
        sent.and_then(Result::ok)
            .ok_or_else(|| ErrorKind::BrokenPipe.into())
    }
}

impl Drop for Intake {
    /// Waits for the thread, so that the port is closed and can be opened again.
    fn drop(&mut self) {
        self.to_port = None;
        if let Some(reader) = self.reader.take() {
            let _ = reader.join();
        }
    }
}

#[cfg(test)]
mod tests;
