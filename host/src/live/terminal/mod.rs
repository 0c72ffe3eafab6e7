//! The view that takes the whole terminal: curves, coefficients, what happened, and keys.
//!
//! ```text
//!   fits -> Shared -> draw -> the terminal
//!             ^
//!   keys -> pad --> stop, marks
//! ```
//!
//! Keys have a thread of their own, and so has drawing: a terminal that stands still costs pictures, never
//! samples, and Ctrl-C works whatever the picture does.

mod curve;
mod draw;
mod own;
mod pad;
mod shared;
#[cfg(test)]
mod tests;

use std::io::{BufWriter, stderr};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use ratatui::backend::CrosstermBackend;
use ratatui::crossterm::event::{self, Event, KeyEventKind};

use super::{Controls, Snapshot};
use pad::Act;
use shared::Shared;

pub use own::{give_back, is_ours};

/// How often the thread of the keys looks whether the view has ended.
const TICK: Duration = Duration::from_millis(100);

/// How long the end waits for the last picture of a terminal that stands still.
const LAST: Duration = Duration::from_secs(1);

/// The view; the terminal is given back when it is dropped.
pub struct TerminalView {
    shared: Arc<Shared>,
    threads: [JoinHandle<()>; 2],
}

impl TerminalView {
    /// Takes the terminal.
    ///
    /// # Errors
    /// What the terminal says; it is as it was then.
    pub fn take(controls: Controls) -> std::io::Result<Self> {
        own::take()?;
        let shared = Arc::new(Shared::default());
        let (drawn, heard) = (Arc::clone(&shared), Arc::clone(&shared));
        Ok(Self {
            shared,
            threads: [
                thread::spawn(move || draw(&drawn)),
                thread::spawn(move || listen(&heard, &controls)),
            ],
        })
    }

    /// Has `snapshot` drawn as soon as the terminal takes it; never waits.
    pub fn show(&self, snapshot: Snapshot) {
        self.shared.enter(snapshot);
    }

    /// Gives the terminal back; what was to be seen on it last.
    pub fn close(self) -> Arc<Snapshot> {
        self.shared.latest()
    }
}

impl Drop for TerminalView {
    fn drop(&mut self) {
        self.shared.end();
        let deadline = Instant::now() + LAST;
        let runs = || self.threads.iter().any(|thread| !thread.is_finished());
        while runs() && Instant::now() < deadline {
            thread::sleep(Duration::from_millis(5));
        }
        own::give_back();
    }
}

/// Draws what there is to draw, until the end.
fn draw(shared: &Shared) {
    // A terminal that went away is no reason to stop a recording.
    let _ = own::enter();
    let backend = CrosstermBackend::new(BufWriter::new(stderr()));
    let Ok(mut terminal) = ratatui::Terminal::new(backend) else {
        return;
    };
    while let Some((snapshot, mut pad)) = shared.next() {
        // A view that stood still too long has lost its terminal.
        if !own::is_taken() {
            return;
        }
        let _ = terminal.draw(|frame| draw::draw(frame, &snapshot, &mut pad));
        shared.drawn(&pad);
    }
}

/// Hears keys, until the end.
fn listen(shared: &Shared, controls: &Controls) {
    while !shared.has_ended() {
        let heard = match event::poll(TICK) {
            Ok(true) => event::read(),
            Ok(false) => continue,
            Err(error) => Err(error),
        };
        match heard {
            Ok(Event::Key(key)) if key.kind != KeyEventKind::Release => {
                if let Some(act) = shared.press(key) {
                    shared.say(carry_out(act, controls));
                }
            }
            Ok(Event::Resize(..)) => shared.resized(),
            Ok(_) => {}
            // Without keys the view still shows, and a signal still ends the recording.
            Err(_) => return,
        }
    }
}

/// Does what a key asked for; the answer is for the view.
fn carry_out(act: Act, controls: &Controls) -> String {
    match act {
        Act::Interrupt => {
            (controls.interrupt)();
            "the recording ends: the board is told to stop".to_owned()
        }
        Act::Mark(text) => match controls.desk.mark(&text) {
            Ok(()) => "marked".to_owned(),
            Err(declined) => format!("not marked: {declined}"),
        },
    }
}
