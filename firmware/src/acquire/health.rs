//! The record that is sent once a second.

use inm_protocol::{Health, LinkCounters};

use super::Instrument;
use crate::Platform;

impl<P: Platform> Instrument<P> {
    /// Sends the record that is due now.
    pub(super) fn report_health(&mut self, now: u64) {
        let second = u64::from(self.board.timer_hz);
        self.next_health += second;
        if self.next_health <= now {
            // The board was held up for more than a second.
            self.next_health = now + second;
        }
        self.send_health(now);
    }

    /// Sends a health record, behind all conversions that were read: what it says of the bins
    /// can be compared as soon as it arrives.
    pub(super) fn send_health(&mut self, now: u64) {
        self.flush_batch();
        let streaming = self.is_streaming();
        let stack = self.platform.stack();
        let index = if streaming {
            self.position.next_index()
        } else {
            0
        };
        let health = Health {
            stamp: now,
            index,
            streaming,
            mcu_centi_celsius: self.platform.temperature_centi_celsius(),
            supply_mv: self.platform.supply_mv(),
            registers: self.registers,
            axes: core::array::from_fn(|axis| self.axes[axis].counters),
            link: self.link_counters(),
            lost_conversions: self.lost_conversions,
            stack_used: stack.used,
            stack_size: stack.size,
            bins: self.platform.bins().mark(index).filter(|_| streaming),
        };
        self.outbox.health(&mut self.platform, health);
    }

    fn link_counters(&self) -> LinkCounters {
        let counts = self.decoder.counts();
        let saturated = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
        LinkCounters {
            frames_sent: self.outbox.sent,
            frames_dropped: self.outbox.given_up,
            frames_bad: saturated(counts.faults),
            bytes_lost: saturated(counts.bytes_lost).saturating_add(self.platform.receive_lost()),
        }
    }
}
