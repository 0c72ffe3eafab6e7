//! What is known of board and link, and the replies that wait for who asked.

use inm_protocol::{Fault, Health, Hello, Reply, VERSION};

use super::Frames;

/// Replies that are kept for who asked: one is asked for at a time, and late ones may be ahead of it.
pub(super) const REPLIES: usize = 8;

/// What is known of board and link so far.
#[derive(Debug, Clone, Default)]
pub struct Status {
    /// The last health record.
    pub health: Option<Health>,
    /// Bytes that were taken in together with its end, and behind it.
    pub behind_health: usize,
    /// Frames of another protocol version were seen: theirs.
    pub foreign_version: Option<u8>,
    /// What a board of another protocol version said of itself.
    pub foreign: Option<Hello>,
    /// The recording was ended on purpose (captures only).
    pub ended: bool,
    /// The last that was heard of the stream is that the board does not stream.
    pub stopped: bool,
    /// Seconds, by the board's health records, in which a streaming board had no conversion.
    pub idle_s: u64,
    replies: Vec<Reply>,
}

impl Status {
    /// Takes the reply to command `id`, if it has arrived.
    pub(super) fn take_reply(&mut self, id: u16) -> Option<Reply> {
        let at = self.replies.iter().position(|reply| reply.id == id)?;
        Some(self.replies.swap_remove(at))
    }

    /// Nobody asks for old ones; a stream may hold any number of them.
    pub(super) fn keep_reply(&mut self, reply: Reply) {
        if self.replies.len() == REPLIES {
            self.replies.remove(0);
        }
        self.replies.push(reply);
    }
}

impl Frames {
    /// What a capture may hold is understood, and yet no board to record.
    pub(super) fn note_version(&mut self) {
        let theirs = self.decoder.version();
        if theirs.is_some_and(|theirs| theirs != VERSION) {
            self.status.foreign_version = theirs;
        }
    }

    /// A frame that is no message.
    pub(super) fn fault(&mut self, fault: Fault) {
        if let Fault::Version { theirs } = fault {
            self.status.foreign_version = Some(theirs);
        }
        let n = self.decoder.counts().frames;
        self.assembler
            .news(format!("after frame {n}: a damaged frame ({fault})"));
    }
}
