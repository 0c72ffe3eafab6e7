//! A board as a source: on a serial port, or virtual.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use inm_protocol::{AXES, Identity, Note, REGISTERS, Reply, Request, Settings};
use jiff::Timestamp;

use super::assemble::Losses;
use super::audit::Proof;
use super::frames::{Frames, Status};
use super::{Chunk, Source, SourceError};
use crate::capture::{Header, Writer};
use crate::link::{Client, Connect, Expect, LinkError, Patience};
use crate::signal::Signal;

/// How a board is to record.
#[derive(Debug, Clone, Default)]
pub struct Plan {
    /// Settings to ask for; `None` leaves the board's.
    pub settings: Option<Settings>,
    /// Samples an axis after which to stop; `None` runs until told to.
    pub samples: Option<u64>,
    /// Waits for replies.
    pub patience: Patience,
    /// How long to wait for a port that went away; `None` gives up at once.
    pub reconnect: Option<Duration>,
}

/// Ends a recording from another thread or a signal handler: the board is told to stop, what
/// is under way is drained, the capture gets its end note.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks for the end.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the end was asked for.
    pub fn requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A board that streams, and the capture that its bytes go to.
pub struct BoardSource {
    connect: Box<dyn Connect>,
    client: Client,
    frames: Frames,
    header: Header,
    signal: Signal,
    capture: Option<Writer>,
    plan: Plan,
    stop: Stop,
    ended: bool,
    /// When the board was last asked to begin its bins anew.
    asked: Option<Instant>,
    /// Why it ended, where it was not on purpose.
    failure: Option<SourceError>,
}

/// Between two attempts to open a port that went away.
const RETRY: Duration = Duration::from_millis(300);

/// Between two requests to begin the bins anew: the answer to the first is that far ahead.
const ASK_AGAIN: Duration = Duration::from_secs(1);

/// A board that streams sends a batch at least this often (32 conversions at 250/s and slack).
const SILENCE: Duration = Duration::from_millis(800);

impl BoardSource {
    /// Connects, checks the version, sets the board up and starts it.
    ///
    /// With `capture`, every byte from the start command on also goes to a new file there.
    ///
    /// # Errors
    /// What the link or the capture file says.
    pub fn start(
        mut connect: Box<dyn Connect>,
        plan: Plan,
        capture: Option<&Path>,
        stop: Stop,
    ) -> Result<Self, SourceError> {
        let mut client = Client::new(connect.open()?, connect.name(), plan.patience);
        let mut frames = Frames::default();
        let mut talk = Talk {
            client: &mut client,
            frames: &mut frames,
            capture: None,
        };

        let _: Identity = talk.ask(Request::Identify)?;
        // A board left streaming by an earlier host first comes to rest.
        let () = talk.ask(Request::Stop)?;
        if let Some(settings) = plan.settings {
            let _: Settings = talk.ask(Request::Configure(settings))?;
        }
        let identity: Identity = talk.ask(Request::Identify)?;
        let registers: [[u8; REGISTERS]; AXES] = talk.ask(Request::ReadRegisters)?;

        let header = Header::new(&identity, registers, Timestamp::now().to_string());
        let mut capture = capture
            .map(|path| Writer::create(path, &header))
            .transpose()?;
        // Only what comes after the start command belongs to the record.
        frames = Frames::default();
        let mut talk = Talk {
            client: &mut client,
            frames: &mut frames,
            capture: capture.as_mut(),
        };
        let _: Settings = talk.ask(Request::Start)?;

        let name = connect.name();
        let signal = header.signal(Path::new(&name))?;
        Ok(Self {
            connect,
            client,
            frames,
            header,
            signal,
            capture,
            plan,
            stop,
            ended: false,
            asked: None,
            failure: None,
        })
    }

    /// What the capture says, or would say, about this record.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Board and link so far.
    pub fn status(&self) -> &Status {
        self.frames.status()
    }

    /// Samples lost and flagged so far.
    pub fn losses(&self) -> Losses {
        self.frames.losses()
    }

    /// Frames that arrived damaged, and their bytes.
    pub fn damaged(&self) -> (u64, u64) {
        self.frames.damaged()
    }

    /// Samples an axis so far, lost ones included.
    pub fn next_index(&self) -> u64 {
        self.frames.next_index()
    }

    /// The capture, if there is one.
    pub fn capture_path(&self) -> Option<&Path> {
        self.capture.as_ref().map(Writer::path)
    }

    /// Bytes in the capture so far.
    pub fn captured_bytes(&self) -> u64 {
        self.capture.as_ref().map_or(0, Writer::bytes)
    }

    fn read_more(&mut self) -> Result<(), SourceError> {
        let mut buf = [0; 1 << 14];
        match self.client.read(&mut buf) {
            Ok(len) => {
                let mut talk = self.talk();
                talk.arrived(&buf[..len])?;
                self.frames.flush();
                self.restore_proof()
            }
            Err(gone) => self.reconnect(gone),
        }
    }

    /// Asks the board to begin its bins anew where a loss has made them incomparable. The
    /// samples do not wait for the answer, which is found among them.
    fn restore_proof(&mut self) -> Result<(), SourceError> {
        let early = self.asked.is_some_and(|asked| asked.elapsed() < ASK_AGAIN);
        if early || !self.frames.wants_new_beginning() {
            return Ok(());
        }
        self.asked = Some(Instant::now());
        match self.client.tell(Request::RestartBins) {
            Ok(()) => Ok(()),
            Err(gone) => self.reconnect(gone),
        }
    }

    /// The port went away: waits for it, and goes on where the board is.
    fn reconnect(&mut self, gone: LinkError) -> Result<(), SourceError> {
        self.note(Note::PortLost { unix_ms: now_ms() })?;
        self.frames.finish();
        let Some(patience) = self.plan.reconnect else {
            return Err(gone.into());
        };
        let deadline = Instant::now() + patience;
        let port = loop {
            if self.stop.requested() {
                return Ok(());
            }
            match self.connect.open() {
                Ok(port) => break port,
                Err(_) if Instant::now() < deadline => std::thread::sleep(RETRY),
                Err(_) => return Err(gone.into()),
            }
        };
        self.client = Client::new(port, self.connect.name(), self.plan.patience);
        self.note(Note::PortBack { unix_ms: now_ms() })?;
        if !self.hears_samples()? {
            let () = self.talk().ask(Request::Stop)?;
            let wanted = self.header.settings;
            let _: Settings = self.talk().ask(Request::Configure(wanted))?;
            let _: Settings = self.talk().ask(Request::Start)?;
        }
        Ok(())
    }

    /// Whether the board streams on, as it does when only the cable was away.
    fn hears_samples(&mut self) -> Result<bool, SourceError> {
        let before = self.frames.next_index();
        let deadline = Instant::now() + SILENCE;
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

    fn end(&mut self) -> Result<(), SourceError> {
        self.ended = true;
        // The board may be gone for good; what was recorded stands either way.
        let stopped: Result<(), SourceError> = self.talk().ask(Request::Stop);
        self.note(Note::End { unix_ms: now_ms() })?;
        self.frames.finish();
        stopped
    }

    /// Ends the record because of `error`: the board is told to stop, if it still listens.
    fn break_off(&mut self, error: SourceError) {
        if !self.ended {
            self.ended = true;
            let mut talk = self.talk();
            talk.capture = None;
            let _: Result<(), SourceError> = talk.ask(Request::Stop);
        }
        self.frames.finish();
        self.failure.get_or_insert(error);
    }

    fn note(&mut self, note: Note) -> Result<(), SourceError> {
        if let Some(capture) = &mut self.capture {
            capture.note(note)?;
        }
        Ok(())
    }

    fn talk(&mut self) -> Talk<'_> {
        Talk {
            client: &mut self.client,
            frames: &mut self.frames,
            capture: self.capture.as_mut(),
        }
    }

    fn is_complete(&self) -> bool {
        self.stop.requested()
            || self
                .plan
                .samples
                .is_some_and(|limit| self.frames.next_index() >= limit)
    }
}

impl Source for BoardSource {
    fn signal(&self) -> &Signal {
        &self.signal
    }

    fn expected_len(&self) -> Option<u64> {
        self.plan.samples
    }

    fn proof(&self) -> Option<Proof> {
        Some(self.frames.proof())
    }

    /// The next chunk. What arrived before an error is delivered before the error is.
    fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError> {
        loop {
            if let Some(chunk) = self.frames.pop() {
                return Ok(Some(chunk));
            }
            if self.ended {
                return self.failure.take().map_or(Ok(None), Err);
            }
            let done = if self.is_complete() {
                self.end()
            } else {
                self.read_more()
            };
            if let Err(error) = done {
                self.break_off(error);
            }
        }
    }
}

/// One exchange with the board, everything that arrives meanwhile kept.
struct Talk<'a> {
    client: &'a mut Client,
    frames: &'a mut Frames,
    capture: Option<&'a mut Writer>,
}

impl Talk<'_> {
    fn ask<T: Expect>(&mut self, request: Request) -> Result<T, SourceError> {
        let Self {
            client,
            frames,
            capture,
        } = self;
        let answer = client.request(request, |bytes, id| -> Result<Option<Reply>, SourceError> {
            keep(bytes, frames, capture.as_deref_mut())?;
            Ok(frames.take_reply(id))
        });
        let answer = match (answer, frames.status().foreign_version) {
            (Err(_), Some(theirs)) => Err(client.foreign_version(theirs).into()),
            (answer, _) => answer,
        }?;
        T::from_answer(answer).ok_or_else(|| client.wrong_answer(request).into())
    }

    fn arrived(&mut self, bytes: &[u8]) -> Result<(), SourceError> {
        keep(bytes, self.frames, self.capture.as_deref_mut())
    }
}

/// Into the capture first: what cannot be decoded is worth keeping too.
fn keep(
    bytes: &[u8],
    frames: &mut Frames,
    capture: Option<&mut Writer>,
) -> Result<(), SourceError> {
    if bytes.is_empty() {
        return Ok(());
    }
    let written = capture.map_or(Ok(()), |capture| capture.append(bytes));
    frames.push(bytes);
    Ok(written?)
}

fn now_ms() -> i64 {
    Timestamp::now().as_millisecond()
}
