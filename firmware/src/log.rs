//! What goes wrong, for a debug probe: frames of defmt, which the image sends over RTT. Each is told where it is told to
//! the host, so that neither knows of trouble that the other does not.
//!
//! A frame takes some microseconds in which no interrupt is served, so nothing is logged that happens without trouble.
//! Where nobody listens the buffer stays full and frames are given up. Off the target there is no probe, and nothing
//! is said.

use inm_protocol::{AXES, AxisCounters, Event, LinkCounters, Refusal};

/// Counters as they were last logged.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Logged {
    axes: [AxisCounters; AXES],
    link: LinkCounters,
}

impl Logged {
    /// Logs the counters that have grown since the last time, all in one line for an axis and one for the link. What
    /// has an event of its own was logged with it.
    #[inline(never)]
    pub(crate) fn counters(&mut self, axes: [AxisCounters; AXES], link: &LinkCounters) {
        for (axis, (old, new)) in self.axes.iter_mut().zip(axes).enumerate() {
            let grown = [
                new.over_range.wrapping_sub(old.over_range),
                new.torn.wrapping_sub(old.torn),
                new.missed.wrapping_sub(old.missed),
            ];
            if grown != [0; 3] {
                words(axis, grown);
            }
            *old = new;
        }
        let grown = [
            link.frames_dropped.wrapping_sub(self.link.frames_dropped),
            link.frames_bad.wrapping_sub(self.link.frames_bad),
            link.bytes_lost.wrapping_sub(self.link.bytes_lost),
        ];
        if grown != [0; 3] {
            line(grown);
        }
        self.link = *link;
    }
}

#[cfg(target_os = "none")]
mod said {
    use super::{Event, Refusal};

    /// Names of the axes; nothing for what concerns all.
    const NAMES: [&str; 4] = ["X", "Y", "Z", "all axes"];

    /// An event of the stream.
    #[cold]
    pub(crate) fn event(event: &Event) {
        let axis = event.axis.map_or(3, usize::from);
        let name = NAMES.get(axis).copied().unwrap_or_default();
        defmt::warn!(
            "{=str}, conversion {=u64}: {}",
            name,
            event.index,
            event.trouble
        );
    }

    /// An event that found no room to wait for the link.
    #[cold]
    pub(crate) fn event_lost() {
        defmt::error!("the event is not told to the host: too many wait already");
    }

    /// A command that was refused.
    #[cold]
    pub(crate) fn refused(id: u16, refusal: &Refusal) {
        defmt::warn!("command {=u16} refused: {}", id, refusal);
    }

    /// Words of an axis since the last time: clipped, torn, missed.
    #[cold]
    pub(super) fn words(axis: usize, [clipped, torn, missed]: [u32; 3]) {
        let name = NAMES.get(axis).copied().unwrap_or_default();
        defmt::warn!(
            "{=str}: words clipped by the converter {=u32}, perhaps changed while they were read {=u32}, conversions without \
             a new word {=u32}",
            name,
            clipped,
            torn,
            missed
        );
    }

    /// Trouble of the link since the last time: frames given up, damaged, bytes lost.
    #[cold]
    pub(super) fn line([dropped, bad, lost]: [u32; 3]) {
        defmt::warn!(
            "link: frames given up {=u32}, frames of the host not understood {=u32}, bytes of the host lost {=u32}",
            dropped,
            bad,
            lost
        );
    }
}

#[cfg(not(target_os = "none"))]
mod said {
    use super::{Event, Refusal};

    pub(crate) fn event(_: &Event) {}
    pub(crate) fn event_lost() {}
    pub(crate) fn refused(_: u16, _: &Refusal) {}
    pub(super) fn words(_: usize, _: [u32; 3]) {}
    pub(super) fn line(_: [u32; 3]) {}
}

pub(crate) use said::{event, event_lost, refused};
use said::{line, words};
