//! A board restarted on command, and whether it did restart.

use std::time::Duration;

use inm_protocol::{Identity, Request, Restart};
use serde::Serialize;

use super::{Session, serial};
use crate::link::{LinkError, restarted};

/// How long a board may take until it answers again. It restarts 200 ms after its reply, waits 20 ms for
/// its converters, and a crystal that does not start costs some tenths of a second: ten seconds are a
/// board that is not coming back.
const BACK_WITHIN: Duration = Duration::from_secs(10);

/// How long to wait for the health record that tells the time since the start: two of the seconds
/// between them, and slack for one that is lost on the way.
const NEXT_HEALTH: Duration = Duration::from_millis(2500);

/// What a board may have been up for more than the time since it was told to restart, seconds: its
/// clock is good to 1 % at worst, of some ten seconds.
const CLOCK_SLACK_S: f64 = 0.1;

/// A board that was told to restart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Restarted {
    /// Port that it is on.
    pub port: String,
    /// Unique number of its microcontroller, 24 hexadecimal digits.
    pub serial: String,
    /// Time from the reply until it answered again, seconds.
    pub back_after_s: f64,
    /// Why it started, as it says.
    pub restart: Restart,
    /// The same, in words.
    pub restart_words: String,
    /// Whether it started for this command, on its crystal: `false` if it was something else, or it did
    /// not restart at all.
    pub as_told: bool,
}

/// Restarts the board, and waits until it answers again.
///
/// # Errors
/// What the link says; [`LinkError::NoReply`] if it does not come back within 10 s.
pub fn reset(port: String, session: &mut Session) -> Result<Restarted, LinkError> {
    let () = session.ask(Request::Reset)?;
    let told = session.now();
    while session.heard().is_some() {}
    let (identity, back, young) = loop {
        let identity: Identity = match session.ask(Request::Identify) {
            Ok(identity) => identity,
            Err(LinkError::NoReply { .. }) if session.now() < told + BACK_WITHIN => continue,
            Err(error) => return Err(error),
        };
        let answered = session.now();
        let late = answered > told + BACK_WITHIN;
        // It answers until it restarts: only a young board is back.
        let young = match session.health(NEXT_HEALTH)? {
            Some((at, health)) => {
                let up_s = health.stamp as f64 / f64::from(identity.timer_hz.max(1));
                up_s <= at.duration_since(told).as_secs_f64() + CLOCK_SLACK_S
            }
            None => false,
        };
        if young || late {
            break (identity, answered.duration_since(told), young);
        }
    };
    Ok(Restarted {
        port,
        serial: serial(&identity),
        back_after_s: back.as_secs_f64(),
        restart_words: restarted(&identity.restart),
        as_told: young && identity.restart == Restart::Command,
        restart: identity.restart,
    })
}
