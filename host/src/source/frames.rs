//! The one path from bytes to samples: live, from a capture, from the virtual board.

use inm_protocol::{Answer, Decoder, Fault, Health, Note, Reply, ToHost, Trouble};

use super::Chunk;
use super::assemble::{Assembler, Losses};
use super::audit::{Audit, Proof, State};
use crate::link::{axis_name, describe};

/// Conversions that may pass between a slipped bit and its notice: blocks of 32 words are
/// compared, and at the latest the registers come out shifted (firmware/src/ads1281/slip.rs).
const SLIP_NOTICE: u64 = 540;

/// Decodes frames and puts their samples together.
#[derive(Debug, Default)]
pub struct Frames {
    decoder: Decoder,
    assembler: Assembler,
    audit: Audit,
    status: Status,
}

/// What is known of board and link so far.
#[derive(Debug, Clone, Default)]
pub struct Status {
    /// The last health record.
    pub health: Option<Health>,
    /// Frames of another protocol version were seen: theirs.
    pub foreign_version: Option<u8>,
    /// The recording was ended on purpose (captures only).
    pub ended: bool,
    replies: Vec<Reply>,
}

impl Frames {
    /// Takes bytes as they arrived.
    pub fn push(&mut self, mut bytes: &[u8]) {
        while let Some(result) = self.decoder.next(&mut bytes) {
            match result {
                Ok(message) => self.message(message),
                Err(fault) => self.fault(fault),
            }
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

    /// Nothing more will come: hands on the rest and reports what was cut off.
    pub fn finish(&mut self) {
        self.assembler.finish();
        let cut = self.decoder.pending();
        if cut > 0 {
            self.assembler.news(format!(
                "the stream ends in the middle of a frame: its first {cut} bytes are left out"
            ));
        }
    }

    /// Takes the reply to command `id`, if it has arrived.
    pub fn take_reply(&mut self, id: u16) -> Option<Reply> {
        let at = self
            .status
            .replies
            .iter()
            .position(|reply| reply.id == id)?;
        Some(self.status.replies.swap_remove(at))
    }

    /// Board and link so far.
    pub fn status(&self) -> &Status {
        &self.status
    }

    /// Samples lost and flagged so far.
    pub fn losses(&self) -> Losses {
        self.assembler.losses()
    }

    /// What the board's own bins prove so far.
    pub fn proof(&self) -> Proof {
        self.audit.proof()
    }

    /// Whether the board has to begin its bins anew before anything more can be proven.
    pub fn wants_new_beginning(&self) -> bool {
        self.audit.wants_new_beginning()
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
            ToHost::Samples(batch) => {
                self.assembler.push(&batch);
                let told = self.audit.batch(&batch, self.assembler.offset());
                self.tell(told);
            }
            ToHost::Health(health) => {
                let told = self.audit.health(&health);
                self.tell(told);
                self.status.health = Some(health);
            }
            // Nobody waits for this one: see `BoardSource`.
            ToHost::Reply(Reply {
                result: Ok(Answer::BinsEpoch { index }),
                ..
            }) => {
                let told = self.audit.begins_anew(index);
                self.tell(told);
            }
            ToHost::Reply(reply) => self.status.replies.push(reply),
            ToHost::Event(event) => {
                if let (Trouble::Slipped { .. }, Some(axis)) = (event.trouble, event.axis) {
                    self.assembler.spoil(axis, event.index, SLIP_NOTICE);
                }
                let axis = event
                    .axis
                    .map_or(String::new(), |a| format!("{}: ", axis_name(a)));
                let what = describe(event.trouble);
                self.assembler
                    .news(format!("sample {}: {axis}{what}", event.index));
            }
            ToHost::Note(note) => self.note(note),
        }
    }

    fn tell(&mut self, state: Option<State>) {
        if let Some(state) = state {
            self.assembler.news(state.to_string());
        }
    }

    fn note(&mut self, note: Note) {
        match note {
            Note::PortLost { .. } => self.assembler.news("the port went away".to_owned()),
            Note::PortBack { .. } => self.assembler.news("the port came back".to_owned()),
            Note::End { .. } => self.status.ended = true,
            _ => {}
        }
    }

    fn fault(&mut self, fault: Fault) {
        if let Fault::Version { theirs } = fault {
            self.status.foreign_version = Some(theirs);
        }
        let n = self.decoder.counts().frames;
        self.assembler
            .news(format!("after frame {n}: a damaged frame ({fault})"));
    }
}
