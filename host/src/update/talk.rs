//! One question at a time to a loader.

use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

use inm_protocol::update::{FromLoader, LOADER, LoaderStatus, ToLoader};
use inm_protocol::{Decoder, Hello, MAX_FRAME, encode};

use super::UpdateError;
use crate::link::{Clock, Connect, LinkError, Port};

/// Times that a loader is asked the same before it is given up: a byte lost on the line costs one.
const TRIES: u32 = 3;

/// A port, and who is behind it.
pub struct Talk {
    port: Box<dyn Port>,
    name: String,
    clock: Clock,
    decoder: Decoder,
}

impl Talk {
    /// Opens the port; nothing is said yet.
    pub fn open(connect: &mut dyn Connect) -> Result<Self, UpdateError> {
        Ok(Self {
            port: connect.open().map_err(UpdateError::Link)?,
            name: connect.name(),
            clock: connect.clock(),
            decoder: Decoder::new(),
        })
    }

    /// Name of the port.
    pub fn name(&self) -> String {
        self.name.clone()
    }

    /// The time by which it waits.
    pub fn now(&self) -> Instant {
        self.clock.now()
    }

    /// The last hello that came.
    pub fn hello(&self) -> Option<&Hello> {
        self.decoder.hello()
    }

    /// From now on no hello has come yet.
    pub fn forget_hello(&mut self) {
        self.decoder = Decoder::new();
    }

    /// Says something, and does not wait for what comes of it.
    pub fn say(&mut self, message: &ToLoader) -> Result<(), UpdateError> {
        // A zero first ends whatever noise the board believes to be a frame.
        let mut frame = [0; MAX_FRAME + 1];
        let sent = encode(message, &mut frame[1..]).map_err(io::Error::other);
        let sent = sent.and_then(|len| {
            self.port.write_all(&frame[..=len])?;
            self.port.flush()
        });
        sent.map_err(|source| self.gone(source))
    }

    /// What the loader says next, up to the end of the wait.
    pub fn hear(&mut self, wait: Duration) -> Result<Option<FromLoader>, UpdateError> {
        let deadline = self.now() + wait;
        let mut buf = [0; 4096];
        while self.now() < deadline {
            let len = match self.port.read(&mut buf) {
                Ok(len) => len,
                Err(error) if error.kind() == ErrorKind::TimedOut => 0,
                Err(source) => return Err(self.gone(source)),
            };
            let mut bytes = &buf[..len];
            let mut said = None;
            // The last of several: those before it answer what was said before.
            while let Some(met) = self.decoder.next::<FromLoader>(&mut bytes) {
                said = met.ok().or(said);
            }
            if said.is_some() {
                return Ok(said);
            }
        }
        Ok(None)
    }

    /// Asks, and says it again where no answer comes in time.
    pub fn ask(&mut self, message: &ToLoader, wait: Duration) -> Result<LoaderStatus, UpdateError> {
        for _ in 0..TRIES {
            self.say(message)?;
            match self.hear(wait)? {
                Some(FromLoader::Status(status)) => return Ok(status),
                Some(FromLoader::Refused(refusal)) => {
                    return Err(UpdateError::Refused {
                        port: self.name(),
                        refusal,
                    });
                }
                None => {}
            }
        }
        Err(self.who_is_silent(wait)?)
    }

    /// Why no answer comes: a program has taken the loader's place, which understands short frames only, or
    /// nobody is there.
    fn who_is_silent(&mut self, wait: Duration) -> Result<UpdateError, UpdateError> {
        self.forget_hello();
        self.say(&ToLoader::Status)?;
        self.hear(wait)?;
        let program = self.hello().filter(|hello| hello.version != LOADER);
        Ok(match program {
            Some(_) => UpdateError::BrokenOff { port: self.name() },
            None => UpdateError::Nobody { port: self.name() },
        })
    }

    fn gone(&self, source: io::Error) -> UpdateError {
        UpdateError::Link(LinkError::Gone {
            port: self.name(),
            source,
        })
    }
}
