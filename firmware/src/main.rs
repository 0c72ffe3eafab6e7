//! The image: the instrument on an STM32F405, or on QEMU's model of one (feature `qemu`).
//!
//! ```text
//!   board | board_qemu   clocks, pins and the converters' side of the machine
//!   image                what both share: link, clock, restart, stack, the platform itself
//!   main                 the super-loop
//! ```
//!
//! Interrupts only stamp DRDY edges and move link bytes, on a stack of their own; everything else
//! happens in the loop.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(all(target_os = "none", not(feature = "qemu")))]
mod board;
#[cfg(all(target_os = "none", feature = "qemu"))]
#[path = "board_qemu.rs"]
mod board;
#[cfg(target_os = "none")]
mod image;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    // All zeros: in .bss, no image of it in flash.
    static mut BINS: inm_firmware::proof::ProofBins = inm_firmware::proof::ProofBins::new();
    image::stack::run(program, BINS)
}

#[cfg(target_os = "none")]
extern "C" fn program(bins: &'static mut inm_firmware::proof::ProofBins) -> ! {
    let (machine, converters, sync) = board::start(bins);
    defmt::info!("start, {}", defmt::Debug2Format(machine.restart()));
    let mut instrument = inm_firmware::Instrument::new(machine, converters, sync);
    loop {
        if !instrument.step() {
            instrument.platform().sleep();
        }
    }
}

/// Off the target there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is the firmware of the board; build it with: cargo xtask firmware");
}
