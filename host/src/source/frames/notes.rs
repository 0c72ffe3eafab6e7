//! What the recording host wrote between the frames: ports that went away, boards that fell silent, marks,
//! the end.

use inm_protocol::Note;

use super::super::interruption::{Interruption, at};
use super::Frames;

impl Frames {
    pub(super) fn note(&mut self, note: Note) {
        if let Some(mut interruption) = Interruption::new(&note, self.streamed) {
            interruption.look(&self.clock);
            // What began it is told; what else happens before the next sample belongs to it.
            self.interruption.get_or_insert(interruption);
        }
        match note {
            Note::PortLost { .. } => self.assembler.news("the port went away".to_owned()),
            Note::BoardSilent { .. } => self.assembler.news("the board fell silent".to_owned()),
            Note::BoardStopped { .. } => {
                self.assembler
                    .news("the board stopped streaming".to_owned());
            }
            Note::Overrun { bytes, .. } => self.assembler.news(format!(
                "this machine did not keep up: {bytes} bytes from the board were thrown away"
            )),
            Note::PortBack { unix_ms } => self.back("the port came back", unix_ms),
            Note::StreamBack { unix_ms } => self.back("the stream is back", unix_ms),
            Note::End { .. } => self.status.ended = true,
            Note::Mark { unix_ms, text } => {
                let index = self.assembler.next_index();
                let words = if text.is_empty() { "" } else { ": " };
                let time = at(unix_ms);
                self.assembler
                    .news(format!("mark ahead of sample {index}{time}{words}{text}"));
            }
            Note::Clock { stamp, host_us, .. } => {
                if let Some((timer_hz, _)) = self.timer {
                    self.pairs.push(stamp, host_us, timer_hz);
                }
            }
            _ => {}
        }
    }

    fn back(&mut self, what: &str, unix_ms: i64) {
        self.assembler.news(what.to_owned());
        if let Some(interruption) = &mut self.interruption {
            interruption.until(unix_ms);
        }
    }
}
