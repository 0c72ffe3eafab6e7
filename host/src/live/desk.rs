//! Where viewers ask for what the bench is to do, and the bench finds it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use inm_protocol::Settings;

use crate::source::board::{MarkError, Marks, Stop};

/// What the bench does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Phase {
    /// The board is being asked to stream.
    Starting,
    /// Its samples are recorded.
    #[default]
    Recording,
    /// Nothing: the last recording has ended, and the board rests.
    Resting,
    /// The board tests itself.
    Testing,
}

impl Phase {
    /// In a word that stands out.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Starting => "STARTING",
            Self::Recording => "RECORDING",
            Self::Resting => "STOPPED",
            Self::Testing => "SELF-TEST",
        }
    }
}

/// What a viewer wants the bench to do next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    /// Another recording, with these settings of the board.
    Record(Settings),
    /// A self-test.
    Test,
}

/// Why a viewer does not get what it asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Declined {
    /// There is nothing to stop, and no place for a mark.
    #[error("nothing is being recorded: start a recording first")]
    NotRecording,
    /// The board cannot test itself while it streams.
    #[error("the board is recording, and a self-test moves its sensors: stop the recording first")]
    Recording,
    /// The bench is at something that takes its time.
    #[error("the board is being started or tested: try again when that is over")]
    Busy,
    /// The mark.
    #[error(transparent)]
    Mark(#[from] MarkError),
}

/// See above; clones are of the same bench.
#[derive(Clone, Default)]
pub struct Desk {
    /// Ends the bench.
    end: Stop,
    state: Arc<Mutex<State>>,
}

#[derive(Default)]
struct State {
    phase: Phase,
    /// How to end what is being recorded, and where its marks go.
    recording: Option<(Stop, Marks)>,
    wish: Option<Wish>,
}

/// What viewers ask for.
impl Desk {
    /// Of a bench that `end` ends.
    pub fn new(end: Stop) -> Self {
        Self {
            end,
            state: Arc::default(),
        }
    }

    /// Ends the bench, and a recording in good order.
    pub fn end(&self) {
        self.end.request();
    }

    /// Marks this moment of the recording with a note.
    ///
    /// # Errors
    /// [`Declined`]; nothing is marked then.
    pub fn mark(&self, text: &str) -> Result<(), Declined> {
        let state = self.lock();
        let (_, marks) = state.recording.as_ref().ok_or(Declined::NotRecording)?;
        Ok(marks.set(text)?)
    }

    /// Ends the recording in good order; the bench rests.
    ///
    /// # Errors
    /// [`Declined::NotRecording`].
    pub fn stop(&self) -> Result<(), Declined> {
        let state = self.lock();
        let (stop, _) = state.recording.as_ref().ok_or(Declined::NotRecording)?;
        stop.request();
        Ok(())
    }

    /// Ends the recording, if there is one, in good order, and begins another with these settings.
    ///
    /// # Errors
    /// [`Declined::Busy`].
    pub fn record(&self, settings: Settings) -> Result<(), Declined> {
        let mut state = self.lock();
        match state.phase {
            Phase::Starting | Phase::Testing => return Err(Declined::Busy),
            Phase::Recording | Phase::Resting => state.wish = Some(Wish::Record(settings)),
        }
        if let Some((stop, _)) = &state.recording {
            stop.request();
        }
        Ok(())
    }

    /// Has the board test itself.
    ///
    /// # Errors
    /// [`Declined`] where it does not rest.
    pub fn test(&self) -> Result<(), Declined> {
        let mut state = self.lock();
        match state.phase {
            Phase::Starting | Phase::Testing => Err(Declined::Busy),
            Phase::Recording => Err(Declined::Recording),
            Phase::Resting => {
                state.wish = Some(Wish::Test);
                Ok(())
            }
        }
    }
}

/// What the bench tells, and finds.
impl Desk {
    /// A recording goes on, which `stop` ends.
    pub fn records(&self, stop: Stop, marks: Marks) {
        let mut state = self.lock();
        state.recording = Some((stop, marks));
        state.phase = Phase::Recording;
    }

    /// The bench rests; whether a viewer has ended the recording, if there was one.
    pub fn rests(&self) -> bool {
        let mut state = self.lock();
        state.phase = Phase::Resting;
        let recording = state.recording.take();
        recording.is_some_and(|(stop, _)| stop.requested())
    }

    /// Takes what is to be done next; the bench is at it from then on.
    pub fn take(&self) -> Option<Wish> {
        let mut state = self.lock();
        let wish = state.wish.take()?;
        state.phase = match wish {
            Wish::Record(_) => Phase::Starting,
            Wish::Test => Phase::Testing,
        };
        Some(wish)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bench that records, and what ends the recording.
    fn recording() -> (Desk, Stop) {
        let desk = Desk::default();
        let stop = Stop::default();
        desk.records(stop.clone(), Marks::default());
        (desk, stop)
    }

    const WISH: Wish = Wish::Record(Settings {
        rate: inm_protocol::Rate::Sps250,
        filter: inm_protocol::Filter::Sinc,
    });

    #[test]
    fn another_recording_ends_this_one_first() {
        let (desk, stop) = recording();
        let Wish::Record(settings) = WISH else {
            panic!("{WISH:?}");
        };
        assert_eq!(desk.record(settings), Ok(()));
        assert!(stop.requested());
        desk.rests();
        assert_eq!(desk.take(), Some(WISH));
        // It is being started: nobody starts it again, stops it or marks it.
        assert_eq!(desk.record(settings), Err(Declined::Busy));
        assert_eq!(desk.stop(), Err(Declined::NotRecording));
        assert_eq!(desk.mark(""), Err(Declined::NotRecording));
        assert_eq!(desk.take(), None);
    }

    #[test]
    fn a_self_test_waits_until_the_board_rests() {
        let (desk, stop) = recording();
        assert_eq!(desk.test(), Err(Declined::Recording));
        assert!(!stop.requested());
        assert_eq!(desk.stop(), Ok(()));
        assert!(stop.requested());
        desk.rests();
        assert_eq!(desk.test(), Ok(()));
        assert_eq!(desk.take(), Some(Wish::Test));
        assert_eq!(desk.test(), Err(Declined::Busy));
    }

    #[test]
    fn a_mark_goes_to_what_is_being_recorded() {
        let (desk, _) = recording();
        assert_eq!(desk.mark("fan on"), Ok(()));
        let refused = desk.mark("\u{1b}");
        assert_eq!(refused, Err(Declined::Mark(MarkError::NotPlain)));
        desk.rests();
        assert_eq!(desk.mark("fan off"), Err(Declined::NotRecording));
    }
}
