//! Messages on their way to the link: nothing waits for it, and what is given up is counted.
//!
//! Batches, health records and pulses that find no room are dropped. Replies and events wait for room,
//! so that a command is answered exactly once and trouble is told even when the trouble is the
//! link.

use heapless::Deque;
use inm_protocol::{
    Batch, Command, Event, Health, Hello, MAX_FRAME, Pulse, Reply, ToHost, Trouble, encode,
};

use crate::{Platform, log};

/// Events that can wait.
const EVENTS: usize = 16;

/// The sending side of the link.
pub(super) struct Outbox {
    frame: [u8; MAX_FRAME],
    reply: Option<Reply>,
    /// Goes ahead of the reply.
    hello: Option<Hello>,
    /// The last command, and its reply once there was one: a host that did not get it asks again.
    last: Option<(Command, Option<Reply>)>,
    events: Deque<Event, EVENTS>,
    /// Batches dropped in a row, and the index of the first.
    dropped: (u32, u64),
    /// Frames handed to the transmitter.
    pub sent: u32,
    /// Frames given up.
    pub given_up: u32,
}

impl Outbox {
    pub(super) const fn new() -> Self {
        Self {
            frame: [0; MAX_FRAME],
            reply: None,
            hello: None,
            last: None,
            events: Deque::new(),
            dropped: (0, 0),
            sent: 0,
            given_up: 0,
        }
    }

    /// Sends what waits, as far as there is room; `true` if anything was sent. Events first: who
    /// gets the reply to a stop knows all that there was to know of the stream.
    pub(super) fn flush<P: Platform>(&mut self, platform: &mut P) -> bool {
        let before = self.sent;
        if self.flush_events(platform)
            && self.flush_hello(platform)
            && let Some(reply) = self.reply.take()
        {
            let message = ToHost::Reply(reply);
            if !self.send(platform, &message)
                && let ToHost::Reply(reply) = message
            {
                self.reply = Some(reply);
            }
        }
        self.sent != before
    }

    /// Sends the events that wait, as far as there is room; `true` if none waits any more.
    #[inline(never)]
    fn flush_events<P: Platform>(&mut self, platform: &mut P) -> bool {
        while let Some(&event) = self.events.front()
            && self.send(platform, &ToHost::Event(event))
        {
            self.events.pop_front();
        }
        self.events.is_empty()
    }

    /// Sends the hello, if one waits; `true` if none does any more.
    #[inline(never)]
    fn flush_hello<P: Platform>(&mut self, platform: &mut P) -> bool {
        let Some(hello) = &self.hello else {
            return true;
        };
        let len = hello.encode(&mut self.frame).unwrap_or(0);
        let told = self.transmit(platform, len);
        if told {
            self.hello = None;
        }
        told
    }

    /// Says who the board is, to a host of any version.
    pub(super) fn greet(&mut self, hello: Hello) {
        self.hello = Some(hello);
    }

    /// Whether a reply waits: the next command has to wait too.
    pub(super) fn reply_waits(&self) -> bool {
        self.reply.is_some()
    }

    /// Whether this is the last command once more. Its reply is sent again then, and there is
    /// nothing to do.
    pub(super) fn repeats(&mut self, command: Command) -> bool {
        match &self.last {
            Some((last, reply)) if *last == command => {
                self.reply.clone_from(reply);
                true
            }
            _ => {
                self.last = Some((command, None));
                false
            }
        }
    }

    /// Answers a command.
    pub(super) fn reply(&mut self, reply: Reply) {
        if let Err(refusal) = &reply.result {
            log::refused(reply.id, refusal);
        }
        if let Some((_, last)) = &mut self.last {
            *last = Some(reply.clone());
        }
        self.reply = Some(reply);
    }

    /// Tells the host what happened.
    pub(super) fn event(&mut self, event: Event) {
        log::event(&event);
        if self.events.push_back(event).is_err() {
            log::event_lost();
            self.given_up = self.given_up.saturating_add(1);
        }
    }

    /// Sends a batch or drops it.
    #[inline(never)]
    pub(super) fn batch<P: Platform>(&mut self, platform: &mut P, batch: Batch) {
        let Batch { first, stream, .. } = batch;
        if self.send(platform, &ToHost::Samples(batch)) {
            let (batches, index) = core::mem::take(&mut self.dropped);
            if batches > 0 {
                self.event(Event {
                    index,
                    axis: None,
                    trouble: Trouble::LinkFull { batches },
                    stream,
                });
            }
        } else {
            self.given_up = self.given_up.saturating_add(1);
            let (batches, index) = self.dropped;
            let since = if batches == 0 { first } else { index };
            self.dropped = (batches.saturating_add(1), since);
        }
    }

    /// Sends a health record or drops it. The events that it counts are sent ahead of it, so that
    /// a host that has fewer knows that one was lost.
    pub(super) fn health<P: Platform>(&mut self, platform: &mut P, mut health: Health) {
        let told = self.flush_events(platform);
        health.link.frames_sent = self.sent;
        if !told || !self.send(platform, &ToHost::Health(health)) {
            self.given_up = self.given_up.saturating_add(1);
        }
    }

    /// Sends a pulse or drops it; its number says so to who gets the next.
    #[inline(never)]
    pub(super) fn pulse<P: Platform>(&mut self, platform: &mut P, pulse: Pulse) {
        if !self.send(platform, &ToHost::Pulse(pulse)) {
            self.given_up = self.given_up.saturating_add(1);
        }
    }

    fn send<P: Platform>(&mut self, platform: &mut P, message: &ToHost) -> bool {
        // The frame has room for every message there is; an error would be a drop, and counted.
        let Ok(len) = encode(message, &mut self.frame) else {
            return false;
        };
        self.transmit(platform, len)
    }

    /// Hands the first bytes of the frame to the transmitter, if it has room for all of them.
    fn transmit<P: Platform>(&mut self, platform: &mut P, len: usize) -> bool {
        let queued = self
            .frame
            .get(..len)
            .is_some_and(|frame| platform.transmit(frame));
        if queued {
            self.sent = self.sent.wrapping_add(1);
        }
        queued
    }
}
