//! Time: TIM2 free-running, made 64 bits wide in software, the heartbeat of the loop, and the capture of a pulse a
//! second.

use core::cell::RefCell;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use critical_section::Mutex;
#[cfg(not(feature = "qemu"))]
use inm_firmware::platform::Captured;
use inm_firmware::platform::LONGEST_SLEEP_US;
use inm_firmware::ticks::Ticks;
#[cfg(not(feature = "qemu"))]
use stm32f4xx_hal::gpio::{Alternate, PA0};
use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Beats a second: a sleeping loop wakes at least this often, to notice what did not happen,
/// and to see every turn of the 32-bit timer.
const HEARTBEAT_HZ: u32 = 1_000_000 / LONGEST_SLEEP_US;

struct Clock {
    timer: TIM2,
    /// Ticks in a second.
    hz: u32,
    ticks: Ticks,
}

static CLOCK: Mutex<RefCell<Option<Clock>>> = Mutex::new(RefCell::new(None));

/// Starts TIM2 with its input clock of `input_hz` divided by `divider` (1 to 65536), and the heartbeat on a
/// core that runs at `core_hz`.
pub fn start(
    timer: TIM2,
    (input_hz, divider): (u32, u32),
    syst: &mut SYST,
    core_hz: u32,
    rcc: &mut Rcc,
) {
    TIM2::enable(rcc);
    TIM2::reset(rcc);
    timer.psc().write(|w| w.psc().set((divider - 1) as u16));
    timer.arr().write(|w| w.arr().set(u32::MAX));
    // The prescaler takes effect with an update event.
    timer.egr().write(|w| w.ug().set_bit());
    timer.cr1().write(|w| w.cen().set_bit());
    critical_section::with(|cs| {
        CLOCK.borrow_ref_mut(cs).replace(Clock {
            timer,
            hz: input_hz / divider,
            ticks: Ticks::new(),
        });
    });

    syst.set_clock_source(SystClkSource::Core);
    syst.set_reload(core_hz / HEARTBEAT_HZ - 1);
    syst.clear_current();
    syst.enable_interrupt();
    syst.enable_counter();
}

/// Ticks since [`start`]; from the loop or from any interrupt.
pub fn now() -> u64 {
    critical_section::with(|cs| {
        CLOCK.borrow_ref_mut(cs).as_mut().map_or(0, |clock| {
            let count = clock.timer.cnt().read().cnt().bits();
            clock.ticks.extend(count)
        })
    })
}

/// Has channel 1 of the timer hold its count at each rising edge of its pin. Eight samples in a row have to agree, a tenth
/// of a microsecond: a spike is no edge, and what the filter delays it delays always.
#[cfg(not(feature = "qemu"))]
pub fn capture(_pin: PA0<Alternate<1>>) {
    critical_section::with(|cs| {
        if let Some(clock) = CLOCK.borrow_ref_mut(cs).as_mut() {
            let channel = clock.timer.ccmr1_input();
            channel.modify(|_, w| w.cc1s().ti1().ic1f().fck_int_n8());
            clock.timer.ccer().modify(|_, w| w.cc1e().set_bit());
        }
    });
}

/// The edge that the timer holds, once. To be asked at least once a turn of the timer, 51 s at 84 MHz: one that is older
/// counts as of the last turn.
#[cfg(not(feature = "qemu"))]
pub fn take_capture() -> Option<Captured> {
    critical_section::with(|cs| {
        let mut clock = CLOCK.borrow_ref_mut(cs);
        let clock = clock.as_mut()?;
        if clock.timer.sr().read().cc1if().bit_is_clear() {
            return None;
        }
        // Reading it clears its flag. Then the other: what came in between is seen (RM0090, 18.3.5).
        let held = clock.timer.ccr1().read().ccr().bits();
        let doubled = clock.timer.sr().read().cc1of().bit_is_set();
        if doubled {
            // A one leaves a flag as it is.
            clock.timer.sr().write(|w| w.cc1of().clear_bit());
        }
        let count = clock.timer.cnt().read().cnt().bits();
        let now = clock.ticks.extend(count);
        let stamp = now.saturating_sub(count.wrapping_sub(held).into());
        Some(Captured { stamp, doubled })
    })
}

/// Microseconds since [`start`], for the log: 0 ahead of it, and where the program broke off while it read the timer.
fn log_us() -> u64 {
    critical_section::with(|cs| {
        let Ok(mut clock) = CLOCK.borrow(cs).try_borrow_mut() else {
            return 0;
        };
        clock.as_mut().map_or(0, |clock| {
            let now = clock.ticks.extend(clock.timer.cnt().read().cnt().bits());
            let hz = u64::from(clock.hz);
            now / hz * 1_000_000 + now % hz * 1_000_000 / hz
        })
    })
}

// Whoever reads the log has the board's own time with each line, from the timer that stamps DRDY.
defmt::timestamp!("{=u64:us}", log_us());

/// The handler does nothing: that it ends the sleep is all it is for.
#[exception]
fn SysTick() {}
