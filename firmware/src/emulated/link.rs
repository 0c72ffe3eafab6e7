//! A serial link between a virtual board and its host, at the speed of its line in virtual time.

use heapless::Deque;
use inm_emulator::link::Link;
use inm_protocol::SensorRange;

use super::Environment;

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
    loader: bool,
    proved: bool,
    self_test: bool,
    range: SensorRange,
    /// The capture register: the latest edge, and whether it took the place of another.
    pulse: Option<(u64, bool)>,
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
            loader: false,
            proved: false,
            self_test: false,
            range: SensorRange::default(),
            pulse: None,
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

    /// There is an edge of a pulse a second at virtual time `at_ps`; not ahead of those before it.
    pub fn pulse(&mut self, at_ps: u64) {
        self.pulse = Some((at_ps, self.pulse.is_some()));
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

    /// The range that the board has selected since its start; that of its start is the 4 g range.
    pub fn range(&self) -> SensorRange {
        self.range
    }

    /// How often the board has asked to be restarted.
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Whether the board has asked to be restarted into its loader.
    pub fn loader_is_asked_for(&self) -> bool {
        self.loader
    }

    /// Whether the board's program has proved itself since its start.
    pub fn program_has_proved(&self) -> bool {
        self.proved
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

    fn take_pulse(&mut self) -> Option<(u64, bool)> {
        self.pulse.take()
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

    fn select_range(&mut self, range: SensorRange) {
        self.range = range;
    }

    fn prove(&mut self) {
        self.proved = true;
    }

    fn enter_loader(&mut self) {
        self.loader = true;
    }

    fn restart(&mut self) {
        self.restarts = self.restarts.saturating_add(1);
    }
}
