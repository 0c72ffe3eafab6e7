//! The chip: whether the program asked for the loader, the way into a program, and the line while it listens.
#![allow(unsafe_code)]

use core::panic::PanicInfo;

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use inm_firmware::update::{ASKED, Loader, start};
use inm_protocol::Hello;
use inm_protocol::image::{BOARD, MARK_LEN, mark};
use inm_protocol::slot::{HEADER, SLOT_STARTS};
use stm32f4xx_hal::gpio::GpioExt;
use stm32f4xx_hal::pac::{self, GPIOA, RCC, USART1};

use crate::flash::Flash;
use crate::line::Line;
use crate::{oscillator, uid};

/// Release of the loader.
const RELEASE: &str = env!("CARGO_PKG_VERSION");

/// What the loader says of itself to `inm flash`.
#[used]
static MARK: [u8; MARK_LEN] = mark(BOARD, RELEASE);

unsafe extern "C" {
    /// The word by which a program asks for the loader, from build.rs.
    static mut _loader_asked: u32;
}

/// Whether the program asked for the loader, once.
fn is_asked_for() -> bool {
    let word = &raw mut _loader_asked;
    // SAFETY: an aligned word of RAM that neither memory map gives to anything else; any bits are a word, and
    // nothing but this runs.
    unsafe {
        let asked = word.read_volatile() == ASKED;
        word.write_volatile(0);
        asked
    }
}

/// Starts the program of a slot, as a reset would if it lay at the start of the flash.
fn jump(slot: usize) -> ! {
    let vectors = SLOT_STARTS[slot] + HEADER;
    // SAFETY: the slot holds a whole program, whose vector table begins there and is aligned to 512 bytes;
    // the loader is left for good, no interrupt is on, and no peripheral was touched.
    unsafe {
        (*SCB::PTR).vtor.write(vectors);
        cortex_m::asm::bootload(core::ptr::with_exposed_provenance(vectors as usize))
    }
}

/// Starts a program, or listens for one.
pub fn run() -> ! {
    let (core, chip) = (cortex_m::Peripherals::take(), pac::Peripherals::take());
    let (Some(core), Some(chip)) = (core, chip) else {
        // Nobody has taken them before.
        SCB::sys_reset()
    };
    let mut flash = Flash::new(chip.FLASH);
    if !is_asked_for()
        && let Some(slot) = start(&mut flash)
    {
        jump(slot)
    }
    listen(core.SYST, chip.RCC, chip.GPIOA, chip.USART1, flash)
}

/// Listens until a program is to be started, and resets the chip.
fn listen(mut tick: SYST, rcc: RCC, gpio: GPIOA, usart: USART1, mut flash: Flash) -> ! {
    // Nothing in the image reads it; the linker would leave it out.
    core::hint::black_box(&MARK);
    let (mut rcc, _) = oscillator::start(rcc);
    flash.bypass_cache();
    let pins = gpio.split(&mut rcc);
    // Nobody may be connected: an open input picks up anything.
    let rx = pins.pa10.into_alternate::<7>().internal_pull_up(true);
    let mut line = Line::start(usart, pins.pa9, rx, &mut rcc);

    tick.set_clock_source(SystClkSource::Core);
    tick.set_reload(rcc.clocks.hclk().raw() / 1000 - 1);
    tick.clear_current();
    tick.enable_counter();
    let mut now_ms = 0;
    let hello = Hello {
        serial: uid::serial_number(),
        // Cannot fail: both are short.
        firmware: RELEASE.try_into().unwrap_or_default(),
        platform: BOARD.try_into().unwrap_or_default(),
        ..Hello::default()
    };
    let mut loader = Loader::new(flash, hello, now_ms);
    while !loader.is_over(now_ms) {
        // An erase takes no time by this clock: the core stands still, and then one turn is seen.
        now_ms += u64::from(tick.has_wrapped());
        if let Some(byte) = line.receive() {
            loader.take(byte, now_ms, |frame| line.send(frame));
        }
    }
    line.drain();
    SCB::sys_reset()
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    SCB::sys_reset()
}
