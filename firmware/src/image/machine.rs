//! The image's side of the instrument: everything below [`Platform`].

use ads1281::DataReady;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiBus;
use inm_firmware::keep::{NotWritten, Sectors};
use inm_firmware::platform::{Captured, Stack};
use inm_firmware::proof::ProofBins;
use inm_firmware::{Board, Platform};
use inm_protocol::{Restart, SensorRange};
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use super::flash::Flash;
use super::link::Link;
use super::{patient_watchdog, restart, stack, stamps};

/// What differs between the board and QEMU's model of it: the converters, and time as they
/// see it.
pub trait Sensors {
    /// See [`Platform::Spi`].
    type Spi: SpiBus<u8>;
    /// See [`Platform::Drdy`].
    type Drdy: DataReady;
    /// See [`Platform::Sync`].
    type Sync: OutputPin;
    /// See [`Platform::Delay`].
    type Delay: DelayNs;

    /// See [`Platform::now`].
    fn now(&self) -> u64;

    /// See [`Platform::trigger_on`].
    fn trigger_on(&mut self, axis: usize);

    /// See [`Platform::take_edge_stamp`].
    fn take_edge_stamp(&mut self) -> Option<u64>;

    /// See [`Platform::take_pulse`].
    fn take_pulse(&mut self) -> Option<Captured> {
        None
    }

    /// See [`Platform::temperature_centi_celsius`].
    fn temperature_centi_celsius(&mut self) -> Option<i16> {
        None
    }

    /// See [`Platform::supply_mv`].
    fn supply_mv(&mut self) -> Option<u16> {
        None
    }

    /// See [`Platform::self_test`].
    fn self_test(&mut self, on: bool);

    /// See [`Platform::select_range`].
    fn select_range(&mut self, range: SensorRange);
}

/// The microcontroller, with its converters' side `S`.
pub struct Machine<S> {
    /// What the board is.
    pub board: Board,
    /// The converters' side.
    pub sensors: S,
    /// The host.
    pub link: Link,
    /// The board's bins, in a static.
    pub bins: &'static mut ProofBins,
    /// Resets the board when the loop hangs.
    pub watchdog: IndependentWatchdog,
    /// What is kept while the board is off.
    pub flash: Flash,
}

impl<S> Machine<S> {
    /// Why the board started.
    pub fn restart(&self) -> &Restart {
        &self.board.restart
    }

    /// Sleeps until the next interrupt, unless something already waits.
    ///
    /// With interrupts masked between look and sleep none can slip through between them; a
    /// masked interrupt still ends the sleep, and is served as soon as the mask is lifted.
    pub fn sleep(&self) {
        cortex_m::interrupt::free(|_| {
            if !stamps::is_waiting() && self.link.is_quiet() {
                cortex_m::asm::wfi();
            }
        });
    }
}

impl<S: Sensors> Platform for Machine<S> {
    type Spi = S::Spi;
    type Drdy = S::Drdy;
    type Sync = S::Sync;
    type Delay = S::Delay;

    fn board(&self) -> Board {
        self.board.clone()
    }

    fn now(&self) -> u64 {
        self.sensors.now()
    }

    fn trigger_on(&mut self, axis: usize) {
        self.sensors.trigger_on(axis);
    }

    fn take_edge_stamp(&mut self) -> Option<u64> {
        self.sensors.take_edge_stamp()
    }

    fn take_pulse(&mut self) -> Option<Captured> {
        self.sensors.take_pulse()
    }

    fn receive(&mut self) -> Option<u8> {
        self.link.receive()
    }

    fn receive_lost(&self) -> u32 {
        self.link.lost()
    }

    fn transmit(&mut self, frame: &[u8]) -> bool {
        self.link.transmit(frame)
    }

    fn transmit_idle(&self) -> bool {
        self.link.is_idle()
    }

    fn temperature_centi_celsius(&mut self) -> Option<i16> {
        self.sensors.temperature_centi_celsius()
    }

    fn supply_mv(&mut self) -> Option<u16> {
        self.sensors.supply_mv()
    }

    fn self_test(&mut self, on: bool) {
        self.sensors.self_test(on);
    }

    fn select_range(&mut self, range: SensorRange) {
        self.sensors.select_range(range);
    }

    fn sectors(&mut self) -> &mut dyn Sectors {
        self
    }

    fn stack(&self) -> Stack {
        stack::measure()
    }

    fn bins(&mut self) -> &mut ProofBins {
        self.bins
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.feed();
    }

    #[cfg(not(feature = "qemu"))]
    fn prove(&mut self) {
        self.flash.prove();
    }

    fn enter_loader(&mut self) {
        restart::into_loader()
    }

    fn restart(&mut self) {
        restart::on_command()
    }
}

impl<S> Sectors for Machine<S> {
    fn read(&self, copy: usize, word: usize) -> u32 {
        self.flash.read(copy, word)
    }

    /// The core stands still, since its program is in the flash that is erased: the watchdog gets
    /// time for that before.
    fn erase(&mut self, copy: usize) -> Result<(), NotWritten> {
        let Self {
            flash, watchdog, ..
        } = self;
        patient_watchdog(watchdog, || flash.erase(copy))
    }

    fn write(&mut self, copy: usize, word: usize, value: u32) -> Result<(), NotWritten> {
        self.flash.write(copy, word, value)
    }
}
