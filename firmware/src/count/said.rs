//! Lines of text out of QEMU, and the way to end it (Arm, Semihosting for AArch32 and AArch64).
#![allow(unsafe_code)]

use core::fmt::{Arguments, Write};

use cortex_m::asm::semihosting_syscall;
use heapless::String;

/// Writes the text up to a zero.
const SYS_WRITE0: u32 = 0x04;
/// Ends the program that runs the image.
const SYS_EXIT: u32 = 0x18;
/// All went well, for [`SYS_EXIT`].
const APPLICATION_EXIT: u32 = 0x2_0026;

/// Says a line of at most 126 bytes.
pub fn line(text: Arguments<'_>) {
    let mut line: String<128> = String::new();
    // What does not fit is left out; the reader finds the line too short.
    let _ = line.write_fmt(text);
    let _ = line.push_str("\n\0");
    // SAFETY: the argument points to text that ends in a zero.
    unsafe { semihosting_syscall(SYS_WRITE0, line.as_ptr() as u32) };
}

/// Ends QEMU.
pub fn end() -> ! {
    loop {
        // SAFETY: the call takes no pointer.
        unsafe { semihosting_syscall(SYS_EXIT, APPLICATION_EXIT) };
    }
}
