//! The terminal as a whole: taken for the view, and given back however the program ends.

use std::io::{IsTerminal, Write, stderr, stdin};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use ratatui::crossterm::cursor::Show;
use ratatui::crossterm::execute;
use ratatui::crossterm::terminal::{
    EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode,
};

/// Whether the terminal is the view's.
static TAKEN: AtomicBool = AtomicBool::new(false);

/// How long a terminal that takes no byte may hold up an end.
const LAST: Duration = Duration::from_millis(500);

/// Whether there is a terminal to take: keys come from it, the picture goes to it, and it is ours to
/// set. A program in the background that sets its terminal is stopped, and the recording with it.
pub fn is_ours() -> bool {
    stdin().is_terminal() && stderr().is_terminal() && in_foreground()
}

#[cfg(unix)]
fn in_foreground() -> bool {
    // A terminal that is not the one of this session stops nobody.
    rustix::termios::tcgetpgrp(stdin()).map_or(true, |group| group == rustix::process::getpgrp())
}

#[cfg(not(unix))]
fn in_foreground() -> bool {
    true
}

/// Takes the terminal: keys arrive one by one, and what was on it comes back at the end.
///
/// # Errors
/// What the terminal says; it is as it was then.
pub fn take() -> std::io::Result<()> {
    enable_raw_mode()?;
    TAKEN.store(true, Ordering::SeqCst);
    give_back_after_a_panic();
    Ok(())
}

/// Whether the terminal is still the view's.
pub fn is_taken() -> bool {
    TAKEN.load(Ordering::SeqCst)
}

/// Shows the other page of the terminal. A terminal that stands still holds its caller.
///
/// # Errors
/// What the terminal says.
pub fn enter() -> std::io::Result<()> {
    execute!(stderr(), EnterAlternateScreen)
}

/// Gives the terminal back, if it was taken: waits for it, but not for ever.
pub fn give_back() {
    if !TAKEN.swap(false, Ordering::SeqCst) {
        return;
    }
    // Neither may keep the program from its end; a terminal that is gone needs nothing.
    let _ = disable_raw_mode();
    let (done, waiting) = mpsc::channel();
    thread::spawn(move || {
        let _ = execute!(stderr(), LeaveAlternateScreen, Show);
        let _ = stderr().flush();
        let _ = done.send(());
    });
    let _ = waiting.recv_timeout(LAST);
}

/// The message of a panic is to be read.
fn give_back_after_a_panic() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            give_back();
            before(panic);
        }));
    });
}
