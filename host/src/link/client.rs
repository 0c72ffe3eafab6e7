//! Commands and their replies over an open port.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

use inm_protocol::{
    Answer, Command, FRAME_END, Hello, Identity, MAX_FRAME, REGISTERS, Reply, Request,
    SensorCalibration, Settings, ToBoard, encode,
};

use super::port::is_wait;
use super::{Arrival, Clock, LinkError, Port};

/// How long to wait for a reply, and how often to ask.
#[derive(Debug, Clone, Copy)]
pub struct Patience {
    /// Wait for one reply.
    pub wait: Duration,
    /// Times to ask before giving up: a byte lost on the link costs one.
    pub tries: u32,
    /// A streaming board of which nothing intact was heard for so long needs help: three of the
    /// health records that it sends once a second, and many more batches.
    pub silence: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Self {
            wait: Duration::from_millis(1500),
            tries: 3,
            silence: Duration::from_secs(3),
        }
    }
}

/// An open port, and the number of the next command.
///
/// Whatever arrives while a reply is awaited is handed to the caller, so that no sample is
/// lost to a question.
pub struct Client {
    /// `None` once it is closed.
    port: Option<Box<dyn Port>>,
    name: String,
    next_id: u16,
    patience: Patience,
    clock: Clock,
    /// What arrived behind the last reply and was not handed out yet.
    behind: Vec<u8>,
}

impl Client {
    /// Speaks to the board at `port`; `name` is for messages.
    pub fn new(port: Box<dyn Port>, name: String, patience: Patience) -> Self {
        Self {
            port: Some(port),
            name,
            next_id: first_id(),
            patience,
            clock: Clock::of_the_wall(),
            behind: Vec::new(),
        }
    }

    /// The same, with waits by this clock.
    #[must_use]
    pub fn by(mut self, clock: Clock) -> Self {
        self.clock = clock;
        self
    }

    /// The same, with clock and numbers that go on behind another's: two starts of a record have two numbers.
    #[must_use]
    pub fn behind(mut self, other: &Self) -> Self {
        self.next_id = other.next_id;
        self.clock = other.clock.clone();
        self
    }

    /// The time by which it waits.
    pub fn now(&self) -> Instant {
        self.clock.now()
    }

    /// When what was read a moment ago had arrived, by a clock beside the board.
    pub fn arrival(&self) -> Arrival {
        self.clock.arrival()
    }

    /// Closes the port: a lock of our own on it must not keep us out when it is opened again.
    pub fn close(&mut self) {
        self.port = None;
        self.behind.clear();
    }

    /// The port, if it is open.
    fn port(&mut self) -> io::Result<&mut dyn Port> {
        match &mut self.port {
            Some(port) => Ok(port.as_mut()),
            None => Err(ErrorKind::NotConnected.into()),
        }
    }

    /// Reads what has arrived, or nothing if nothing did within the port's own short time.
    ///
    /// # Errors
    /// [`LinkError::Gone`] if the port went away.
    pub fn read(&mut self, buf: &mut [u8]) -> Result<usize, LinkError> {
        if !self.behind.is_empty() {
            self.clock.forget_frames();
            let len = self.behind.len().min(buf.len());
            buf[..len].copy_from_slice(&self.behind[..len]);
            self.behind.drain(..len);
            return Ok(len);
        }
        match self.port().and_then(|port| port.read(buf)) {
            Ok(len) => Ok(len),
            Err(error) if is_wait(&error) => Ok(0),
            Err(source) => Err(LinkError::Gone {
                port: self.name.clone(),
                source,
            }),
        }
    }

    /// Sends a request and waits for its answer.
    ///
    /// `arrived` is given every byte that arrives, up to the end of the reply's frame, and returns
    /// the reply with a given number once it has decoded it. What is behind that frame waits for
    /// the next read: a record that begins or ends with a reply begins and ends on whole frames,
    /// however the board's other frames fall into the reads.
    ///
    /// # Errors
    /// [`LinkError::NoReply`], [`LinkError::Refused`], [`LinkError::Gone`], or what `arrived`
    /// returns.
    pub fn request<E: From<LinkError>>(
        &mut self,
        request: Request,
        mut arrived: impl FnMut(&[u8], u16) -> Result<Option<Reply>, E>,
    ) -> Result<Answer, E> {
        let mut buf = [0; 4096];
        // The same number each time: the answer to the first try may only be late, and what the board
        // says of the second (that it streams already, say) is no answer to what was asked.
        let id = self.number();
        for _ in 0..self.patience.tries {
            self.send(id, request)?;
            let deadline = self.clock.now() + self.patience.wait;
            while self.clock.now() < deadline {
                let len = self.read(&mut buf)?;
                let mut handed = 0;
                for part in buf[..len].split_inclusive(|&byte| byte == FRAME_END) {
                    handed += part.len();
                    if let Some(reply) = arrived(part, id)? {
                        self.behind.splice(..0, buf[handed..len].iter().copied());
                        return Ok(self.answer(request, reply)?);
                    }
                }
            }
        }
        let Patience {
            wait: waited,
            tries,
            ..
        } = self.patience;
        Err(LinkError::NoReply {
            port: self.name.clone(),
            request: Box::new(request),
            waited,
            tries,
        }
        .into())
    }

    /// What a reply to a request says; a refusal is an error.
    pub(crate) fn answer(&self, request: Request, reply: Reply) -> Result<Answer, LinkError> {
        reply.result.map_err(|refusal| LinkError::Refused {
            port: self.name.clone(),
            request: Box::new(request),
            refusal,
        })
    }

    /// Sends a request whose answer the caller finds among what arrives, by the number returned.
    ///
    /// # Errors
    /// [`LinkError::Gone`] if the port went away.
    pub fn tell(&mut self, request: Request) -> Result<u16, LinkError> {
        let id = self.number();
        self.send(id, request)?;
        Ok(id)
    }

    /// Number of the next command; never 0, which stands for a stream of no number.
    fn number(&mut self) -> u16 {
        let id = self.next_id;
        self.next_id = self.next_id.checked_add(1).unwrap_or(1);
        id
    }

    /// Sends a request as the command of this number.
    fn send(&mut self, id: u16, request: Request) -> Result<(), LinkError> {
        let command = Command { id, request };
        // A zero first ends whatever noise the board believes to be a frame.
        let mut frame = [0; MAX_FRAME + 1];
        let len = encode(&ToBoard::Command(command), &mut frame[1..]).map_err(|error| {
            LinkError::Gone {
                port: self.name.clone(),
                source: io::Error::other(error),
            }
        })?;
        let sent = self.port().and_then(|port| {
            port.write_all(&frame[..=len])?;
            port.flush()
        });
        sent.map_err(|source| LinkError::Gone {
            port: self.name.clone(),
            source,
        })
    }

    /// The error for a board of another protocol version, or whose loader speaks.
    pub(crate) fn foreign_version(&self, theirs: u8, board: Option<Hello>) -> LinkError {
        LinkError::of_version(self.name.clone(), theirs, board)
    }

    /// The error for an answer that does not belong to its request.
    pub(crate) fn wrong_answer(&self, request: Request) -> LinkError {
        LinkError::WrongAnswer {
            port: self.name.clone(),
            request: Box::new(request),
        }
    }
}

/// Numbers that a session may begin with: all of one length on the wire (two bytes), for a long while
/// from the first on.
const FIRST_IDS: std::ops::Range<u16> = 0x80..0x2000;

/// A random number for the first command: a board answers a command that equals the last of the
/// session before with the reply of then.
fn first_id() -> u16 {
    let random = RandomState::new().build_hasher().finish();
    let ids = u64::from(FIRST_IDS.end - FIRST_IDS.start);
    FIRST_IDS.start + (random % ids) as u16
}

/// What an answer should hold, by kind.
pub(crate) trait Expect: Sized {
    /// The content, or `None` if the answer is of another kind.
    fn from_answer(answer: Answer) -> Option<Self>;
}

impl Expect for Identity {
    fn from_answer(answer: Answer) -> Option<Self> {
        match answer {
            Answer::Identity(identity) => Some(identity),
            _ => None,
        }
    }
}

impl Expect for Settings {
    fn from_answer(answer: Answer) -> Option<Self> {
        match answer {
            Answer::Settings(settings) => Some(settings),
            _ => None,
        }
    }
}

impl Expect for [[u8; REGISTERS]; inm_protocol::AXES] {
    fn from_answer(answer: Answer) -> Option<Self> {
        match answer {
            Answer::Registers(registers) => Some(registers),
            _ => None,
        }
    }
}

impl Expect for Option<SensorCalibration> {
    fn from_answer(answer: Answer) -> Option<Self> {
        match answer {
            Answer::SensorCalibration(kept) => Some(kept),
            _ => None,
        }
    }
}

impl Expect for () {
    fn from_answer(_: Answer) -> Option<Self> {
        Some(())
    }
}

#[cfg(test)]
mod tests;
