//! The loader at the line: bytes in, frames out.

use inm_protocol::update::{LOADER, ToLoader};
use inm_protocol::{Decoder, Fault, Hello, MAX_FRAME, encode};

use super::{Slots, Updater};

/// How long a loader that has a program to start waits for the next word of its host, milliseconds. A host
/// asks three times, 12 s each, before it gives up.
pub const SILENCE_MS: u64 = 60_000;

/// Longest frame that a host sends: a full [`ToLoader::Data`] has a payload of 525 bytes, and COBS and the
/// zero make four more.
const LONGEST: usize = 529;

/// A loader that listens.
pub struct Loader<S> {
    updater: Updater<S>,
    decoder: Decoder<LONGEST>,
    frame: [u8; MAX_FRAME],
    hello: Hello,
    /// When a host was last understood, milliseconds.
    heard_ms: u64,
    leaves: bool,
}

impl<S: Slots> Loader<S> {
    /// A loader of these slots that begins to listen now, on a board that says so of itself; the version in
    /// its hello is that of the loader whatever `hello` says.
    pub fn new(slots: S, hello: Hello, now_ms: u64) -> Self {
        Self {
            updater: Updater::new(slots),
            decoder: Decoder::with_capacity(),
            frame: [0; MAX_FRAME],
            hello: Hello {
                version: LOADER,
                ..hello
            },
            heard_ms: now_ms,
            leaves: false,
        }
    }

    /// Takes a byte from the line; frames for the host go to `send`. May take seconds, for an erase.
    pub fn take(&mut self, byte: u8, now_ms: u64, mut send: impl FnMut(&[u8])) {
        let message = match self.decoder.next::<ToLoader>(&mut &[byte][..]) {
            Some(Ok(message)) => message,
            // Whoever asks: what it asked is not understood.
            Some(Err(Fault::Version { .. })) => return self.greet(&mut send),
            Some(Err(_)) | None => return,
        };
        self.heard_ms = now_ms;
        if matches!(message, ToLoader::Enter | ToLoader::Status) {
            self.greet(&mut send);
        }
        let answer = self.updater.answer(&message);
        self.leaves = message == ToLoader::Start && self.updater.has_program();
        // The frame has room for every message there is.
        if let Ok(len) = encode(&answer, &mut self.frame) {
            send(&self.frame[..len]);
        }
    }

    /// Whether it is time to restart: it was asked to, or nobody speaks any more and there is a program to
    /// start.
    pub fn is_over(&self, now_ms: u64) -> bool {
        let silent_ms = now_ms.saturating_sub(self.heard_ms);
        self.leaves || self.updater.has_program() && silent_ms >= SILENCE_MS
    }

    /// Gives the slots back.
    pub fn release(self) -> S {
        self.updater.release()
    }

    fn greet(&mut self, send: &mut impl FnMut(&[u8])) {
        if let Ok(len) = self.hello.encode(&mut self.frame) {
            send(&self.frame[..len]);
        }
    }
}
