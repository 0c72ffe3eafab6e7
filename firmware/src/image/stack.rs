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
    static _stack_end: u32;
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
