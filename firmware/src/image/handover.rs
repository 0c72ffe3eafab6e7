//! Giving a peripheral or a queue's end to an interrupt handler, once.

use core::cell::Cell;

use critical_section::Mutex;

/// A static through which the start-up code hands a value to an interrupt handler.
///
/// The handler takes it at its first run into a static of its own, so that no run after the
/// first needs a lock.
pub struct Handover<T>(Mutex<Cell<Option<T>>>);

impl<T> Handover<T> {
    /// Nothing to take yet.
    pub const fn new() -> Self {
        Self(Mutex::new(Cell::new(None)))
    }

    /// Leaves `value` for the handler.
    pub fn give(&self, value: T) {
        critical_section::with(|cs| self.0.borrow(cs).set(Some(value)));
    }

    /// Moves what was given into the handler's own `slot`, if it has not been already.
    pub fn receive<'a>(&self, slot: &'a mut Option<T>) -> Option<&'a mut T> {
        if slot.is_none() {
            *slot = critical_section::with(|cs| self.0.borrow(cs).take());
        }
        slot.as_mut()
    }
}
