//! Ctrl-C and termination end a recording in good order.

use anyhow::Context;

use crate::source::board::Stop;

/// A [`Stop`] that the first Ctrl-C (or SIGTERM, SIGHUP) requests; the second ends the program
/// at once.
///
/// # Errors
/// If the system refuses to set a handler.
pub fn stop_on_signal() -> anyhow::Result<Stop> {
    let stop = Stop::default();
    let requested = stop.clone();
    ctrlc::set_handler(move || {
        if requested.requested() {
            std::process::exit(130);
        }
        requested.request();
    })
    .context("Ctrl-C cannot be caught")?;
    Ok(stop)
}
