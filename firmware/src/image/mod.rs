//! What the board and QEMU's model of it share.
//!
//! ```text
//!   clock     64-bit time from a 32-bit timer; the heartbeat that wakes the loop
//!   stamps    DRDY edges of the axis that triggers: interrupt to loop
//!   link      USART: two queues and their interrupt
//!   flash     the sectors for what is kept while the board is off
//!   restart   why the board started; the panic and fault handlers
//!   stack     the program's own, and how deep it went
//!   machine   all of it as the instrument's platform
//!   ask       a word in RAM by which the program asks for the loader, and the loader finds it
//!   handover  what the start-up code gives to an interrupt, once
//! ```

pub mod ask;
pub mod clock;
pub mod flash;
pub mod handover;
pub mod link;
pub mod machine;
pub mod restart;
pub mod stack;
pub mod stamps;

use inm_firmware::Board;
use inm_firmware::platform::BAUD;
use inm_protocol::image::{MARK_LEN, mark};
use inm_protocol::{Restart, SensorRange};
use stm32f4xx_hal::gpio::PushPull;
use stm32f4xx_hal::pac::{IWDG, USART1};
use stm32f4xx_hal::prelude::_fugit_ExtU32 as _;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{CommonPins, Serial, config};
use stm32f4xx_hal::time::Bps;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

// defmt's log channel: RTT, read by the debug probe.
use defmt_rtt as _;

/// SCLK, hertz: 84 MHz / 64 and 42 MHz / 32. The next step up, 2.625 MHz, is over the
/// converter's 2.048 MHz.
pub const SPI_HZ: u32 = 1_312_500;

/// A loop that hangs this long is restarted, milliseconds; one step takes 2 ms at most.
const WATCHDOG_MS: u32 = 1000;

/// What the image is built for.
#[cfg(not(feature = "qemu"))]
const PLATFORM: &str = inm_protocol::image::BOARD;
#[cfg(feature = "qemu")]
const PLATFORM: &str = inm_protocol::image::QEMU;

/// What the image says of itself to `inm flash`.
#[used]
static MARK: [u8; MARK_LEN] = mark(PLATFORM, env!("CARGO_PKG_VERSION"));

/// The board's description; both images claim the same analog side.
pub fn describe(serial: [u32; 3], timer_hz: u32, restart: Restart) -> Board {
    // Nothing in the image reads it; the linker would leave it out.
    core::hint::black_box(&MARK);
    Board {
        platform: PLATFORM,
        serial,
        timer_hz,
        spi_hz: SPI_HZ,
        baud: BAUD,
        range: SensorRange::G4,
        reference_uv: 5_000_000,
        sensor_supply_uv: 2_800_000,
        restart,
    }
}

/// Starts the watchdog; nothing stops it again.
pub fn start_watchdog(iwdg: IWDG) -> IndependentWatchdog {
    let mut watchdog = IndependentWatchdog::new(iwdg);
    watchdog.start(WATCHDOG_MS.millis());
    watchdog
}

/// While a sector of 128 KB is erased, milliseconds: that takes 4 s at most, and the watchdog's own
/// clock may be half as fast again as it should be.
const ERASE_WATCHDOG_MS: u32 = 10_000;

/// Does something during which the watchdog cannot be fed, such as to erase the flash that holds the
/// program.
pub fn patient_watchdog<T>(watchdog: &mut IndependentWatchdog, work: impl FnOnce() -> T) -> T {
    set_watchdog(watchdog, ERASE_WATCHDOG_MS);
    let done = work();
    set_watchdog(watchdog, WATCHDOG_MS);
    done
}

/// Begins the watchdog's count anew with another time, milliseconds.
fn set_watchdog(watchdog: &mut IndependentWatchdog, time_ms: u32) {
    watchdog.start(time_ms.millis());
    // Returns once the watchdog's own clock has taken the new time over.
    let _ = watchdog.interval();
    watchdog.feed();
}

/// Sets the USART up and starts the link.
pub fn start_link(
    usart: USART1,
    tx: impl Into<<USART1 as CommonPins>::Tx<PushPull>>,
    rx: impl Into<<USART1 as CommonPins>::Rx<PushPull>>,
    rcc: &mut Rcc,
) -> link::Link {
    let config = config::Config::default().baudrate(Bps(BAUD));
    let serial = Serial::<_, u8>::new(usart, (tx, rx), config, rcc);
    // Fails only if the bus clock is below eight times the speed, and it is not.
    let Ok(serial) = serial else {
        panic!("link speed")
    };
    once(link::start(serial.release().0))
}

/// What is there once and taken once, by the start-up code.
pub fn once<T>(taken: Option<T>) -> T {
    taken.expect("started twice")
}
