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

use heapless::Deque;
use inm_emulator::link::Link;
use inm_emulator::time::PS_PER_S;
use inm_emulator::{Bench, Delay, Drdy, Signal, Spi, SyncPin};
use inm_protocol::{AXES, Restart, SensorRange};

use crate::acquire::Converter;
use crate::ads1281::{Ads1281, DataReady};
use crate::platform::Stack;
use crate::proof::ProofBins;
use crate::{Board, Instrument, Platform};

/// Ticks of the virtual board's timer in a second.
pub const TIMER_HZ: u32 = 1_000_000;

const PS_PER_TICK: u64 = PS_PER_S / TIMER_HZ as u64;

/// Longest time that passes in one step without an edge: a quarter of the shortest wait of the
/// instrument, the millisecond after RESET.
const QUANTUM_PS: u64 = PS_PER_S / 4000;

impl<S: Signal> DataReady for Drdy<'_, S> {
    fn take_edge(&mut self) -> bool {
        Drdy::take_edge(self)
    }
}

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

    /// Stack of the program.
    fn stack(&self) -> Stack {
        Stack::default()
    }

    /// Restarts the watchdog's count.
    fn feed_watchdog(&mut self) {}

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
}

impl<'b, S: Signal, E: Environment> VirtualBoard<'b, S, E> {
    /// A board on `bench`; its timer and its SPI clock are those of the bench.
    pub fn new(bench: &'b Bench<S>, environment: E, board: Board) -> Self {
        let board = Board {
            timer_hz: TIMER_HZ,
            ..board
        };
        Self {
            bench,
            environment,
            board,
            trigger: 0,
            stamped_ps: None,
            bins: ProofBins::new(),
        }
    }

    /// An instrument on a board of its own.
    pub fn instrument(bench: &'b Bench<S>, environment: E, board: Board) -> Instrument<Self> {
        let converters: [Converter<Self>; AXES] =
            [0, 1, 2].map(|axis| Ads1281::new(bench.spi(axis), bench.drdy(axis), bench.delay()));
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
        baud: 921_600,
        range: SensorRange::G4,
        reference_uv: 5_000_000,
        sensor_supply_uv: 2_800_000,
        restart: Restart::Power,
    }
}

impl<'b, S: Signal, E: Environment> Platform for VirtualBoard<'b, S, E> {
    type Spi = Spi<'b, S>;
    type Drdy = Drdy<'b, S>;
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

    fn stack(&self) -> Stack {
        self.environment.stack()
    }

    fn bins(&mut self) -> &mut ProofBins {
        &mut self.bins
    }

    fn feed_watchdog(&mut self) {
        self.environment.feed_watchdog();
    }

    fn restart(&mut self) {
        self.environment.restart();
    }
}

/// The host's end of a serial link in virtual time: frames enter a queue of `N` bytes, the line
/// takes them out at its speed, the far end takes what has arrived.
///
/// A far end that takes nothing holds the line up, as a USB adapter does, and the queue fills.
#[derive(Debug)]
pub struct VirtualLink<const N: usize> {
    to_host: Link<N>,
    to_board: Deque<u8, 256>,
    /// Bytes for the board that found its queue full.
    lost: u32,
    /// Most bytes that ever waited.
    most_waiting: usize,
    restarts: u32,
    self_test: bool,
}

impl<const N: usize> VirtualLink<N> {
    /// A link at `baud` bit/s; `None` for one that takes next to no time.
    pub fn new(baud: Option<u32>) -> Self {
        Self {
            to_host: Link::new(baud.unwrap_or(u32::MAX)),
            to_board: Deque::new(),
            lost: 0,
            most_waiting: 0,
            restarts: 0,
            self_test: false,
        }
    }

    /// Sends bytes to the board.
    pub fn send(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if self.to_board.push_back(byte).is_err() {
                self.lost = self.lost.saturating_add(1);
            }
        }
    }

    /// Gives `taker` each byte that has arrived at the host by `now_ps`.
    pub fn take(&mut self, now_ps: u64, mut taker: impl FnMut(u8)) {
        while let Some(arrival) = self.to_host.receive(now_ps) {
            taker(arrival.byte);
        }
    }

    /// Most bytes that ever waited for the line or the host.
    pub fn most_waiting(&self) -> usize {
        self.most_waiting
    }

    /// Whether the board drives the accelerometers' self-test pin.
    pub fn self_test_is_on(&self) -> bool {
        self.self_test
    }

    /// How often the board has asked to be restarted.
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    fn waiting(&self) -> usize {
        N - self.to_host.room()
    }
}

impl<const N: usize> Environment for VirtualLink<N> {
    fn receive(&mut self) -> Option<u8> {
        self.to_board.pop_front()
    }

    fn receive_lost(&self) -> u32 {
        self.lost
    }

    fn transmit(&mut self, frame: &[u8], now_ps: u64) -> bool {
        if self.to_host.room() < frame.len() {
            return false;
        }
        self.to_host.send(now_ps, frame);
        self.most_waiting = self.most_waiting.max(self.waiting());
        true
    }

    fn transmit_idle(&self) -> bool {
        self.waiting() == 0
    }

    fn self_test(&mut self, on: bool) {
        self.self_test = on;
    }

    fn restart(&mut self) {
        self.restarts = self.restarts.saturating_add(1);
    }
}
