//! DRDY edges of the X axis, from their interrupt to the loop.
//!
//! One stamp is kept, the latest: an edge that the loop was too late for has no word any more.

use core::cell::Cell;
use core::sync::atomic::{AtomicBool, Ordering};

use critical_section::Mutex;

use super::clock;

/// Time of the latest edge, until it is taken.
static STAMP: Mutex<Cell<Option<u64>>> = Mutex::new(Cell::new(None));

/// An edge since [`take_edge`] last looked.
static EDGE: AtomicBool = AtomicBool::new(false);

/// Now there was an edge; called first thing by the interrupt that tells of it.
pub fn stamp() {
    let now = clock::now();
    critical_section::with(|cs| STAMP.borrow(cs).set(Some(now)));
    EDGE.store(true, Ordering::Release);
}

/// Time of the latest edge, once.
pub fn take() -> Option<u64> {
    critical_section::with(|cs| STAMP.borrow(cs).take())
}

/// Whether a stamp waits.
pub fn is_waiting() -> bool {
    critical_section::with(|cs| STAMP.borrow(cs).get().is_some())
}

/// Whether there was an edge since the last call, whoever took its stamp.
pub fn take_edge() -> bool {
    EDGE.swap(false, Ordering::AcqRel)
}
