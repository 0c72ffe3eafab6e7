//! The loader: the first sector of the flash, never replaced over the line.
//!
//! ```text
//!   reset --> asked for by the program? --no--> a slot to start? --yes--> vectors, stack, jump
//!                    |                               |                    (nothing of the chip was touched)
//!                    +--yes--> listen <--------no----+
//!                                |
//!                                +-- ToLoader::Start, or nobody for a while --> reset
//! ```
//!
//! It listens with clocks, USART and flash only: no pin of the converters is driven, no interrupt is on, and
//! no watchdog runs, so that an erase may take its time. It leaves by a reset alone, so that a program finds
//! the chip as every reset leaves it. Not tried on hardware.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod flash;
#[cfg(target_os = "none")]
mod line;
#[cfg(target_os = "none")]
#[path = "../board/oscillator.rs"]
mod oscillator;
#[cfg(target_os = "none")]
#[path = "../board/uid.rs"]
mod uid;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    chip::run()
}

/// Off the target there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is the loader of the board; build it with: cargo xtask firmware");
}
