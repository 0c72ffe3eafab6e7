//! The program's stack: apart from that of the handlers, and how deep it went.
//!
//! The start-up code paints the stack (feature `paint-stack` of cortex-m-rt); what is no longer
//! painted has been used.
#![allow(unsafe_code)]

use core::ptr;
use core::sync::atomic::{AtomicPtr, Ordering};

use cortex_m_rt::STACK_PAINT_VALUE;
use inm_firmware::platform::Stack;
use inm_firmware::proof::ProofBins;

unsafe extern "C" {
    /// Lowest address of the stack, from memory.x.
    static mut _stack_end: u32;
    /// Address just above the program's stack, where that of the handlers begins, from memory.x.
    static _program_stack_start: u32;
}

/// What the image does once it has a stack.
pub type Program = extern "C" fn(&'static mut ProofBins) -> !;

/// Runs `program` on the process stack (PSP) and leaves the main stack (MSP) to the handlers: they
/// can run when the program's is full. Called once, by `main`.
pub fn run(program: Program, bins: &'static mut ProofBins) -> ! {
    let top = &raw const _program_stack_start;
    // SAFETY: memory.x reserves the words below `top` for this stack alone, `top` is aligned to
    // eight bytes, and nothing has used it so far: the start-up code runs on the main stack. What
    // lies there stays as it is, since `main` never returns, and the program gets its argument as
    // the C calling convention has it, in r0. In thread mode bit 1 of CONTROL selects PSP
    // (ARMv7-M, B1.4.4).
    unsafe {
        core::arch::asm!(
            "msr psp, {top}",
            "mrs {scratch}, control",
            "orr {scratch}, {scratch}, #2",
            "msr control, {scratch}",
            "isb",
            "bx {program}",
            top = in(reg) top,
            scratch = in(reg) 0,
            program = in(reg) program,
            in("r0") bins,
            options(noreturn),
        )
    }
}

/// Whether the program's stack had no room for what an exception should have put at `address`.
pub fn overflows(address: usize) -> bool {
    address < (&raw const _stack_end).addr()
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
    let top = (&raw const _program_stack_start).cast_mut();
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
    let top = cortex_m::register::psp::read() as usize - FRAME;
    let mut word = &raw mut _stack_end;
    while word.addr() < top {
        // SAFETY: between the stack's end and this frame there is RAM that nothing uses;
        // an interrupt's frame there is gone again before this goes on.
        unsafe { ptr::write_volatile(word, STACK_PAINT_VALUE) };
        word = word.wrapping_add(1);
    }
}
