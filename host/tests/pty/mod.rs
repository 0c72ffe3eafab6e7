//! A virtual board behind a pseudo terminal, which to the program is a serial port.

#![allow(dead_code)] // each test file uses its part

use std::io::{ErrorKind, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use inm_host::internals::link::Connect;
use serialport::{SerialPort, TTYPort};

/// A board on a port of this machine; gone when dropped.
pub struct PtyBoard {
    /// Path of the port.
    pub port: String,
    /// While set, nothing passes in either direction, as with a cable that is out.
    pub parted: Arc<AtomicBool>,
    /// Bytes that waited for the program at most; none did where there was no room for them.
    pub most_waiting: Arc<AtomicUsize>,
    ended: Arc<AtomicBool>,
    pump: Option<JoinHandle<()>>,
}

impl PtyBoard {
    /// Powers a board on.
    pub fn start(board: impl Connect) -> Self {
        Self::with_room(board, 0)
    }

    /// The same behind a driver that holds up to `room` bytes for the program, beyond the few thousand of a
    /// terminal.
    pub fn with_room(mut board: impl Connect, room: usize) -> Self {
        let (mut master, slave) = TTYPort::pair().expect("a pseudo terminal");
        let port = slave.name().expect("it has a path");
        master.set_timeout(Duration::from_millis(1)).expect("set");
        let mut far = board.open().expect("a virtual board opens");
        let (ended, parted) = (
            Arc::new(AtomicBool::new(false)),
            Arc::new(AtomicBool::new(false)),
        );
        let (end, part) = (Arc::clone(&ended), Arc::clone(&parted));
        let most_waiting = Arc::new(AtomicUsize::new(0));
        let most = Arc::clone(&most_waiting);
        let pump = thread::spawn(move || {
            // Held open here, the terminal outlives a program that closes its end.
            let _slave = slave;
            let mut buf = [0; 4096];
            let mut waiting = Vec::new();
            while !end.load(Ordering::Relaxed) {
                if let Ok(len) = master.read(&mut buf) {
                    far.write_all(&buf[..len]).expect("the board listens");
                }
                match far.read(&mut buf) {
                    Ok(len) if !part.load(Ordering::Relaxed) => waiting.extend(&buf[..len]),
                    Ok(_) => {}
                    Err(error) => assert_eq!(error.kind(), ErrorKind::TimedOut),
                }
                while !waiting.is_empty()
                    && let Ok(len) = master.write(&waiting)
                {
                    waiting.drain(..len);
                }
                // A terminal that nobody reads is full at last; a UART sends regardless.
                waiting.truncate(room);
                most.fetch_max(waiting.len(), Ordering::Relaxed);
            }
        });
        Self {
            port,
            parted,
            most_waiting,
            ended,
            pump: Some(pump),
        }
    }
}

impl Drop for PtyBoard {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(pump) = self.pump.take() {
            let _ = pump.join();
        }
    }
}
