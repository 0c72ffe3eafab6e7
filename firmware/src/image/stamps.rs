//! DRDY edges of the axis that triggers, from their interrupt to the loop.
//!
//! One stamp is kept, the latest: an edge that the loop was too late for has no word any more.

use core::cell::Cell;

use critical_section::Mutex;

use super::clock;

/// Time of the latest edge, until it is taken.
static STAMP: Mutex<Cell<Option<u64>>> = Mutex::new(Cell::new(None));

/// Now there was an edge; called first thing by the interrupt that tells of it.
pub fn stamp() {
    let now = clock::now();
    critical_section::with(|cs| STAMP.borrow(cs).set(Some(now)));
}

/// Time of the latest edge, once.
pub fn take() -> Option<u64> {
    critical_section::with(|cs| STAMP.borrow(cs).take())
}

/// Whether a stamp waits.
pub fn is_waiting() -> bool {
    critical_section::with(|cs| STAMP.borrow(cs).get().is_some())
}
