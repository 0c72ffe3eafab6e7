//! DRDY edges of the X axis, from their interrupt to the loop.

use core::sync::atomic::{AtomicBool, Ordering};

use heapless::spsc::{Consumer, Producer, Queue};

use super::clock;

/// Edges that may wait for the loop: 8 ms at 4000/s, longer than any one step takes.
const DEPTH: usize = 32 + 1;

/// An edge since [`take_edge`] last looked.
static EDGE: AtomicBool = AtomicBool::new(false);

/// The interrupt's end.
pub struct Stamper(Producer<'static, u64>);

/// The loop's end.
pub struct Stamps(Consumer<'static, u64>);

/// Both ends of the queue; `None` if they have been handed out before.
pub fn queue() -> Option<(Stamper, Stamps)> {
    let queue = cortex_m::singleton!(: Queue<u64, DEPTH> = Queue::new())?;
    let (producer, consumer) = queue.split();
    Some((Stamper(producer), Stamps(consumer)))
}

impl Stamper {
    /// Now there was an edge. A stamp that finds the queue full is dropped: conversions are
    /// numbered by the time between stamps, so it shows as a gap.
    pub fn stamp(&mut self) {
        let _ = self.0.enqueue(clock::now());
        EDGE.store(true, Ordering::Release);
    }
}

impl Stamps {
    /// Time of the oldest edge not yet taken.
    pub fn take(&mut self) -> Option<u64> {
        self.0.dequeue()
    }

    /// Whether none waits.
    pub fn is_empty(&self) -> bool {
        !self.0.ready()
    }
}

/// Whether there was an edge since the last call.
pub fn take_edge() -> bool {
    EDGE.swap(false, Ordering::AcqRel)
}
