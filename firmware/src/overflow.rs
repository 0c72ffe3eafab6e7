//! What a full stack comes to: says why it was started, over the link, and then fills its stack.
//!
//! `tests/tests/qemu.rs` runs it and reads the reason of its second start. It uses no interrupts,
//! which QEMU 7.2 loses at some resets.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "board_qemu.rs"]
#[allow(dead_code)] // only the machine below it is used
mod board;
#[cfg(target_os = "none")]
#[allow(dead_code)] // the same
mod image;

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    // All zeros: in .bss, no image of it in flash.
    static mut BINS: inm_firmware::proof::ProofBins = inm_firmware::proof::ProofBins::new();
    image::stack::run(program, BINS)
}

#[cfg(target_os = "none")]
extern "C" fn program(_bins: &'static mut inm_firmware::proof::ProofBins) -> ! {
    use inm_protocol::Restart;
    use stm32f4xx_hal::pac::Peripherals;

    let chip = image::once(Peripherals::take());
    let say = |text: &[u8]| {
        for &byte in text {
            // QEMU's transmitter is always ready.
            chip.USART1.dr().write(|w| w.dr().set(byte.into()));
        }
    };
    chip.USART1.cr1().write(|w| w.ue().set_bit().te().set_bit());
    match image::restart::reason(false) {
        Restart::Power => {
            say(b"power;");
            core::hint::black_box(deeper(1));
        }
        Restart::Panic { line: 0, file } => {
            say(&file);
            say(b";");
        }
        _ => say(b"something else;"),
    }
    loop {
        cortex_m::asm::nop();
    }
}

/// Never comes back: each call takes some more of the stack.
#[cfg(target_os = "none")]
#[inline(never)]
#[allow(unconditional_recursion)] // that is what it is for
fn deeper(depth: u32) -> u32 {
    let taken = core::hint::black_box([depth; 16]);
    deeper(depth + 1) + taken[depth as usize % 16]
}

/// Off the target there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this fills its stack under QEMU; it is run by: cargo xtask test");
}
