//! What the instrument needs of the machine it runs on.
//!
//! One super-loop calls [`Instrument::step`](crate::Instrument::step) for ever. Interrupts
//! only stamp DRDY edges and move link bytes through queues; they are the far ends of
//! [`Platform::take_edge_stamp`], [`Platform::receive`] and [`Platform::transmit`]. All
//! methods return at once. A loop with nothing to do may sleep for [`LONGEST_SLEEP_US`].

use ads1281::DataReady;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiBus;
use inm_protocol::{Restart, SensorRange};

use crate::keep::Sectors;
use crate::proof::ProofBins;

/// Longest sleep between two steps, microseconds: a deadline alone wakes nobody. As long as the
/// shortest wait that the instrument has, the millisecond after RESET.
pub const LONGEST_SLEEP_US: u32 = 1000;

/// Speed of the link, bit/s, of program and loader.
pub const BAUD: u32 = 921_600;

/// Machine under the instrument.
pub trait Platform {
    /// SPI bus of one converter; the same type for all three.
    ///
    /// Mode 0, MSB first, at most 2.048 MHz. The ADS1281 has no CS and drives DOUT always, so
    /// that each has a bus of its own. Where the three peripherals differ in type, an enum
    /// over them serves.
    type Spi: SpiBus<u8>;
    /// DRDY of one converter.
    type Drdy: DataReady;
    /// SYNC, common to the converters.
    type Sync: OutputPin;
    /// Blocking delay, exact to a microsecond or so upwards.
    type Delay: DelayNs;

    /// What the board is; constant from start to restart, and its range as it was at the start.
    fn board(&self) -> Board;

    /// Free-running timer, ticks of [`Board::timer_hz`] since some moment before the start.
    fn now(&self) -> u64;

    /// From now on [`take_edge_stamp`](Self::take_edge_stamp) tells of the DRDY of this axis, 0 to
    /// 2; of X (0) at first.
    fn trigger_on(&mut self, axis: usize);

    /// Timer at the latest falling edge of the DRDY that [triggers](Self::trigger_on), once:
    /// `None` if there was none since the last call.
    ///
    /// One stamp is kept, not a queue: conversions are numbered by the time between stamps, an
    /// edge that came and went shows as a gap in the index, and its word is gone anyway. The
    /// latch of [`DataReady::take_edge`] of that axis is another one, set by the same edge.
    fn take_edge_stamp(&mut self) -> Option<u64>;

    /// The latest rising edge at the input for a pulse a second, once: `None` if there was none since the last
    /// call, or there is no such input.
    ///
    /// The timer that stamps holds it, so that who looks late reads the same; no interrupt is asked for, so that an
    /// input that picks up anything costs nothing.
    fn take_pulse(&mut self) -> Option<Captured> {
        None
    }

    /// Next byte from the host.
    fn receive(&mut self) -> Option<u8>;

    /// Bytes from the host that found the receive queue full, or broken on the line, since the
    /// start.
    fn receive_lost(&self) -> u32 {
        0
    }

    /// Queues a whole frame for the host; `false` when the queue has no room for all of it,
    /// and then none of it is queued.
    fn transmit(&mut self, frame: &[u8]) -> bool;

    /// Whether all that was queued has left.
    fn transmit_idle(&self) -> bool;

    /// Temperature of the microcontroller, 0.01 degC; `None` without a sensor.
    fn temperature_centi_celsius(&mut self) -> Option<i16> {
        None
    }

    /// Supply of the accelerometers, millivolts; `None` where it is not measured.
    fn supply_mv(&mut self) -> Option<u16> {
        None
    }

    /// Drives the accelerometers' self-test pin.
    fn self_test(&mut self, on: bool);

    /// Drives the accelerometers' g-Select pin.
    fn select_range(&mut self, range: SensorRange);

    /// The flash for what is kept while the board is off. To erase it may take seconds, in which
    /// nothing else happens and the watchdog has to wait.
    fn sectors(&mut self) -> &mut dyn Sectors;

    /// Stack of the program; zeros where it is not measured.
    fn stack(&self) -> Stack {
        Stack::default()
    }

    /// Memory for the board's bins. It is the platform's because 47 KiB have to lie where no
    /// stack has to hold them, be it for a moment; what it held before does not matter.
    fn bins(&mut self) -> &mut ProofBins;

    /// The instrument turns to another part of its work. Of no use on the board: it is for a
    /// platform that counts what each part takes.
    #[inline]
    fn enter(&mut self, _part: Part) {}

    /// Restarts the watchdog's count; called in every step.
    fn feed_watchdog(&mut self);

    /// The program is a sound one, since it has understood a host: it is to be started from now on. Called
    /// once. Where no loader starts it there is nothing to do.
    fn prove(&mut self) {}

    /// Restarts the board into its [loader](crate::update), as [`Self::restart`] does into the program.
    fn enter_loader(&mut self);

    /// Restarts the board, so that [`Board::restart`] is [`Restart::Command`] afterwards. If
    /// it returns, the instrument does nothing more, and the watchdog is no longer fed.
    fn restart(&mut self);
}

/// Parts of the instrument's work while it streams.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Looking for edges, commands and deadlines, and everything that is not named below.
    Rest,
    /// From a stamp to the index, and three words from their buses.
    Read,
    /// What is wrong with the words.
    Check,
    /// The Allan bins of three axes.
    Bins,
    /// Gathering conversions, and framing and queueing a full batch.
    Framing,
    /// One register read back.
    ReadBack,
    /// The health record, with what is left of a batch and the digests of the bins.
    Health,
}

/// What a board is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Board {
    /// What the image was built for: `stm32f405`, `qemu`, `virtual`; at most 16 bytes.
    pub platform: &'static str,
    /// Unique number of the microcontroller.
    pub serial: [u32; 3],
    /// Ticks of the timer in a second; 100 kHz or more, so that a stamp tells conversions
    /// apart.
    pub timer_hz: u32,
    /// Clock of the SPI buses, hertz.
    pub spi_hz: u32,
    /// Speed of the link, bit/s; ten bits make a byte.
    pub baud: u32,
    /// Range of the accelerometers at the start.
    pub range: SensorRange,
    /// Reference voltage of the converters, microvolts.
    pub reference_uv: u32,
    /// Nominal supply of the accelerometers, microvolts.
    pub sensor_supply_uv: u32,
    /// Why the board last started.
    pub restart: Restart,
}

/// An edge at the input for a pulse a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Captured {
    /// Timer at the edge, ticks, as [`Platform::now`].
    pub stamp: u64,
    /// Others had come since the last call; this is the latest.
    pub doubled: bool,
}

/// Use of the stack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stack {
    /// Most ever used, bytes.
    pub used: u32,
    /// Bytes there are.
    pub size: u32,
}
