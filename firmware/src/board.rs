//! The board: an STM32F405RG and what is soldered to it.
//!
//! | pin  | use                 | pin  | use                                             |
//! |------|---------------------|------|-------------------------------------------------|
//! | PA5  | X: SPI1 SCLK        | PC4  | X: DRDY, EXTI4: its interrupt stamps            |
//! | PA6  | X: SPI1 DOUT        | PC5  | Y: DRDY, EXTI5: stamps while X is away          |
//! | PA7  | X: SPI1 DIN         | PC6  | Z: DRDY, EXTI6: the same                        |
//! | PB13 | Y: SPI2 SCLK        | PB0  | SYNC of all converters, idles high              |
//! | PB14 | Y: SPI2 DOUT        | PB1  | g-Select of the accelerometers, low for 4 g     |
//! | PB15 | Y: SPI2 DIN         | PB10 | self-test of the accelerometers                 |
//! | PC10 | Z: SPI3 SCLK        | PC0  | half the accelerometers' supply, to the ADC     |
//! | PC11 | Z: SPI3 DOUT        | PA9  | to the host: USART1 TX                          |
//! | PC12 | Z: SPI3 DIN         | PA10 | from the host: USART1 RX                        |
//! | PH0, PH1 | 8 MHz crystal   | PA13 | debug probe: SWDIO, and the log over RTT        |
//! | PA0  | a pulse a second, rising: TIM2_CH1 captures | PA14 | debug probe: SWCLK      |
//!
//! The converters have no CS and always drive DOUT, hence a bus for each. They share an
//! oscillator of 4.096 MHz; PINMODE is strapped to register control, RESET and PWDN to the
//! supply.

mod analog;
mod delay;
mod oscillator;
mod spi;
mod uid;

use core::convert::Infallible;
use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use ads1281::{Ads1281, DataReady};
use cortex_m::peripheral::NVIC;
use embedded_hal::digital::{ErrorType, InputPin};
use inm_firmware::platform::Captured;
use inm_firmware::proof::ProofBins;
use inm_protocol::{AXES, SensorRange};
use stm32f4xx_hal::gpio::{Edge, ErasedPin, ExtiPin, GpioExt, Input, Output, PB0, PB1, PB10};
use stm32f4xx_hal::pac::{self, EXTI, Interrupt, interrupt};
use stm32f4xx_hal::prelude::_fugit_RateExtU32 as _;
use stm32f4xx_hal::spi::{Mode, Phase, Polarity, Spi};
use stm32f4xx_hal::syscfg::SysCfgExt;

use crate::image::clock;
use crate::image::flash::Flash;
use crate::image::machine::{Machine, Sensors};
use crate::image::{SPI_HZ, describe, once, restart, stamps, start_link, start_watchdog};
use analog::Analog;
use delay::Delay;
use spi::Bus;
use uid::serial_number;

/// Clock idle low, data taken at the first edge (ADS1281, SBAS378D, pages 21 and 24).
const MODE_0: Mode = Mode {
    polarity: Polarity::IdleLow,
    phase: Phase::CaptureOnFirstTransition,
};

/// Priority of the link's interrupt, in the upper four bits.
const LINK_PRIORITY: u8 = 1 << 4;

/// By axis: DRDY has fallen since the driver last looked.
static EDGES: [AtomicBool; AXES] = [const { AtomicBool::new(false) }; AXES];

/// The axis whose edges are stamped.
static TRIGGER: AtomicUsize = AtomicUsize::new(0);

/// The accelerometers and what measures around them.
pub struct Attached {
    self_test: PB10<Output>,
    range: PB1<Output>,
    analog: Analog,
}

/// DRDY of one converter.
pub struct DrdyPin {
    pin: ErasedPin<Input>,
    axis: usize,
}

/// Driver of one converter.
type Axis = Ads1281<Bus, DrdyPin, Delay>;

/// Brings the board up. One sequence, whose order matters and whose every part takes its piece of the chip.
pub fn start(bins: &'static mut ProofBins) -> (Machine<Attached>, [Axis; 3], PB0<Output>) {
    let mut core = once(cortex_m::Peripherals::take());
    let chip = once(pac::Peripherals::take());
    // A program that a probe has halted feeds nothing, and is not to be restarted for it.
    chip.DBGMCU
        .apb1_fz()
        .modify(|_, w| w.dbg_iwdg_stop().set_bit());
    // First, so that a start that hangs is tried again.
    let watchdog = start_watchdog(chip.IWDG);
    let by_watchdog = chip.RCC.csr().read().wdgrstf().bit_is_set();
    chip.RCC.csr().modify(|_, w| w.rmvf().set_bit());
    let (mut rcc, fallback) = oscillator::start(chip.RCC);
    let mut reason = restart::reason(by_watchdog);
    if fallback {
        defmt::error!("the crystal does not start: on the internal oscillator");
        reason = reason.on_internal_oscillator();
    }

    let timer_hz = rcc.clocks.timclk1().raw();
    let core_hz = rcc.clocks.hclk().raw();
    clock::start(chip.TIM2, (timer_hz, 1), &mut core.SYST, core_hz, &mut rcc);

    let a = chip.GPIOA.split(&mut rcc);
    let b = chip.GPIOB.split(&mut rcc);
    let c = chip.GPIOC.split(&mut rcc);

    let hz = SPI_HZ.Hz();
    let x = Spi::new(
        chip.SPI1,
        (Some(a.pa5), Some(a.pa6), Some(a.pa7)),
        MODE_0,
        hz,
        &mut rcc,
    );
    let y = Spi::new(
        chip.SPI2,
        (Some(b.pb13), Some(b.pb14), Some(b.pb15)),
        MODE_0,
        hz,
        &mut rcc,
    );
    let z = Spi::new(
        chip.SPI3,
        (Some(c.pc10), Some(c.pc11), Some(c.pc12)),
        MODE_0,
        hz,
        &mut rcc,
    );

    let mut drdy = [c.pc4.erase(), c.pc5.erase(), c.pc6.erase()];
    let mut syscfg = chip.SYSCFG.constrain(&mut rcc);
    let mut exti = chip.EXTI;
    for pin in &mut drdy {
        pin.make_interrupt_source(&mut syscfg);
        pin.trigger_on_edge(&mut exti, Edge::Falling);
        pin.enable_interrupt(&mut exti);
    }
    // A stamp may interrupt the link, so that it is late by less than a microsecond; the lower
    // number is the more urgent, and DRDY's stays at 0.
    //
    // SAFETY: the handler is defined below, what it needs is in place, and no critical section
    // is built on masks or priorities.
    #[allow(unsafe_code)]
    unsafe {
        core.NVIC.set_priority(Interrupt::USART1, LINK_PRIORITY);
        NVIC::unmask(Interrupt::EXTI4);
        NVIC::unmask(Interrupt::EXTI9_5);
    }

    let sync = b
        .pb0
        .into_push_pull_output_in_state(stm32f4xx_hal::gpio::PinState::High);
    let mut range = b.pb1.into_push_pull_output();
    range.set_low();
    let mut self_test = b.pb10.into_push_pull_output();
    self_test.set_low();

    // Nobody may be connected: an open input picks up anything, and each edge of it starts a byte.
    let rx = a.pa10.into_alternate::<7>().internal_pull_up(true);
    let link = start_link(chip.USART1, a.pa9, rx, &mut rcc);
    // The same here: held low, it picks up nothing.
    clock::capture(a.pa0.into_alternate::<1>().internal_pull_down(true));
    let analog = Analog::start(chip.ADC1, c.pc0.into_analog(), Delay { timer_hz }, &mut rcc);

    let machine = Machine {
        board: describe(serial_number(), timer_hz, reason),
        sensors: Attached {
            self_test,
            range,
            analog,
        },
        link,
        bins,
        watchdog,
        flash: Flash::new(chip.FLASH),
    };
    let [drdy_x, drdy_y, drdy_z] = drdy;
    let axes = [
        (Bus::X(x), drdy_x, 0),
        (Bus::Y(y), drdy_y, 1),
        (Bus::Z(z), drdy_z, 2),
    ]
    .map(|(bus, pin, axis)| Ads1281::new(bus, DrdyPin { pin, axis }, Delay { timer_hz }));
    (machine, axes, sync)
}

/// An axis has a new conversion, whose pending bit is cleared: an edge that comes from now on asks
/// for the interrupt again, and its stamp replaces this one.
fn fallen(axis: usize) {
    if axis == TRIGGER.load(Ordering::Relaxed) {
        stamps::stamp();
    }
    EDGES[axis].store(true, Ordering::Release);
}

/// X.
#[interrupt]
fn EXTI4() {
    if clear_pending(4) {
        fallen(0);
    }
}

/// Y and Z.
#[interrupt]
fn EXTI9_5() {
    for (line, axis) in [(5, 1), (6, 2)] {
        if clear_pending(line) {
            fallen(axis);
        }
    }
}

/// Clears the pending bit of an EXTI line, 0 to 22; whether it was set.
#[allow(unsafe_code)]
fn clear_pending(line: u8) -> bool {
    let mask = 1 << line;
    // SAFETY: the register is only read, and written below; both are atomic, and the start-up
    // code, which has the peripheral, does not touch it any more once the interrupts are on.
    let register = unsafe { &*EXTI::ptr() }.pr();
    let set = register.read().bits() & mask != 0;
    // SAFETY: a zero does nothing here, so that no other line is disturbed.
    register.write(|w| unsafe { w.bits(mask) });
    set
}

impl Sensors for Attached {
    type Spi = Bus;
    type Drdy = DrdyPin;
    type Sync = PB0<Output>;
    type Delay = Delay;

    fn now(&self) -> u64 {
        clock::now()
    }

    fn trigger_on(&mut self, axis: usize) {
        TRIGGER.store(axis, Ordering::Relaxed);
    }

    fn take_edge_stamp(&mut self) -> Option<u64> {
        stamps::take()
    }

    fn take_pulse(&mut self) -> Option<Captured> {
        clock::take_capture()
    }

    fn temperature_centi_celsius(&mut self) -> Option<i16> {
        self.analog.temperature_centi_celsius()
    }

    fn supply_mv(&mut self) -> Option<u16> {
        Some(self.analog.supply_mv())
    }

    fn self_test(&mut self, on: bool) {
        self.self_test.set_state(on.into());
    }

    fn select_range(&mut self, range: SensorRange) {
        let coarse = range == SensorRange::G12;
        self.range.set_state(coarse.into());
    }
}

impl ErrorType for DrdyPin {
    type Error = Infallible;
}

impl InputPin for DrdyPin {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.pin.is_high())
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(self.pin.is_low())
    }
}

impl DataReady for DrdyPin {
    fn take_edge(&mut self) -> bool {
        EDGES
            .get(self.axis)
            .is_some_and(|edge| edge.swap(false, Ordering::AcqRel))
    }
}
