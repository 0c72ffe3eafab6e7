//! A pulse that comes once a second, as a GNSS receiver gives it, by the board's timer.

use serde::{Deserialize, Serialize};

/// An edge at the board's input for a pulse a second. Sent as it comes, streaming or not; a board without such
/// a signal sends none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Pulse {
    /// Board timer at the rising edge, ticks: held by the timer itself, however late the program reads it.
    pub stamp: u64,
    /// Counts the pulses since the start of the board, sent or not; wraps. A number that is missing found no
    /// room on the link.
    pub number: u32,
    /// More than one edge had come by the time that the program looked: the stamp is that of the last, and of no
    /// use.
    pub doubled: bool,
    /// What was wrong with the pulses since the start of the board.
    pub counters: PulseCounters,
}

/// What was wrong with the pulses of a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct PulseCounters {
    /// Edges within half a second of one that was told; these are not.
    pub early: u32,
    /// Pulses of more than one edge, as [`Pulse::doubled`].
    pub doubled: u32,
    /// Seconds without a pulse, between two that are whole seconds apart.
    pub missing: u32,
    /// Times that the time between two was no whole number of seconds, to 2 %.
    pub odd: u32,
}
