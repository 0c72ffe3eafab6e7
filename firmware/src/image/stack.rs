//! How deep the stack went.
//!
//! The start-up code paints the stack (feature `paint-stack` of cortex-m-rt); what is no longer
//! painted has been used.
#![allow(unsafe_code)]

use core::ptr;
use core::sync::atomic::{AtomicPtr, Ordering};

use cortex_m_rt::STACK_PAINT_VALUE;
use inm_firmware::platform::Stack;

unsafe extern "C" {
    /// Lowest address of the stack, from memory.x.
    static mut _stack_end: u32;
    /// Address just above the stack, from memory.x.
    static _stack_start: u32;
}

/// Words looked at in one call: a sixteenth of the stack, 2000 instructions.
const SLICE: usize = 512;

/// Lowest word known to have been used; none before the first call.
static MARK: AtomicPtr<u32> = AtomicPtr::new(ptr::null_mut());

/// Where the next call goes on.
static NEXT: AtomicPtr<u32> = AtomicPtr::new(ptr::null_mut());

/// Most used as far as is known, and what there is.
///
/// The first call walks over all that was never used. Each one after it looks at a slice of
/// that and the next call at the next, since the whole takes longer than a conversion at
/// 4000/s: what went deeper shows after 16 calls at most.
pub fn measure() -> Stack {
    let bottom = &raw mut _stack_end;
    let top = (&raw const _stack_start).cast_mut();
    let known = MARK.load(Ordering::Relaxed);
    let (from, to) = if known.is_null() {
        (bottom, top)
    } else {
        let from = NEXT.load(Ordering::Relaxed);
        (from, from.wrapping_add(SLICE).min(known))
    };
    let mut word = from;
    // SAFETY: from `bottom` up to `top` all is RAM that memory.x reserves for the stack, and
    // reading it as words is valid whatever it holds; volatile, because calls and interrupts
    // write there behind the compiler's back.
    while word < to && unsafe { ptr::read_volatile(word) } == STACK_PAINT_VALUE {
        word = word.wrapping_add(1);
    }
    let found = known.is_null() || word < to;
    let mark = if found { word } else { known };
    MARK.store(mark, Ordering::Relaxed);
    let next = if found || to == known { bottom } else { to };
    NEXT.store(next, Ordering::Relaxed);
    Stack {
        used: (top.addr() - mark.addr()) as u32,
        size: (top.addr() - bottom.addr()) as u32,
    }
}

/// Paints again what is not in use: the mark then tells of what runs from here on.
#[cfg(feature = "qemu")]
#[inline(never)]
pub fn repaint() {
    // The compiler may read the pointer before it makes room for this function's own frame.
    const FRAME: usize = 256;
    let top = cortex_m::register::msp::read() as usize - FRAME;
    let mut word = &raw mut _stack_end;
    while word.addr() < top {
        // SAFETY: between the stack's end and this frame there is RAM that nothing uses;
        // an interrupt's frame there is gone again before this goes on.
        unsafe { ptr::write_volatile(word, STACK_PAINT_VALUE) };
        word = word.wrapping_add(1);
    }
}
