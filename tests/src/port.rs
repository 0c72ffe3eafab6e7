//! Ports with faults, wrapped around sound ones.

use std::io::{self, Read, Write};
use std::sync::{Arc, Mutex};

use inm_host::link::{Connect, LinkError, Port};

/// What happens to the bytes from the board.
#[derive(Debug, Clone, Default)]
pub struct Damage {
    /// Positions in the stream (bytes since the first connection) at which a bit is flipped.
    pub flip: Vec<u64>,
    /// Positions of bytes that get lost.
    pub drop: Vec<u64>,
    /// Positions at which the port vanishes.
    pub vanish: Vec<u64>,
    /// How many attempts to open the port fail after it has vanished.
    pub failing_opens: u32,
}

/// Connects through a [`Damage`].
pub struct Damaged {
    inner: Shared,
    damage: Damage,
    position: Arc<Mutex<u64>>,
    failures_left: u32,
    vanished: Arc<Mutex<usize>>,
}

/// The one sound port behind all connections: the board goes on while the cable is out.
type Shared = Arc<Mutex<Option<Box<dyn Port>>>>;

impl Damaged {
    /// Puts `damage` between the host and the board behind `connect`.
    ///
    /// # Errors
    /// As `connect.open()`.
    pub fn new(connect: &mut dyn Connect, damage: Damage) -> Result<Self, LinkError> {
        Ok(Self {
            inner: Arc::new(Mutex::new(Some(connect.open()?))),
            damage,
            position: Arc::default(),
            failures_left: 0,
            vanished: Arc::default(),
        })
    }
}

impl Connect for Damaged {
    fn name(&self) -> String {
        "damaged".to_owned()
    }

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        let vanished = *self.vanished.lock().expect("not poisoned");
        if vanished > 0 && self.failures_left < self.damage.failing_opens {
            self.failures_left += 1;
            return Err(LinkError::Gone {
                port: self.name(),
                source: io::ErrorKind::NotFound.into(),
            });
        }
        Ok(Box::new(DamagedPort {
            inner: Arc::clone(&self.inner),
            damage: self.damage.clone(),
            position: Arc::clone(&self.position),
            vanished: Arc::clone(&self.vanished),
        }))
    }
}

struct DamagedPort {
    inner: Shared,
    damage: Damage,
    position: Arc<Mutex<u64>>,
    vanished: Arc<Mutex<usize>>,
}

impl Read for DamagedPort {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let mut position = self.position.lock().expect("not poisoned");
        let mut vanished = self.vanished.lock().expect("not poisoned");
        if self
            .damage
            .vanish
            .get(*vanished)
            .is_some_and(|&at| *position >= at)
        {
            *vanished += 1;
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let mut inner = self.inner.lock().expect("not poisoned");
        let port = inner.as_mut().ok_or(io::ErrorKind::BrokenPipe)?;
        let len = port.read(buf)?;
        let mut kept = 0;
        for i in 0..len {
            let at = *position + i as u64;
            if self.damage.drop.contains(&at) {
                continue;
            }
            let flip = u8::from(self.damage.flip.contains(&at)) << (at % 8);
            buf[kept] = buf[i] ^ flip;
            kept += 1;
        }
        *position += len as u64;
        if len > 0 && kept == 0 {
            return Err(io::ErrorKind::Interrupted.into());
        }
        Ok(kept)
    }
}

impl Write for DamagedPort {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        let mut inner = self.inner.lock().expect("not poisoned");
        inner.as_mut().ok_or(io::ErrorKind::BrokenPipe)?.write(buf)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
