//! Which names are accepted for each disturbance, and which may stand beside them.
//!
//! Written before any detector for them: what an engineer who saw the record would sign. `shock`, `unnamed`,
//! `wandering_line`, `drift`, `stuck`, `averaging` are names that a catalogue may have. `motion` was added when the catalogue
//! had it, wherever `burst` stood: a stretch of other noise, of a spectrum of its own; and `held` beside `stale`, which is the
//! same by chance instead of by a clock. The filters (`sensor`, `decimated`, `scripted`) were added on 2026-11-28, with the roll-offs
//! of several poles.

use super::record::{Disturbance, Room};
use super::{logger, machine, motion, warmth};
use crate::hidden::draw::Draw;

/// A disturbance and what may be said of it.
pub struct Everyday {
    /// What it is.
    pub name: &'static str,
    /// Names of findings any of which is right.
    pub names: &'static [&'static str],
    /// Names of findings that may stand beside one of them, and say nothing wrong.
    pub beside: &'static [&'static str],
    /// Samples a second that it needs.
    pub rate_hz: f64,
    /// Draws one.
    pub draw: fn(&Room, &mut Draw) -> Disturbance,
}

/// Allowance for the time of an event, seconds, where the event is not longer itself.
pub const TOLERANCE_S: f64 = 1.0;

/// Every disturbance.
pub static EVERYDAY: &[Everyday] = &[
    // One blow that rings: a transient; a short stretch of larger noise is the same said less well.
    Everyday {
        name: "knock",
        names: &["shock", "burst", "motion"],
        beside: &[],
        rate_hz: 100.0,
        draw: motion::knock,
    },
    Everyday {
        name: "door",
        names: &["shock", "burst", "motion"],
        beside: &[],
        rate_hz: 100.0,
        draw: motion::door,
    },
    // Some dozens of small blows: each by itself or the stretch.
    Everyday {
        name: "footsteps",
        names: &["shock", "burst", "motion"],
        beside: &[],
        rate_hz: 100.0,
        draw: motion::footsteps,
    },
    // Coloured noise that swells and fades.
    Everyday {
        name: "lorry",
        names: &["burst", "shock", "motion"],
        beside: &[],
        rate_hz: 100.0,
        draw: motion::lorry,
    },
    // The sensor lies otherwise afterwards: a step at the same time is no invention.
    Everyday {
        name: "handling",
        names: &["shock", "burst", "motion"],
        beside: &["steps"],
        rate_hz: 100.0,
        draw: motion::handling,
    },
    Everyday {
        name: "fan",
        names: &["wandering_line"],
        beside: &["wandering_line"],
        rate_hz: 100.0,
        draw: machine::fan,
    },
    // However it wanders, it is the mains.
    Everyday {
        name: "mains",
        names: &["hum"],
        beside: &[],
        rate_hz: 500.0,
        draw: machine::mains,
    },
    // Up and down with the thermostat: slow, periodic, no noise. Lines at its period are right too, all of them together as
    // well, and so is a settling: the box is cold when the record begins.
    Everyday {
        name: "heater",
        names: &["drift", "sinusoid", "hum", "steps"],
        beside: &["drift", "sinusoid", "hum", "steps", "warmup"],
        rate_hz: 10.0,
        draw: warmth::heater,
    },
    Everyday {
        name: "two_warmups",
        names: &["warmup", "drift"],
        beside: &["warmup", "drift"],
        rate_hz: 10.0,
        draw: warmth::two_warmups,
    },
    Everyday {
        name: "held",
        names: &["held", "stale"],
        beside: &[],
        rate_hz: 10.0,
        draw: logger::held,
    },
    Everyday {
        name: "averaged",
        names: &["averaging", "rolloff"],
        beside: &[],
        rate_hz: 10.0,
        draw: logger::averaged,
    },
    // Filters as parts and programs have them; that doubles lie on a grid is so.
    Everyday {
        name: "sensor",
        names: &["rolloff", "averaging"],
        beside: &["quantisation"],
        rate_hz: 10.0,
        draw: logger::sensor,
    },
    Everyday {
        name: "decimated",
        names: &["averaging", "rolloff"],
        beside: &["quantisation"],
        rate_hz: 10.0,
        draw: logger::decimated,
    },
    Everyday {
        name: "scripted",
        names: &["rolloff", "averaging"],
        beside: &[],
        rate_hz: 10.0,
        draw: logger::scripted,
    },
    Everyday {
        name: "coupled",
        names: &["highpass"],
        beside: &[],
        rate_hz: 10.0,
        draw: logger::coupled,
    },
];

/// The disturbance of this name.
pub fn find(name: &str) -> Option<&'static Everyday> {
    EVERYDAY.iter().find(|one| one.name == name)
}
