//! What goes wrong on a board, as it says it over the serial line: its events in words, and the counters
//! of its health records where they grow.

use inm_protocol::{AXES, AxisCounters, Event, Health, LinkCounters, Pulse, PulseCounters, ToHost};
use jiff::Timestamp;
use serde::Serialize;

use super::{AXIS_NAMES, Heard};
use crate::link::{axis_name, describe};

/// One line of the log.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    /// Wall clock of this machine when it arrived, RFC 3339.
    pub at: String,
    /// Time since the board started by its last health record, seconds; `None` ahead of the first.
    pub up_s: Option<f64>,
    /// X, Y or Z; `None` where it concerns all.
    pub axis: Option<String>,
    /// Conversion at which it was noticed; `None` of what has none.
    pub conversion: Option<u64>,
    /// What happened, in words.
    pub what: String,
}

/// Messages of a board turned into entries.
#[derive(Debug)]
pub struct Log {
    timer_hz: u32,
    last: Option<Health>,
    /// Events of each axis since the last health record that it counts as resets.
    told: [u32; AXES],
    /// The last pulse a second.
    pulse: Option<Pulse>,
}

impl Log {
    /// The log of a board whose stamps have `timer_hz` ticks a second.
    pub fn new(timer_hz: u32) -> Self {
        Self {
            timer_hz: timer_hz.max(1),
            last: None,
            told: [0; AXES],
            pulse: None,
        }
    }

    /// What a message says of trouble. Samples and replies say nothing.
    pub fn take(&mut self, heard: &Heard) -> Vec<Entry> {
        match &heard.message {
            ToHost::Event(event) => vec![self.event(event)],
            ToHost::Health(health) => self.health(health),
            ToHost::Pulse(pulse) => self.pulse(pulse),
            _ => Vec::new(),
        }
    }

    /// An entry in our own words, at this moment.
    pub fn say(&self, what: impl Into<String>) -> Entry {
        let up_s = |health: Health| health.stamp as f64 / f64::from(self.timer_hz);
        Entry {
            at: Timestamp::now().to_string(),
            up_s: self.last.map(up_s),
            axis: None,
            conversion: None,
            what: what.into(),
        }
    }

    /// Whether this record is of a board that has started since the last one.
    pub fn has_restarted(&self, heard: &Heard) -> bool {
        match (&heard.message, self.last) {
            (ToHost::Health(health), Some(last)) => health.stamp < last.stamp,
            _ => false,
        }
    }

    fn event(&mut self, event: &Event) -> Entry {
        if let Some(axis) = event.axis
            && event.trouble.is_reset_for()
            && let Some(told) = self.told.get_mut(usize::from(axis))
        {
            *told += 1;
        }
        Entry {
            axis: event.axis.map(|axis| axis_name(axis).to_string()),
            conversion: Some(event.index),
            ..self.say(describe(event.trouble))
        }
    }

    fn pulse(&mut self, pulse: &Pulse) -> Vec<Entry> {
        let before = self.pulse.filter(|last| last.stamp <= pulse.stamp);
        self.pulse = Some(*pulse);
        let begun = match before {
            Some(_) => None,
            None => Some(self.say("a pulse a second comes")),
        };
        let old = before.map_or_else(PulseCounters::default, |before| before.counters);
        let since = match before {
            Some(_) => "",
            None => " since it started",
        };
        let grown = pulse_counters(&old, &pulse.counters).into_iter();
        let grown = grown.map(|(count, what)| self.say(format!("{count} {what}{since}")));
        begun.into_iter().chain(grown).collect()
    }

    fn health(&mut self, health: &Health) -> Vec<Entry> {
        let before = self.last.filter(|last| last.stamp <= health.stamp);
        self.last = Some(*health);
        let mut entries = Vec::new();
        let streamed = before.map(|before| before.streaming);
        if streamed.is_some_and(|streamed| streamed != health.streaming) {
            let what = ["the stream has ended", "a stream has begun"];
            entries.push(self.say(what[usize::from(health.streaming)]));
        }
        let since = match before {
            Some(_) => "",
            None => " since it started",
        };
        for (axis, name) in AXIS_NAMES.iter().enumerate() {
            let old = before.map_or_else(AxisCounters::default, |before| before.axes[axis]);
            let told = std::mem::take(&mut self.told[axis]);
            let grown = axis_counters(&old, &health.axes[axis], told, before.is_none());
            entries.extend(grown.into_iter().map(|(count, what)| Entry {
                axis: Some((*name).to_owned()),
                ..self.say(format!("{count} {what}{since}"))
            }));
        }
        let old = before.map_or_else(LinkCounters::default, |before| before.link);
        for (count, what) in link_counters(&old, &health.link) {
            entries.push(self.say(format!("{count} {what}{since}")));
        }
        entries
    }
}

/// Counters of the pulse a second that have grown, with what they count.
fn pulse_counters(old: &PulseCounters, new: &PulseCounters) -> Vec<(u32, &'static str)> {
    grown([
        (
            new.missing.wrapping_sub(old.missing),
            "seconds without a pulse",
        ),
        (
            new.doubled.wrapping_sub(old.doubled),
            "pulses of more than one edge",
        ),
        (
            new.odd.wrapping_sub(old.odd),
            "pulses no whole number of seconds behind the one before",
        ),
        (
            new.early.wrapping_sub(old.early),
            "edges within half a second of a pulse",
        ),
    ])
}

/// Counters of an axis that have grown, with what they count. Resets have events of their own: only
/// those of which no event came are told, or all of them in the `first` record of a board.
fn axis_counters(
    old: &AxisCounters,
    new: &AxisCounters,
    told: u32,
    first: bool,
) -> Vec<(u32, &'static str)> {
    let resets = |counters: &AxisCounters| {
        counters
            .slipped
            .wrapping_add(counters.stuck)
            .wrapping_add(counters.stalled)
            .wrapping_add(counters.registers_lost)
    };
    let (told, untold) = if first {
        (0, "times taken out of the stream and reset")
    } else {
        (
            told,
            "times taken out of the stream and reset, without a notice that arrived",
        )
    };
    let counts = [
        (
            new.over_range.wrapping_sub(old.over_range),
            "words clipped by the converter",
        ),
        (
            new.torn.wrapping_sub(old.torn),
            "words that may have changed while they were read",
        ),
        (
            new.missed.wrapping_sub(old.missed),
            "conversions without a new word",
        ),
        (
            resets(new).wrapping_sub(resets(old)).saturating_sub(told),
            untold,
        ),
    ];
    grown(counts)
}

/// Counters of the link that have grown, with what they count.
fn link_counters(old: &LinkCounters, new: &LinkCounters) -> Vec<(u32, &'static str)> {
    grown([
        (
            new.frames_dropped.wrapping_sub(old.frames_dropped),
            "frames given up: the host is slower than the line",
        ),
        (
            new.frames_bad.wrapping_sub(old.frames_bad),
            "frames from the host that the board could not decode",
        ),
        (
            new.bytes_lost.wrapping_sub(old.bytes_lost),
            "bytes from the host that the board lost or threw away",
        ),
    ])
}

fn grown<const N: usize>(counts: [(u32, &'static str); N]) -> Vec<(u32, &'static str)> {
    counts.into_iter().filter(|(count, _)| *count > 0).collect()
}

#[cfg(test)]
mod tests;
