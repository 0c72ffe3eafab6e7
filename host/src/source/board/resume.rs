//! A stream that broke off: the port went away, or the board behind it fell silent or stopped. The
//! board is looked for until the plan's patience is over, and streams again with the same settings.

use std::thread;
use std::time::{Duration, Instant};

use inm_protocol::{Identity, Note, Request, Settings};
use jiff::Timestamp;

use super::BoardSource;
use super::talk::Failed;
use crate::link::{Client, LinkError, open_to_record};
use crate::source::SourceError;

/// Between two attempts to find the board.
const RETRY: Duration = Duration::from_millis(300);

/// A board that streams sends a batch at least this often (32 conversions at 250/s and slack).
const NEXT_BATCH: Duration = Duration::from_millis(800);

/// What broke the stream off.
pub(super) enum Broken {
    /// The port went away.
    Port(LinkError),
    /// The port is open, and nothing intact comes through it.
    Silent {
        /// For how long.
        since: Duration,
    },
    /// The board says that it does not stream.
    Stopped,
}

impl Broken {
    /// What the capture is to say of it.
    fn note(&self) -> Note {
        let unix_ms = now_ms();
        match self {
            Self::Port(_) => Note::PortLost { unix_ms },
            Self::Silent { since } => Note::BoardSilent {
                unix_ms: unix_ms - i64::try_from(since.as_millis()).unwrap_or(0),
            },
            Self::Stopped => Note::BoardStopped { unix_ms },
        }
    }

    /// What ends the record if the board is not to be found again.
    fn error(self, port: String) -> LinkError {
        match self {
            Self::Port(gone) => gone,
            Self::Silent { since } => LinkError::Silent { port, since },
            Self::Stopped => LinkError::Stopped { port },
        }
    }
}

impl BoardSource {
    /// What is wrong with a stream whose port is open, if anything.
    pub(super) fn trouble(&mut self) -> Option<Broken> {
        let intact = self.frames.intact();
        if intact != self.heard.0 {
            self.heard = (intact, Instant::now());
        }
        let since = self.heard.1.elapsed();
        if self.frames.status().stopped {
            Some(Broken::Stopped)
        } else {
            (since > self.plan.patience.silence).then_some(Broken::Silent { since })
        }
    }

    /// Waits for the board, and goes on where it is, or starts it again.
    pub(super) fn resume(&mut self, broken: Broken) -> Result<(), SourceError> {
        let mut open = !matches!(broken, Broken::Port(_));
        self.note(broken.note())?;
        self.frames.pause();
        let name = self.connect.name();
        let Some(patience) = self.plan.reconnect else {
            return Err(broken.error(name).into());
        };
        let deadline = Instant::now() + patience;
        while !self.stop.requested() {
            match self.take_up(&mut open) {
                Ok(()) => return Ok(()),
                Err(Failed::Capture(error)) => return Err(error.into()),
                Err(Failed::Link(_)) if Instant::now() < deadline => thread::sleep(RETRY),
                Err(Failed::Link(error)) => {
                    let error = match error {
                        LinkError::NoReply { .. } | LinkError::Open { .. } => broken.error(name),
                        said => said,
                    };
                    return Err(error.into());
                }
            }
        }
        Ok(())
    }

    /// One attempt to find the board and to have it stream. `open` is whether the port is.
    fn take_up(&mut self, open: &mut bool) -> Result<(), Failed> {
        if !*open {
            let port = open_to_record(self.connect.as_mut())?;
            self.client = Client::new(port, self.connect.name(), self.plan.patience);
            *open = true;
            self.note(Note::PortBack { unix_ms: now_ms() })?;
        }
        let streams = self.ask_to_stream();
        if let Err(Failed::Link(LinkError::Gone { .. })) = streams {
            *open = false;
        }
        streams?;
        self.heard = (self.frames.intact(), Instant::now());
        self.note(Note::StreamBack { unix_ms: now_ms() })
    }

    /// Has the board stream, if it does not.
    fn ask_to_stream(&mut self) -> Result<(), Failed> {
        let _: Identity = self.talk().ask(Request::Identify)?;
        if !self.frames.status().stopped && self.hears_samples()? {
            return Ok(());
        }
        let () = self.talk().ask(Request::Stop)?;
        let wanted = self.header.settings;
        let _: Settings = self.talk().ask(Request::Configure(wanted))?;
        let _: Settings = self.talk().ask(Request::Start)?;
        Ok(())
    }

    /// Whether the board streams on, as it does when only the cable was away.
    fn hears_samples(&mut self) -> Result<bool, Failed> {
        let before = self.frames.next_index();
        let deadline = Instant::now() + NEXT_BATCH;
        let mut buf = [0; 4096];
        while Instant::now() < deadline {
            let len = self.client.read(&mut buf)?;
            self.talk().arrived(&buf[..len])?;
            if self.frames.next_index() != before {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// Wall clock, milliseconds since 1970-01-01 UTC.
pub(super) fn now_ms() -> i64 {
    Timestamp::now().as_millisecond()
}
