//! The host: commands out, messages in.

use std::collections::VecDeque;

use inm_protocol::{
    Answer, Command, Decoder, Health, Identity, MAX_FRAME, Refusal, Reply, Request, ToBoard,
    ToHost, encode,
};

use super::{Machine, PS_PER_MS};

/// Board time after which a command counts as unanswered: to erase what is kept takes 2 s here.
const PATIENCE_MS: u64 = 4000;

/// A host at the far end of the line.
#[derive(Default)]
pub struct Talk {
    decoder: Decoder,
    id: u16,
    /// What has come and was not asked for.
    pub heard: VecDeque<ToHost>,
    /// Frames that did not decode.
    pub damaged: u64,
}

impl Talk {
    /// Takes what has arrived.
    pub fn listen(&mut self, machine: &mut Machine) {
        let bytes = std::mem::take(&mut machine.chip_mut().usart.line.to_host);
        let mut bytes = &bytes[..];
        while let Some(message) = self.decoder.next(&mut bytes) {
            match message {
                Ok(message) => self.heard.push_back(message),
                Err(_) => self.damaged += 1,
            }
        }
    }

    /// Asks, and waits for the answer.
    ///
    /// # Errors
    /// The board refuses.
    ///
    /// # Panics
    /// It does not answer.
    pub fn ask(&mut self, machine: &mut Machine, request: Request) -> Result<Answer, Refusal> {
        self.id += 1;
        let command = ToBoard::Command(Command {
            id: self.id,
            request,
        });
        let mut frame = [0; MAX_FRAME];
        let len = encode(&command, &mut frame).expect("a frame holds a command");
        let chip = machine.chip_mut();
        chip.usart.line.send(chip.now_ps, &frame[..len]);
        for _ in 0..PATIENCE_MS {
            machine.run(PS_PER_MS);
            self.listen(machine);
            if let Some(reply) = self.take_reply() {
                return reply.result;
            }
        }
        panic!("no answer to {request:?}")
    }

    fn take_reply(&mut self) -> Option<Reply> {
        let id = self.id;
        let mine = |message: &ToHost| matches!(message, ToHost::Reply(reply) if reply.id == id);
        let at = self.heard.iter().position(mine)?;
        match self.heard.remove(at) {
            Some(ToHost::Reply(reply)) => Some(reply),
            _ => None,
        }
    }

    /// Who the board is.
    pub fn identify(&mut self, machine: &mut Machine) -> Identity {
        match self.ask(machine, Request::Identify) {
            Ok(Answer::Identity(identity)) => identity,
            other => panic!("no identity: {other:?}"),
        }
    }

    /// The next health record; what came before it is gone.
    pub fn health(&mut self, machine: &mut Machine) -> Health {
        self.listen(machine);
        self.heard.clear();
        for _ in 0..PATIENCE_MS {
            machine.run(PS_PER_MS);
            self.listen(machine);
            while let Some(message) = self.heard.pop_front() {
                if let ToHost::Health(health) = message {
                    return health;
                }
            }
        }
        panic!("no health record")
    }
}
