//! The one path from bytes to samples: live, from a capture, from the virtual board.

mod clocks;
mod notes;
mod status;

use inm_protocol::{
    Answer, Batch, Decoder, Event, Health, Pulse, Reply, ToHost, Trouble, UNPROVEN_PERIODS, VERSION,
};

use self::status::REPLIES;
use super::assemble::{Assembler, Losses, SLIP_NOTICE};
use super::audit::{Audit, Proof, State};
use super::interruption::{Clock, Interruption};
use super::told::Told;
use super::{Chunk, Gap};
use crate::capture::{BoardHeader, ClockSource};
use crate::clocks::pairs::Pairs;
use crate::clocks::pulses::Pulses;
use crate::link::{axis_name, describe};

pub use self::status::Status;

/// Decodes frames and puts their samples together.
#[derive(Debug, Default)]
pub struct Frames {
    decoder: Decoder,
    assembler: Assembler,
    audit: Audit,
    told: Told,
    status: Status,
    clock: Clock,
    /// The clock when the board last streamed.
    streamed: Clock,
    /// Number of the last command that was answered with settings, as a start is.
    settled: Option<u16>,
    /// Frames, whole or damaged, behind the end of the recording.
    behind_end: u64,
    /// What broke the stream off, until its next batch.
    interruption: Option<Interruption>,
    /// Ticks a second of the board's timer, and what it runs on, where the header has said so.
    timer: Option<(u32, ClockSource)>,
    /// What the host's clock said beside it.
    pairs: Pairs,
    /// What a pulse a second said, where there was one.
    pulses: Pulses,
    /// Those that came ahead of the header.
    early_pulses: Vec<Pulse>,
}

impl Frames {
    /// The record begins: says what is to be said of the clock of its stamps.
    pub fn begin(&mut self, board: &BoardHeader) {
        self.timer = Some((board.timer_hz, board.clock));
        for pulse in std::mem::take(&mut self.early_pulses) {
            self.pulse(pulse);
        }
        if let Some(warning) = board.clock.warning() {
            self.assembler.news(warning.to_owned());
        }
    }

    /// Takes bytes as they arrived.
    pub fn push(&mut self, mut bytes: &[u8]) {
        while let Some(result) = self.decoder.next(&mut bytes) {
            match result {
                _ if self.status.ended => self.behind_end += 1,
                Ok(message) => {
                    if matches!(message, ToHost::Health(_)) {
                        self.status.behind_health = bytes.len();
                    }
                    self.note_version();
                    self.message(message);
                }
                Err(fault) => self.fault(fault),
            }
        }
        let hello = self.decoder.hello();
        if let Some(hello) = hello.filter(|hello| hello.version != VERSION) {
            self.status.foreign_version = Some(hello.version);
            self.status.foreign = Some(hello.clone());
        }
    }

    /// The next chunk that is complete.
    pub fn pop(&mut self) -> Option<Chunk> {
        self.assembler.pop()
    }

    /// Makes chunks of whatever has arrived, however short.
    pub fn flush(&mut self) {
        self.assembler.flush();
    }

    /// The port is gone for now: hands on what nothing more will be said about.
    pub fn pause(&mut self) {
        self.assembler.flush();
    }

    /// Nothing more will come: hands on the rest and reports what was cut off.
    pub fn finish(&mut self) {
        self.assembler.finish();
        if let Some(interruption) = self.interruption.take() {
            let words = interruption.words();
            self.assembler
                .news(format!("the recording ends without the stream: {words}"));
        }
        if self.behind_end > 0 {
            self.assembler.news(format!(
                "{} frames behind the end of the recording are left out: they are no part of it",
                self.behind_end
            ));
        }
        if let Some(words) = self.odd_pulses() {
            self.assembler.news(words);
        }
        let cut = self.decoder.pending();
        if cut > 0 {
            self.assembler.news(format!(
                "the stream ends in the middle of a frame: its first {cut} bytes are left out"
            ));
        }
    }

    /// Takes the reply to command `id`, if it has arrived.
    pub fn take_reply(&mut self, id: u16) -> Option<Reply> {
        self.status.take_reply(id)
    }

    /// Board and link so far.
    pub fn status(&self) -> &Status {
        &self.status
    }

    /// Samples lost and flagged so far.
    pub fn losses(&self) -> Losses {
        self.assembler.losses()
    }

    /// The first gaps of unknown length.
    pub fn unknown_gaps(&self) -> &[Gap] {
        self.assembler.unknown_gaps()
    }

    /// Frames that arrived intact.
    pub fn intact(&self) -> u64 {
        self.decoder.counts().frames
    }

    /// What the board's own bins prove so far.
    pub fn proof(&self) -> Proof {
        self.audit.proof()
    }

    /// Whether the board has to begin its bins anew before anything more can be proven.
    pub fn wants_new_beginning(&self) -> bool {
        self.audit.wants_new_beginning()
    }

    /// Whether a frame has begun and not ended.
    pub fn is_within_a_frame(&self) -> bool {
        self.decoder.pending() > 0
    }

    /// Frames that arrived damaged, and their bytes.
    pub fn damaged(&self) -> (u64, u64) {
        let counts = self.decoder.counts();
        (counts.faults, counts.bytes_lost)
    }

    /// Samples an axis so far, lost ones included.
    pub fn next_index(&self) -> u64 {
        self.assembler.next_index()
    }

    fn message(&mut self, message: ToHost) {
        match message {
            ToHost::Samples(batch) => self.batch(&batch),
            ToHost::Health(health) => self.health(health),
            // Nobody waits for this one: see `BoardSource`.
            ToHost::Reply(Reply {
                result: Ok(Answer::BinsEpoch { index }),
                ..
            }) => {
                let told = self.audit.begins_anew(index);
                self.tell(told);
            }
            ToHost::Reply(reply) => self.reply(reply),
            ToHost::Event(event) => self.event(event),
            ToHost::Note(note) => self.note(note),
            ToHost::Pulse(pulse) => self.pulse(pulse),
        }
    }

    fn event(&mut self, event: Event) {
        self.told.event(&event);
        if let (true, Some(axis)) = (event.trouble.is_reset_for(), event.axis) {
            let words = match event.trouble {
                Trouble::Slipped { .. } => SLIP_NOTICE,
                _ => UNPROVEN_PERIODS,
            };
            self.assembler.spoil(axis, &event, words);
        }
        let axis = event
            .axis
            .map_or(String::new(), |a| format!("{}: ", axis_name(a)));
        let what = describe(event.trouble);
        self.assembler
            .news(format!("sample {}: {axis}{what}", event.index));
    }

    fn batch(&mut self, batch: &Batch) {
        if self.assembler.leaves_out(batch) {
            let [from, to] = [batch.first, batch.end()];
            self.assembler.news(format!(
                "samples {from} to {to} of the board came twice, or too late: left out"
            ));
            return;
        }
        self.clock.batch(batch.stamp);
        if let Some(mut interruption) = self.interruption.take() {
            interruption.look(&self.clock);
            // A board that went on behind a port that was away has counted what is missing.
            if !(interruption.of_the_port() && self.assembler.is_later(batch)) {
                self.assembler.explain(interruption.words());
            }
        }
        self.streamed = self.clock;
        self.status.stopped = false;
        self.assembler.push(batch);
        let told = self.audit.batch(batch, self.assembler.offset());
        self.tell(told);
    }

    fn health(&mut self, health: Health) {
        self.clock.health(&health);
        if let Some(interruption) = &mut self.interruption {
            interruption.look(&self.clock);
        }
        if health.streaming {
            self.streamed = self.clock;
        }
        let before = self.status.health.replace(health);
        let idle = |before: Health| before.streaming && before.index == health.index;
        self.status.stopped = !health.streaming;
        self.status.idle_s += u64::from(health.streaming && before.is_some_and(idle));
        self.assembler.miss_notice(self.told.unheard(&health));
        if health.streaming {
            self.assembler.confirm(health.stream, health.index, false);
        }
        let told = self.audit.health(&health);
        self.tell(told);
    }

    fn reply(&mut self, reply: Reply) {
        match &reply.result {
            Ok(Answer::Identity(identity)) => {
                if let Some(interruption) = &mut self.interruption {
                    interruption.asked(identity.restart.clone());
                }
            }
            // To a stop: the board has proved its words to the end and said so, in this order.
            Ok(Answer::Done) => self.stream_ended(),
            // To a start: what was said of an idle board before is no news any more.
            Ok(Answer::Settings(_)) => {
                self.status.stopped = false;
                // The first one tells of the stream that is there, and so does one that comes twice
                // or too late: commands are numbered upwards.
                let age = self.settled.map(|last| last.wrapping_sub(reply.id));
                if age.is_none_or(|age| usize::from(age) > REPLIES) {
                    if age.is_some() {
                        self.assembler.announce();
                    }
                    self.settled = Some(reply.id);
                }
            }
            _ => {}
        }
        self.status.keep_reply(reply);
    }

    /// The board says that its stream is over. Its last health record, if it arrived, is behind the
    /// last sample.
    fn stream_ended(&mut self) {
        let end = self.assembler.next_index();
        let health = self.status.health.filter(|health| health.streaming);
        let last = |health: &Health| health.index.wrapping_add(self.assembler.offset());
        if let Some(health) = health.filter(|health| last(health) == end) {
            self.assembler.confirm(health.stream, health.index, true);
        }
    }

    fn tell(&mut self, state: Option<State>) {
        if let Some(state) = state {
            self.assembler.news(state.to_string());
        }
    }
}
