//! A stream that broke off: the port went away, or the board behind it fell silent or stopped. The
//! board is looked for until the plan's patience is over, and streams again with the same settings.

use std::thread;
use std::time::{Duration, Instant};

use inm_protocol::{Identity, Note, Request, Settings};
use jiff::Timestamp;

use super::BoardSource;
use super::talk::Failed;
use crate::link::{Client, Expect, LinkError, open_to_record};
use crate::source::SourceError;
use crate::source::frames::Frames;

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

/// The board is being looked for.
pub(super) struct Search {
    broken: Broken,
    /// Whether a port is open.
    open: bool,
    deadline: Instant,
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
            self.heard = (intact, self.client.now());
        }
        let since = self.client.now().duration_since(self.heard.1);
        if self.frames.status().stopped {
            Some(Broken::Stopped)
        } else {
            (since > self.plan.patience.silence).then_some(Broken::Silent { since })
        }
    }

    /// The stream broke off: says so, and has the board looked for.
    pub(super) fn begin_search(&mut self, broken: Broken) -> Result<(), SourceError> {
        let open = !matches!(broken, Broken::Port(_));
        self.note(broken.note())?;
        self.frames.pause();
        if !open {
            self.client.close();
        }
        let Some(patience) = self.plan.reconnect else {
            return Err(broken.error(self.connect.name()).into());
        };
        self.search = Some(Search {
            broken,
            open,
            deadline: Instant::now() + patience,
        });
        Ok(())
    }

    /// One attempt to find the board and to have it stream; whatever fails is tried again until the
    /// patience is over.
    pub(super) fn look(&mut self, mut search: Search) -> Result<(), SourceError> {
        let failed = match self.take_up(&mut search.open) {
            Ok(()) => return Ok(()),
            Err(Failed::Capture(error)) => return Err(error.into()),
            Err(Failed::Link(error)) => error,
        };
        if Instant::now() < search.deadline {
            self.search = Some(search);
            thread::sleep(RETRY);
            return Ok(());
        }
        let error = match failed {
            LinkError::NoReply { .. } | LinkError::Open { .. } | LinkError::Gone { .. } => {
                search.broken.error(self.connect.name())
            }
            said => said,
        };
        Err(error.into())
    }

    /// `open` is whether the port is.
    fn take_up(&mut self, open: &mut bool) -> Result<(), Failed> {
        let before = self.frames.next_index();
        let streams = if *open {
            self.ask_to_stream()
        } else {
            let port = open_to_record(self.connect.as_mut())?;
            let client = Client::new(port, self.connect.name(), self.plan.patience);
            self.client = client.behind(&self.client);
            *open = true;
            self.recognise().and_then(|()| self.ask_to_stream())
        };
        // Samples that come are a stream, whatever happened to an answer.
        let streams = match streams {
            Err(Failed::Link(LinkError::NoReply { .. })) if self.frames.next_index() != before => {
                Ok(())
            }
            other => other,
        };
        if let Err(Failed::Link(error)) = &streams {
            let other = matches!(error, LinkError::OtherBoard { .. });
            if other || matches!(error, LinkError::Gone { .. }) {
                *open = false;
                self.client.close();
            }
            if other {
                self.connect.reject();
            }
        }
        streams?;
        self.heard = (self.frames.intact(), self.client.now());
        self.pairs.pass_over(self.frames.status());
        self.note(Note::StreamBack { unix_ms: now_ms() })
    }

    /// Looks which board is behind a port that was opened anew. Nothing of another board's enters
    /// the record: what arrives waits until it is known whose it is.
    fn recognise(&mut self) -> Result<(), Failed> {
        let mut waiting = Vec::new();
        let mut frames = Frames::default();
        let answer = self.client.request(Request::Identify, |bytes, id| {
            waiting.extend_from_slice(bytes);
            frames.push(bytes);
            Ok::<_, LinkError>(frames.take_reply(id))
        })?;
        let identity = Identity::from_answer(answer)
            .ok_or_else(|| self.client.wrong_answer(Request::Identify))?;
        self.check_identity(&identity)?;
        self.note(Note::PortBack { unix_ms: now_ms() })?;
        self.talk().arrived(&waiting)
    }

    /// Has the board stream, if it does not.
    fn ask_to_stream(&mut self) -> Result<(), Failed> {
        let identity: Identity = self.talk().ask(Request::Identify)?;
        self.check_identity(&identity)?;
        let range = self.header.board.range;
        let same = identity.range == range;
        if same && !self.frames.status().stopped && self.hears_samples()? {
            return Ok(());
        }
        let () = self.talk().ask(Request::Stop)?;
        if !same {
            // A board that started again is on its fine range.
            let () = self.talk().ask(Request::SelectRange(range))?;
        }
        let wanted = self.header.settings;
        let _: Settings = self.talk().ask(Request::Configure(wanted))?;
        let registers = self.talk().ask(Request::ReadRegisters)?;
        self.check_calibration(&registers)?;
        let _: Settings = self.talk().ask(Request::Start)?;
        Ok(())
    }

    /// Whether the board streams on, as it does when only the cable was away.
    fn hears_samples(&mut self) -> Result<bool, Failed> {
        let before = self.frames.next_index();
        let deadline = self.client.now() + NEXT_BATCH;
        let mut buf = [0; 4096];
        while self.client.now() < deadline {
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
