//! What the threads of the view share: the last state of the recording, and that of the keys. Only the
//! last of each is kept, so that a terminal that stands still costs no memory.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use ratatui::crossterm::event::KeyEvent;

use super::pad::{Act, Pad};
use crate::live::Snapshot;

/// See above.
#[derive(Default)]
pub struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    latest: Arc<Snapshot>,
    /// What is shown during a pause.
    frozen: Option<Arc<Snapshot>>,
    pad: Pad,
    /// There is something to draw.
    due: bool,
    ended: bool,
}

impl Shared {
    /// Takes a newer state of the recording.
    pub fn enter(&self, snapshot: Snapshot) {
        let mut state = self.lock();
        state.pad.axes = snapshot.axes.len();
        state.latest = Arc::new(snapshot);
        self.wake(state);
    }

    /// Takes a key; what it asks of the recording is the caller's to do.
    pub fn press(&self, key: KeyEvent) -> Option<Act> {
        let mut state = self.lock();
        let act = state.pad.press(key);
        state.frozen = match (state.pad.paused, state.frozen.take()) {
            (false, _) => None,
            (true, Some(frozen)) => Some(frozen),
            (true, None) => Some(Arc::clone(&state.latest)),
        };
        self.wake(state);
        act
    }

    /// Shows the answer to a key.
    pub fn say(&self, said: String) {
        let mut state = self.lock();
        state.pad.said = Some(said);
        self.wake(state);
    }

    /// The terminal has another size.
    pub fn resized(&self) {
        self.wake(self.lock());
    }

    /// Nothing more is shown.
    pub fn end(&self) {
        let mut state = self.lock();
        state.ended = true;
        self.wake(state);
    }

    /// Whether nothing more is shown.
    pub fn has_ended(&self) -> bool {
        self.lock().ended
    }

    /// The last state of the recording.
    pub fn latest(&self) -> Arc<Snapshot> {
        Arc::clone(&self.lock().latest)
    }

    /// Waits for something to draw; `None` at the end.
    pub fn next(&self) -> Option<(Arc<Snapshot>, Pad)> {
        let waiting = |state: &mut State| !state.due && !state.ended;
        let state = self.changed.wait_while(self.lock(), waiting);
        let mut state = state.unwrap_or_else(PoisonError::into_inner);
        state.due = false;
        let snapshot = state.frozen.as_ref().unwrap_or(&state.latest);
        (!state.ended).then(|| (Arc::clone(snapshot), state.pad.clone()))
    }

    /// How far the list goes, as it was drawn.
    pub fn drawn(&self, pad: &Pad) {
        let mut state = self.lock();
        state.pad.most_above = pad.most_above;
        state.pad.above = state.pad.above.min(pad.most_above);
    }

    fn wake(&self, mut state: MutexGuard<'_, State>) {
        state.due = true;
        self.changed.notify_one();
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
