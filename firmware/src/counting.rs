//! How many instructions a conversion takes: the program of the QEMU image, with a counter.
//!
//! `cargo xtask instructions` builds and runs it and makes a table of what it says. It has to run
//! with `-icount shift=0`: an instruction then takes a nanosecond of QEMU's time, whatever it
//! is, and QEMU's timers count nanoseconds. Interrupts are let in between two steps only, so
//! that none is counted as part of another thing.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "board_qemu.rs"]
mod board;
#[cfg(target_os = "none")]
mod count;
#[cfg(target_os = "none")]
mod image;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    // All zeros: in .bss, no image of it in flash.
    static mut BINS: inm_firmware::proof::ProofBins = inm_firmware::proof::ProofBins::new();
    image::stack::run(count::run, BINS)
}

/// Off the target there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this counts instructions under QEMU; run it with: cargo xtask instructions");
}
