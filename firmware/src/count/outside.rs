//! What lies below the instrument: buses and pins, whose emulation is not counted, and the
//! machine, of which everything is that runs on the board.

use core::hint::black_box;

use ads1281::{Ads1281, DataReady};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{self, InputPin, OutputPin};
use embedded_hal::spi::{self, SpiBus};
use heapless::Vec;
use inm_firmware::keep::Sectors;
use inm_firmware::platform::Stack;
use inm_firmware::proof::ProofBins;
use inm_firmware::{Board, Part, Platform};
use inm_protocol::{Command, Filter, Rate, Request, SensorRange, Settings, ToBoard, encode};

use super::counter::Counter;
use crate::board::Emulated;
use crate::image::machine::{Machine, Sensors};
use crate::image::{clock, once};

/// A bus, a pin or a delay. On the board nearly all of its time is waiting, told apart.
pub struct Outside<T> {
    inner: T,
    counter: &'static Counter,
}

impl<T> Outside<T> {
    /// The same, not counted.
    pub fn new(inner: T, counter: &'static Counter) -> Self {
        Self { inner, counter }
    }
}

/// A converter on a bus that is not counted.
pub fn converter<S: SpiBus<u8>, R: DataReady, D: DelayNs>(
    converter: Ads1281<S, R, D>,
    counter: &'static Counter,
) -> Ads1281<Outside<S>, Outside<R>, Outside<D>> {
    let (spi, drdy, delay) = converter.release();
    Ads1281::new(
        Outside::new(spi, counter),
        Outside::new(drdy, counter),
        Outside::new(delay, counter),
    )
}

impl<T: spi::ErrorType> spi::ErrorType for Outside<T> {
    type Error = T::Error;
}

impl<T: SpiBus<u8>> SpiBus<u8> for Outside<T> {
    fn read(&mut self, words: &mut [u8]) -> Result<(), T::Error> {
        self.counter.pause(|| self.inner.read(words))
    }

    fn write(&mut self, words: &[u8]) -> Result<(), T::Error> {
        self.counter.pause(|| self.inner.write(words))
    }

    fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), T::Error> {
        self.counter.pause(|| self.inner.transfer(read, write))
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), T::Error> {
        self.counter.pause(|| self.inner.transfer_in_place(words))
    }

    fn flush(&mut self) -> Result<(), T::Error> {
        self.counter.pause(|| self.inner.flush())
    }
}

impl<T: digital::ErrorType> digital::ErrorType for Outside<T> {
    type Error = T::Error;
}

impl<T: InputPin> InputPin for Outside<T> {
    fn is_high(&mut self) -> Result<bool, T::Error> {
        self.counter.pause(|| self.inner.is_high())
    }

    fn is_low(&mut self) -> Result<bool, T::Error> {
        self.counter.pause(|| self.inner.is_low())
    }
}

impl<T: OutputPin> OutputPin for Outside<T> {
    fn set_low(&mut self) -> Result<(), T::Error> {
        self.counter.pause(|| self.inner.set_low())
    }

    fn set_high(&mut self) -> Result<(), T::Error> {
        self.counter.pause(|| self.inner.set_high())
    }
}

impl<T: DataReady> DataReady for Outside<T> {
    fn take_edge(&mut self) -> bool {
        self.counter.pause(|| self.inner.take_edge())
    }
}

impl<T: DelayNs> DelayNs for Outside<T> {
    fn delay_ns(&mut self, ns: u32) {
        self.counter.pause(|| self.inner.delay_ns(ns));
    }
}

/// What the host asks for: the most that the link carries.
pub fn settings() -> Settings {
    Settings {
        rate: Rate::Sps4000,
        filter: Filter::default(),
    }
}

/// The machine of the QEMU image. What the emulated converters take of its time is left out, the
/// board's own clock is read in the place of theirs, and a host asks for a stream at 4000/s.
pub struct Counted {
    machine: Machine<Emulated>,
    counter: &'static Counter,
    /// Bytes from the host, the next one last.
    asked: Vec<u8, 128>,
}

impl Counted {
    /// On this machine.
    pub fn new(machine: Machine<Emulated>, counter: &'static Counter) -> Self {
        let mut asked = Vec::new();
        for (id, request) in [(1, Request::Configure(settings())), (2, Request::Start)] {
            let mut frame = [0; 64];
            let message = ToBoard::Command(Command { id, request });
            let len = once(encode(&message, &mut frame).ok());
            once(asked.extend_from_slice(&frame[..len]).ok());
        }
        asked.reverse();
        Self {
            machine,
            counter,
            asked,
        }
    }

    /// As [`Machine::sleep`].
    pub fn sleep(&self) {
        self.machine.sleep();
    }
}

impl Platform for Counted {
    type Spi = Outside<<Emulated as Sensors>::Spi>;
    type Drdy = Outside<<Emulated as Sensors>::Drdy>;
    type Sync = Outside<<Emulated as Sensors>::Sync>;
    type Delay = Outside<<Emulated as Sensors>::Delay>;

    fn board(&self) -> Board {
        self.machine.board()
    }

    fn now(&self) -> u64 {
        black_box(clock::now());
        self.counter.pause(|| self.machine.now())
    }

    fn trigger_on(&mut self, axis: usize) {
        self.machine.trigger_on(axis);
    }

    fn take_edge_stamp(&mut self) -> Option<u64> {
        self.counter.pause(|| self.machine.take_edge_stamp())
    }

    fn receive(&mut self) -> Option<u8> {
        self.machine.receive().or_else(|| self.asked.pop())
    }

    fn receive_lost(&self) -> u32 {
        self.machine.receive_lost()
    }

    fn transmit(&mut self, frame: &[u8]) -> bool {
        self.machine.transmit(frame)
    }

    fn transmit_idle(&self) -> bool {
        self.machine.transmit_idle()
    }

    fn self_test(&mut self, on: bool) {
        self.machine.self_test(on);
    }

    fn select_range(&mut self, range: SensorRange) {
        self.machine.select_range(range);
    }

    fn sectors(&mut self) -> &mut dyn Sectors {
        self.machine.sectors()
    }

    fn stack(&self) -> Stack {
        self.machine.stack()
    }

    fn bins(&mut self) -> &mut ProofBins {
        self.machine.bins()
    }

    fn enter(&mut self, part: Part) {
        self.counter.turn(part as usize);
    }

    fn feed_watchdog(&mut self) {
        self.machine.feed_watchdog();
    }

    fn enter_loader(&mut self) {
        self.machine.enter_loader();
    }

    fn restart(&mut self) {
        self.machine.restart();
    }
}
