//! What no catalogue holds: found, but not to be named.

mod beating_tone;
mod chirp;
mod garch;
mod lopsided;
mod moving_corner;
mod multiplicative;
mod switched;
mod tone_bursts;

use super::effect::Kind;

/// Where and how something without a name shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// Power between these frequencies, hertz.
    Band(f64, f64),
    /// Noise whose strength changes in time.
    Variance,
    /// A law of amplitudes that is not normal.
    Amplitude,
}

/// Every kind.
pub static KINDS: &[Kind] = &[
    Kind {
        name: "beating_tone",
        axes: 1,
        draw: beating_tone::draw,
    },
    Kind {
        name: "switched",
        axes: 1,
        draw: switched::draw,
    },
    Kind {
        name: "multiplicative",
        axes: 1,
        draw: multiplicative::draw,
    },
    Kind {
        name: "tone_bursts",
        axes: 1,
        draw: tone_bursts::draw,
    },
    Kind {
        name: "moving_corner",
        axes: 1,
        draw: moving_corner::draw,
    },
    Kind {
        name: "lopsided",
        axes: 1,
        draw: lopsided::draw,
    },
    Kind {
        name: "garch",
        axes: 1,
        draw: garch::draw,
    },
    Kind {
        name: "chirp",
        axes: 1,
        draw: chirp::draw,
    },
    Kind {
        name: "drifting_corner",
        axes: 1,
        draw: moving_corner::drifting,
    },
];

/// The kind of this name.
pub fn find(name: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.name == name)
}
