//! A platform on the emulator's bench: three emulated converters, virtual time, any link.
//!
//! ```text
//!   Instrument --> VirtualBoard --> Bench (converters, time)
//!                       |
//!                       +--> Environment: VirtualLink, or the host's own
//! ```
//!
//! The host's virtual board and the tests stand on this file; the code above it is that of the
//! real board.

mod flash;
mod latched;
mod link;
mod slots;

use inm_emulator::time::PS_PER_S;
use inm_emulator::{Bench, Delay, Signal, Spi, SyncPin};
use inm_protocol::{AXES, Restart, SensorRange};

use crate::acquire::Converter;
use crate::keep::Sectors;
use crate::platform::{BAUD, Captured, Stack};
use crate::proof::ProofBins;
use crate::{Board, Instrument, Platform};

pub use flash::VirtualFlash;
pub use latched::{Latched, converter};
pub use link::VirtualLink;
pub use slots::VirtualSlots;

/// Ticks of the virtual board's timer in a second.
pub const TIMER_HZ: u32 = 1_000_000;

const PS_PER_TICK: u64 = PS_PER_S / TIMER_HZ as u64;

/// Longest time that passes in one step without an edge: a quarter of the shortest wait of the
/// instrument, the millisecond after RESET.
const QUANTUM_PS: u64 = PS_PER_S / 4000;

/// What is outside the virtual board: the link, and whatever the program runs on.
pub trait Environment {
    /// Next byte from the host.
    fn receive(&mut self) -> Option<u8>;

    /// Bytes from the host that were lost, as [`Platform::receive_lost`].
    fn receive_lost(&self) -> u32 {
        0
    }

    /// Queues a whole frame at virtual time `now_ps`, as [`Platform::transmit`].
    fn transmit(&mut self, frame: &[u8], now_ps: u64) -> bool;

    /// Whether all that was queued has left.
    fn transmit_idle(&self) -> bool;

    /// Virtual time up to which the bench may run, picoseconds. By default it runs as fast as
    /// it can; a program that runs in real time returns its own clock.
    fn horizon_ps(&mut self) -> u64 {
        u64::MAX
    }

    /// The latest edge of a pulse a second, picoseconds of virtual time, and whether others had come, as
    /// [`Platform::take_pulse`].
    fn take_pulse(&mut self) -> Option<(u64, bool)> {
        None
    }

    /// Temperature, as [`Platform::temperature_centi_celsius`].
    fn temperature_centi_celsius(&mut self) -> Option<i16> {
        None
    }

    /// Supply of the accelerometers, as [`Platform::supply_mv`].
    fn supply_mv(&mut self) -> Option<u16> {
        None
    }

    /// Drives the accelerometers' self-test pin.
    fn self_test(&mut self, _on: bool) {}

    /// Drives the accelerometers' g-Select pin.
    fn select_range(&mut self, _range: SensorRange) {}

    /// Stack of the program.
    fn stack(&self) -> Stack {
        Stack::default()
    }

    /// Restarts the watchdog's count.
    fn feed_watchdog(&mut self) {}

    /// The program has understood a host, as [`Platform::prove`].
    fn prove(&mut self) {}

    /// Restarts the board into its loader.
    fn enter_loader(&mut self);

    /// Restarts the board.
    fn restart(&mut self);
}

/// A platform on a bench.
#[derive(Debug)]
pub struct VirtualBoard<'b, S, E> {
    bench: &'b Bench<S>,
    environment: E,
    board: Board,
    /// The axis whose edges are stamped.
    trigger: usize,
    /// Latest edge that was stamped, picoseconds.
    stamped_ps: Option<u64>,
    bins: ProofBins,
    flash: VirtualFlash,
}

impl<'b, S: Signal, E: Environment> VirtualBoard<'b, S, E> {
    /// A board on `bench`; its timer and its SPI clock are those of the bench. Its timer has [`TIMER_HZ`] ticks in
    /// a second of the bench: where `board` says otherwise, that clock is off.
    pub fn new(bench: &'b Bench<S>, environment: E, board: Board) -> Self {
        Self {
            bench,
            environment,
            board,
            trigger: 0,
            stamped_ps: None,
            bins: ProofBins::new(),
            flash: VirtualFlash::default(),
        }
    }

    /// An instrument on a board of its own.
    pub fn instrument(bench: &'b Bench<S>, environment: E, board: Board) -> Instrument<Self> {
        let converters: [Converter<Self>; AXES] = [0, 1, 2].map(|axis| converter(bench, axis));
        let platform = Self::new(bench, environment, board);
        Instrument::new(platform, converters, bench.sync())
    }

    /// The bench.
    pub fn bench(&self) -> &'b Bench<S> {
        self.bench
    }

    /// The environment.
    pub fn environment(&self) -> &E {
        &self.environment
    }

    /// What is kept while the board is off.
    pub fn flash_mut(&mut self) -> &mut VirtualFlash {
        &mut self.flash
    }

    /// The environment, to drive it from outside.
    pub fn environment_mut(&mut self) -> &mut E {
        &mut self.environment
    }
}

/// The design's board: SCLK of 168 MHz / 128, the link at 921600 bit/s, sensors on their 4 g
/// range at 2.8 V, a reference of 5 V.
pub fn describe(platform: &'static str) -> Board {
    Board {
        platform,
        serial: [0; 3],
        timer_hz: TIMER_HZ,
        spi_hz: 1_312_500,
        baud: BAUD,
        range: SensorRange::G4,
        reference_uv: 5_000_000,
        sensor_supply_uv: 2_800_000,
        restart: Restart::Power,
    }
}

impl<'b, S: Signal, E: Environment> Platform for VirtualBoard<'b, S, E> {
    type Spi = Spi<'b, S>;
    type Drdy = Latched<'b, S>;
    type Sync = SyncPin<'b, S>;
    type Delay = Delay<'b, S>;

    fn board(&self) -> Board {
        self.board.clone()
    }

    fn now(&self) -> u64 {
        self.bench.now_ps() / PS_PER_TICK
    }

    fn trigger_on(&mut self, axis: usize) {
        self.trigger = axis;
    }

    /// The latest edge if it is new; else lets time pass up to the next, for a while.
    fn take_edge_stamp(&mut self) -> Option<u64> {
        let mut latest = self.bench.last_edge_ps(self.trigger);
        if latest == self.stamped_ps {
            let now_ps = self.bench.now_ps();
            let horizon_ps = self.environment.horizon_ps();
            let deadline_ps = horizon_ps.min(now_ps + QUANTUM_PS);
            if deadline_ps <= now_ps {
                return None;
            }
            latest = Some(self.bench.run_until_edge(self.trigger, deadline_ps)?);
        }
        self.stamped_ps = latest;
        latest.map(|edge_ps| edge_ps / PS_PER_TICK)
    }

    fn take_pulse(&mut self) -> Option<Captured> {
        let (edge_ps, doubled) = self.environment.take_pulse()?;
        let stamp = edge_ps / PS_PER_TICK;
        Some(Captured { stamp, doubled })
    }

    fn receive(&mut self) -> Option<u8> {
        self.environment.receive()
    }

    fn receive_lost(&self) -> u32 {
        self.environment.receive_lost()
    }

    fn transmit(&mut self, frame: &[u8]) -> bool {
        self.environment.transmit(frame, self.bench.now_ps())
    }

    fn transmit_idle(&self) -> bool {
        self.environment.transmit_idle()
    }

    fn temperature_centi_celsius(&mut self) -> Option<i16> {
        self.environment.temperature_centi_celsius()
    }

    fn supply_mv(&mut self) -> Option<u16> {
        self.environment.supply_mv()
    }

    fn self_test(&mut self, on: bool) {
        self.environment.self_test(on);
    }

    fn select_range(&mut self, range: SensorRange) {
        self.environment.select_range(range);
    }

    fn sectors(&mut self) -> &mut dyn Sectors {
        &mut self.flash
    }

    fn stack(&self) -> Stack {
        self.environment.stack()
    }

    fn bins(&mut self) -> &mut ProofBins {
        &mut self.bins
    }

    fn feed_watchdog(&mut self) {
        self.environment.feed_watchdog();
    }

    fn prove(&mut self) {
        self.environment.prove();
    }

    fn enter_loader(&mut self) {
        self.environment.enter_loader();
    }

    fn restart(&mut self) {
        self.environment.restart();
    }
}
