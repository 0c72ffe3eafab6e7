//! How deep the stack went.
//!
//! The start-up code paints the stack (feature `paint-stack` of cortex-m-rt); what is no longer
//! painted has been used.
#![allow(unsafe_code)]

use core::ptr;

use cortex_m_rt::STACK_PAINT_VALUE;
use inm_firmware::platform::Stack;

unsafe extern "C" {
    /// Lowest address of the stack, from memory.x.
    static mut _stack_end: u32;
    /// Address just above the stack, from memory.x.
    static _stack_start: u32;
}

/// Most ever used, and what there is. Walks over what was never used: about 0.1 ms.
pub fn measure() -> Stack {
    let bottom = &raw const _stack_end;
    let top = &raw const _stack_start;
    let mut lowest_used = bottom;
    // SAFETY: from `bottom` up to `top` all is RAM that memory.x reserves for the stack, and
    // reading it as words is valid whatever it holds; volatile, because calls and interrupts
    // write there behind the compiler's back.
    while lowest_used < top && unsafe { ptr::read_volatile(lowest_used) } == STACK_PAINT_VALUE {
        lowest_used = lowest_used.wrapping_add(1);
    }
    Stack {
        used: (top.addr() - lowest_used.addr()) as u32,
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
