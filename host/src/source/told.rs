//! Whether every notice of the board has arrived: the board counts them, once a second.

use inm_protocol::{AXES, Event, Health};

/// Notices of axes that were taken out of the stream: those that came, and those that the board
/// counts.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Told {
    arrived: [u32; AXES],
    /// By axis: what the board counted before the first that could have arrived here.
    before: Option<[u32; AXES]>,
}

impl Told {
    /// A notice came.
    pub fn event(&mut self, event: &Event) {
        let arrived = event
            .axis
            .and_then(|axis| self.arrived.get_mut(usize::from(axis)));
        if let Some(arrived) = arrived.filter(|_| event.trouble.is_reset_for()) {
            *arrived = arrived.wrapping_add(1);
        }
    }

    /// The axes of which a notice has not arrived, by the board's own count, which stands behind all
    /// notices that it counts.
    pub fn unheard(&mut self, health: &Health) -> [bool; AXES] {
        let counted = health.axes.map(|axis| {
            let first = axis.slipped.wrapping_add(axis.stuck);
            first
                .wrapping_add(axis.stalled)
                .wrapping_add(axis.registers_lost)
        });
        let arrived = std::mem::take(&mut self.arrived);
        let before = self.before.replace(counted);
        core::array::from_fn(|axis| {
            let told = before.map(|before| before[axis].wrapping_add(arrived[axis]));
            // A board that has restarted counts from 0 again.
            told.is_some_and(|told| counted[axis] > told)
        })
    }
}
