//! Ctrl-C and termination end a recording in good order.

use anyhow::Context;

use crate::live::give_terminal_back;
use crate::source::board::Stop;

/// Exit status of a program that a signal ended, as shells have it: 128 and the number of SIGINT.
const INTERRUPTED: i32 = 130;

/// A [`Stop`] that the first Ctrl-C (or SIGTERM, SIGHUP) requests; the second ends the program
/// at once.
///
/// # Errors
/// If the system refuses to set a handler.
pub fn stop_on_signal() -> anyhow::Result<Stop> {
    let stop = Stop::default();
    let requested = stop.clone();
    ctrlc::set_handler(move || interrupted(&requested)).context("Ctrl-C cannot be caught")?;
    Ok(stop)
}

/// What an interrupt does, by signal or by key.
pub fn interrupted(stop: &Stop) {
    if stop.requested() {
        give_terminal_back();
        std::process::exit(INTERRUPTED);
    }
    stop.request();
}
