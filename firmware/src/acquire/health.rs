//! The record that is sent once a second.

use inm_protocol::{BATCH_LEN, BinsMark, Health, LinkCounters};

use super::{Instrument, Stage};
use crate::{Part, Platform};

/// Data periods that a record waits for its place in the stream: a batch begins in each
/// [`BATCH_LEN`], unless conversions have stopped.
const PATIENCE: u32 = 2 * BATCH_LEN as u32;

/// Conversions that may have been gathered when the bins are marked: handing them to the link takes time.
const FEW: usize = 4;

impl<P: Platform> Instrument<P> {
    /// Works on the record that is due, `converted` telling whether this step has read a
    /// conversion; `true` if there was something to do.
    ///
    /// A step that did all of it would cost a conversion at 4000/s, and so would two long steps behind
    /// each other. While conversions come the bins are marked early in a batch, when little waits to be
    /// framed, and the record leaves after that; each behind a conversion that took no longer than most.
    pub(super) fn report_health(&mut self, converted: bool, now: u64) -> bool {
        let overdue = now >= self.next_health + self.clock.periods(PATIENCE);
        let prompt = converted && self.is_prompt();
        if matches!(self.stage, Stage::Stream) && self.mark.is_none() && !overdue {
            if !prompt || self.batcher.len() > FEW {
                return false;
            }
            self.platform.enter(Part::Health);
            self.mark = self.mark_bins();
            self.platform.enter(Part::Rest);
            if self.mark.is_some() {
                return true;
            }
        } else if self.mark.is_some() && !prompt && !overdue {
            return false;
        }
        let second = u64::from(self.board.timer_hz);
        self.next_health += second;
        if self.next_health <= now {
            // The board was held up for more than a second.
            self.next_health = now + second;
        }
        let mark = self.mark.take();
        self.send_health(now, mark);
        true
    }

    /// Whether no batch was framed in this step, nor in the last one, nor a register read back: a
    /// quarter of the data period is left.
    pub(super) fn is_prompt(&self) -> bool {
        let took = self.position.since(self.platform.now());
        self.batcher.len() > 0 && took <= self.clock.periods(3) / 4
    }

    /// Sends what has been gathered, so that the host can compare the bins as soon as it is told
    /// what they hold; `None` if they have not begun.
    fn mark_bins(&mut self) -> Option<BinsMark> {
        self.flush_batch();
        self.platform.bins().mark(self.position.next_index())
    }

    /// Sends a health record. It carries the mark that was taken of the bins, or one behind all
    /// conversions that were read.
    pub(super) fn send_health(&mut self, now: u64, mark: Option<BinsMark>) {
        self.platform.enter(Part::Health);
        let mark = mark.or_else(|| self.mark_bins());
        let streaming = self.is_streaming();
        let stack = self.platform.stack();
        let (stream, index) = if streaming {
            (self.position.stream, self.position.next_index())
        } else {
            (0, 0)
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
            bins: mark.filter(|_| streaming),
            stream,
        };
        self.logged.counters(health.axes, &health.link);
        self.outbox.health(&mut self.platform, health);
        self.platform.enter(Part::Rest);
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
