//! Ports with faults, wrapped around sound ones.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use inm_host::internals::link::{Connect, LinkError, Port};
use inm_protocol::{Answer, Decoder, FRAME_END, Reply, ToHost};

/// What happens to the bytes from the board. Positions count the bytes that it has sent.
#[derive(Debug, Clone, Default)]
pub struct Damage {
    /// Bytes of which one bit is flipped.
    pub flip: Vec<u64>,
    /// Bytes that get lost.
    pub drop: Vec<u64>,
    /// Where the port vanishes.
    pub vanish: Option<u64>,
    /// How many bytes after it has come back it vanishes once more.
    pub vanish_again: Option<u64>,
    /// Whether the board's first answer to a start or a configuration arrives damaged.
    pub garbled_start: bool,
    /// How many attempts to open the port fail after it has vanished.
    pub failing_opens: u32,
    /// Bytes that the board sends into the void before the port is back.
    pub unheard: usize,
}

/// Connects to a board through a [`Damage`]. The board goes on while the cable is out.
pub struct DamagedConnect {
    line: Arc<Mutex<Line>>,
}

struct Line {
    board: Box<dyn Port>,
    damage: Damage,
    position: u64,
    /// The port has vanished; so many attempts to open it again are still to fail.
    away: Option<u32>,
    /// The frame on its way, where answers are damaged.
    frame: Vec<u8>,
    /// Frames that have come to their end.
    whole: VecDeque<u8>,
}

impl DamagedConnect {
    /// Puts `damage` between the host and the board behind `connect`.
    ///
    /// # Errors
    /// As `connect.open()`.
    pub fn new(connect: &mut dyn Connect, damage: Damage) -> Result<Self, LinkError> {
        let line = Line {
            board: connect.open()?,
            damage,
            position: 0,
            away: None,
            frame: Vec::new(),
            whole: VecDeque::new(),
        };
        Ok(Self {
            line: Arc::new(Mutex::new(line)),
        })
    }
}

impl Connect for DamagedConnect {
    fn name(&self) -> String {
        "damaged".to_owned()
    }

    /// As the virtual board behind it.
    fn waits(&self) -> bool {
        true
    }

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        // As the lock of a serial port: the one that is open has to be closed first.
        if Arc::strong_count(&self.line) > 1 {
            let source = io::ErrorKind::ResourceBusy.into();
            return Err(LinkError::Gone {
                port: self.name(),
                source,
            });
        }
        let mut line = lock(&self.line);
        match &mut line.away {
            Some(0) => {
                line.away = None;
                line.send_into_the_void();
                let again = line.damage.vanish_again.take();
                line.damage.vanish = again.map(|bytes| line.position + bytes);
            }
            Some(left) => {
                *left -= 1;
                let source = io::ErrorKind::NotFound.into();
                return Err(LinkError::Gone {
                    port: self.name(),
                    source,
                });
            }
            None => {}
        }
        Ok(Box::new(DamagedPort {
            line: Arc::clone(&self.line),
        }))
    }
}

struct DamagedPort {
    line: Arc<Mutex<Line>>,
}

impl Line {
    fn send_into_the_void(&mut self) {
        let mut left = self.damage.unheard;
        let mut void = [0; 4096];
        while left > 0 {
            let most = left.min(void.len());
            match self.board.read(&mut void[..most]) {
                Ok(len) => {
                    left -= len;
                    self.position += len as u64;
                }
                Err(_) => return,
            }
        }
    }

    /// Reads whole frames, and damages the first answer that carries settings.
    fn read_frames(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let len = self.board.read(buf)?;
        for &byte in &buf[..len] {
            self.frame.push(byte);
            if byte != FRAME_END {
                continue;
            }
            let message = Decoder::new().next::<ToHost>(&mut &self.frame[..]);
            let settings = |reply: &Reply| matches!(reply.result, Ok(Answer::Settings(_)));
            if matches!(&message, Some(Ok(ToHost::Reply(reply))) if settings(reply)) {
                self.frame[2] ^= 1;
                self.damage.garbled_start = false;
            }
            self.whole.extend(self.frame.drain(..));
        }
        if !self.damage.garbled_start {
            self.whole.extend(self.frame.drain(..));
        }
        self.whole.read(buf)
    }

    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        if self.damage.vanish.is_some_and(|at| self.position >= at) {
            self.damage.vanish = None;
            self.away = Some(self.damage.failing_opens);
        }
        if self.away.is_some() {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let len = if !self.whole.is_empty() {
            self.whole.read(buf)?
        } else if self.damage.garbled_start {
            self.read_frames(buf)?
        } else {
            self.board.read(buf)?
        };
        let mut kept = 0;
        for i in 0..len {
            let at = self.position + i as u64;
            if self.damage.drop.contains(&at) {
                continue;
            }
            let flip = u8::from(self.damage.flip.contains(&at)) << (at % 8);
            buf[kept] = buf[i] ^ flip;
            kept += 1;
        }
        self.position += len as u64;
        if kept == 0 {
            Err(io::ErrorKind::Interrupted.into())
        } else {
            Ok(kept)
        }
    }
}

impl Read for DamagedPort {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        lock(&self.line).read(buf)
    }
}

impl Write for DamagedPort {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        let mut line = lock(&self.line);
        if line.away.is_some() {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        line.board.write(buf)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn lock(line: &Mutex<Line>) -> MutexGuard<'_, Line> {
    line.lock().unwrap_or_else(PoisonError::into_inner)
}
