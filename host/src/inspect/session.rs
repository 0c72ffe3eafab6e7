//! An open port, asked and listened to, with nothing of the record's machinery.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use inm_protocol::{
    AXES, Answer, Decoder, Fault, Health, Identity, Pulse, Reply, Request, SelfTestStep, ToHost,
    VERSION,
};

use crate::link::{Client, Clock, Connect, Expect, LinkError, Patience};

/// Messages that wait to be looked at. A streaming board sends 126 batches a second at most; who asks
/// takes what came as soon as the answer is there.
const WAITING: usize = 4096;

/// A message that the board sent unasked.
#[derive(Debug, Clone)]
pub struct Heard {
    /// When it arrived, by [`Session::now`].
    pub at: Instant,
    /// What it says.
    pub message: ToHost,
}

/// A board on an open port.
pub struct Session {
    client: Client,
    clock: Clock,
    listener: Listener,
}

/// What has arrived.
#[derive(Default)]
struct Listener {
    decoder: Decoder,
    heard: VecDeque<Heard>,
    reply: Option<Reply>,
    /// A version that is not ours, of a frame.
    foreign: Option<u8>,
}

impl Session {
    /// Opens the port and asks who is there.
    ///
    /// # Errors
    /// [`LinkError`]: the port cannot be opened, nobody answers, or a board of another version does.
    pub fn open(
        connect: &mut dyn Connect,
        patience: Patience,
    ) -> Result<(Self, Identity), LinkError> {
        let port = connect.open()?;
        let mut session = Self {
            client: Client::new(port, connect.name(), patience).by(connect.clock()),
            clock: connect.clock(),
            listener: Listener::default(),
        };
        let identity = session.ask(Request::Identify)?;
        Ok((session, identity))
    }

    /// The time by which it waits: that of this machine, or of a board that has its own.
    pub fn now(&self) -> Instant {
        self.clock.now()
    }

    /// Sends a request and waits for its answer; what else arrives is kept for [`Self::heard`].
    ///
    /// # Errors
    /// What the link says, or the board.
    pub(crate) fn ask<T: Expect>(&mut self, request: Request) -> Result<T, LinkError> {
        let Self {
            client,
            clock,
            listener,
        } = self;
        let answer = client.request(request, |bytes, id| {
            listener.take(bytes, clock.now());
            let reply = listener.reply.take_if(|reply| reply.id == id);
            Ok::<_, LinkError>(reply)
        });
        let answer: Answer = match (answer, listener.foreign_version()) {
            (Err(_), Some(theirs)) => {
                let hello = listener.decoder.hello().cloned();
                return Err(client.foreign_version(theirs, hello));
            }
            (answer, _) => answer?,
        };
        T::from_answer(answer).ok_or_else(|| client.wrong_answer(request))
    }

    /// Waits a short while for something to arrive.
    ///
    /// # Errors
    /// [`LinkError::Gone`] if the port went away.
    pub fn listen(&mut self) -> Result<(), LinkError> {
        let mut buf = [0; 4096];
        let len = self.client.read(&mut buf)?;
        self.listener.take(&buf[..len], self.clock.now());
        Ok(())
    }

    /// The next message that the board sent unasked.
    pub fn heard(&mut self) -> Option<Heard> {
        self.listener.heard.pop_front()
    }

    /// The next health record, and when it arrived; `None` if none came within `patience`. What was
    /// heard before it is passed over.
    ///
    /// # Errors
    /// [`LinkError::Gone`] if the port went away.
    pub fn health(&mut self, patience: Duration) -> Result<Option<(Instant, Health)>, LinkError> {
        let deadline = self.now() + patience;
        loop {
            while let Some(Heard { at, message }) = self.heard() {
                if let ToHost::Health(health) = message {
                    return Ok(Some((at, health)));
                }
            }
            if self.now() >= deadline {
                return Ok(None);
            }
            self.listen()?;
        }
    }

    /// The next pulse a second; `None` if none came within `patience`. What else was heard is passed over.
    ///
    /// # Errors
    /// [`LinkError::Gone`] if the port went away.
    pub fn pulse(&mut self, patience: Duration) -> Result<Option<Pulse>, LinkError> {
        let deadline = self.now() + patience;
        loop {
            while let Some(Heard { message, .. }) = self.heard() {
                if let ToHost::Pulse(pulse) = message {
                    return Ok(Some(pulse));
                }
            }
            if self.now() >= deadline {
                return Ok(None);
            }
            self.listen()?;
        }
    }

    /// Frames that arrived damaged so far.
    pub fn damaged(&self) -> u64 {
        self.listener.decoder.counts().faults
    }
}

impl Listener {
    fn take(&mut self, mut bytes: &[u8], at: Instant) {
        while let Some(result) = self.decoder.next::<ToHost>(&mut bytes) {
            match result {
                Ok(ToHost::Reply(reply)) => self.reply = Some(reply),
                Ok(message) => {
                    if self.heard.len() == WAITING {
                        self.heard.pop_front();
                    }
                    self.heard.push_back(Heard { at, message });
                }
                Err(Fault::Version { theirs }) => self.foreign = Some(theirs),
                // Counted by the decoder.
                Err(_) => {}
            }
        }
    }

    /// The version of a board that speaks another.
    fn foreign_version(&self) -> Option<u8> {
        let hello = self.decoder.hello().map(|hello| hello.version);
        let frame = self.decoder.version();
        [hello, frame, self.foreign]
            .into_iter()
            .flatten()
            .find(|&version| version != VERSION)
    }
}

impl Expect for [SelfTestStep; AXES] {
    fn from_answer(answer: Answer) -> Option<Self> {
        match answer {
            Answer::SelfTest(steps) => Some(steps),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
