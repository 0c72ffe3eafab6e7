//! A board as a source: on a serial port, or virtual.

mod begin;
mod marks;
mod pairs;
mod plan;
mod proof;
mod resume;
mod same;
mod settings;
mod talk;

use std::path::Path;
use std::time::Instant;

use inm_protocol::{Identity, Note, Request};

use self::begin::{Begun, begin, keep_from};
use self::pairs::Pairs;
use self::resume::{Broken, Search, now_ms};
use self::talk::{Failed, Keep, Talk};
use super::assemble::Losses;
use super::audit::Proof;
use super::frames::{Frames, Status};
use super::{Chunk, Gap, Source, SourceError};
use crate::capture::{CaptureError, Header, Writer, note_frame};
use crate::clocks::Clocks;
use crate::link::{Client, Connect, open_to_record};
use crate::signal::Signal;

pub use self::marks::{MarkError, Marks};
pub use self::plan::{Plan, Stop};
pub use self::settings::{BadSetting, parse_rate, parse_word};

/// A board that streams, and the capture that its bytes go to.
pub struct BoardSource {
    connect: Box<dyn Connect>,
    client: Client,
    frames: Frames,
    identity: Identity,
    header: Header,
    signal: Signal,
    capture: Option<Writer>,
    plan: Plan,
    stop: Stop,
    marks: Marks,
    pairs: Pairs,
    ended: bool,
    /// The stream broke off, and the board is being looked for.
    search: Option<Search>,
    /// Intact frames so far, and when the last of them arrived.
    heard: (u64, Instant),
    /// When the board was last asked to begin its bins anew.
    asked: Option<Instant>,
    /// Why it ended, where it was not on purpose.
    failure: Option<SourceError>,
}

impl BoardSource {
    /// Connects, checks the version, sets the board up and starts it.
    ///
    /// With `capture`, every byte from the start command on also goes to a new file there.
    ///
    /// # Errors
    /// What the link or the capture file says.
    pub fn start(
        connect: Box<dyn Connect>,
        plan: Plan,
        capture: Option<&Path>,
        stop: Stop,
    ) -> Result<Self, SourceError> {
        if let Some(path) = capture {
            // Before the board is asked for anything; creating it asks again.
            Writer::check_new(path)?;
        }
        let create = capture.map(|path| move |header: &Header| Writer::create(path, header));
        Self::start_into(connect, plan, create, stop)
    }

    /// As [`BoardSource::start`], with the capture that `create` makes for its header.
    ///
    /// # Errors
    /// As [`BoardSource::start`], and what `create` says.
    pub fn start_into(
        mut connect: Box<dyn Connect>,
        plan: Plan,
        create: Option<impl FnOnce(&Header) -> Result<Writer, CaptureError>>,
        stop: Stop,
    ) -> Result<Self, SourceError> {
        let mut client = {
            let port = open_to_record(connect.as_mut())?;
            Client::new(port, connect.name(), plan.patience).by(connect.clock())
        };
        let Begun {
            identity,
            header,
            frames,
            early,
        } = begin(&mut client, &plan)?;
        let capture = create.map(|create| keep_from(&header, &early, create));
        let capture = capture.transpose().inspect_err(|_| {
            // Nobody listens to what it streams.
            let _ = client.tell(Request::Stop);
        })?;

        let heard_at = client.now();
        let pairs = Pairs::new(client.arrival().all, frames.status());
        let name = connect.name();
        let signal = header.signal(Path::new(&name))?;
        Ok(Self {
            connect,
            client,
            frames,
            identity,
            header,
            signal,
            capture,
            plan,
            stop,
            marks: Marks::default(),
            pairs,
            ended: false,
            search: None,
            heard: (0, heard_at),
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

    /// The first gaps of unknown length: the board was started again behind each.
    pub fn unknown_gaps(&self) -> &[Gap] {
        self.frames.unknown_gaps()
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
        if let Some(capture) = &mut self.capture {
            capture.sync_if_due(Instant::now())?;
        }
        self.keep_marks_between_frames()?;
        if let Some(search) = self.search.take() {
            return self.look(search);
        }
        let mut buf = [0; 1 << 14];
        match self.client.read(&mut buf) {
            Ok(len) => {
                let arrival = self.client.arrival();
                self.arrived(&buf[..len], &arrival)?;
                self.frames.flush();
                match self.trouble() {
                    Some(broken) => self.begin_search(broken),
                    None => self.restore_proof(),
                }
            }
            Err(gone) => self.begin_search(Broken::Port(gone)),
        }
    }

    fn end(&mut self) -> Result<(), SourceError> {
        self.ended = true;
        // The board may be gone for good; what was recorded stands either way.
        let stopped: Result<(), Failed> = self.talk().ask(Request::Stop);
        self.keep_marks()?;
        self.note(Note::End { unix_ms: now_ms() })?;
        self.bring_to_disk()?;
        self.frames.finish();
        Ok(stopped?)
    }

    /// Ends the record because of `error`: the board is told to stop, if it still listens.
    fn break_off(&mut self, error: SourceError) {
        if !self.ended {
            self.ended = true;
            let mut talk = self.talk();
            talk.capture = None;
            let _: Result<(), Failed> = talk.ask(Request::Stop);
        }
        // Whatever broke the recording off, what it has stays; the first failure is the one to tell.
        let _ = self.bring_to_disk();
        self.frames.finish();
        self.failure.get_or_insert(error);
    }

    /// All of the capture, at its end.
    fn bring_to_disk(&mut self) -> Result<(), CaptureError> {
        self.capture.as_mut().map_or(Ok(()), Writer::sync)
    }

    /// A note for the capture, which a replay hears as we do.
    fn note(&mut self, note: Note) -> Result<(), Failed> {
        self.talk().arrived(&note_frame(note))
    }

    fn talk(&mut self) -> Talk<'_> {
        Talk {
            client: &mut self.client,
            frames: &mut self.frames,
            capture: self
                .capture
                .as_mut()
                .map(|capture| capture as &mut dyn Keep),
        }
    }

    /// Samples that there was time for while the converters gave none: a dead converter must not
    /// make a recording endless.
    fn idle(&self) -> u64 {
        self.frames.status().idle_s * u64::from(self.header.settings.rate.hz())
    }

    fn is_complete(&self) -> bool {
        self.stop.requested()
            || self
                .plan
                .samples
                .is_some_and(|limit| self.frames.next_index() + self.idle() >= limit)
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

    fn clocks(&self) -> Option<Clocks> {
        self.frames.clocks()
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
