//! A platform on the emulator's bench on which the board's work takes time, and a log of what was done
//! behind which conversion.

use inm_emulator::{Bench, Delay, Spi, SyncPin};
use inm_firmware::emulated::{Latched, VirtualBoard, describe};
use inm_firmware::keep::Sectors;
use inm_firmware::proof::ProofBins;
use inm_firmware::{Board, Part, Platform};
use inm_protocol::SensorRange;

use super::rig::{Link, Noisy};

/// An instruction at 168 MHz, picoseconds: 1.5 cycles, as `docs/studies/board.md` assumes and says why.
const INSTRUCTION_PS: u64 = 8929;

/// Instructions of the bins for three words: the most that `cargo xtask instructions` counts.
const BINS: u64 = 6_595;

/// Instructions of the digests of three axes, counted likewise.
const DIGESTS: u64 = 19_177;

/// Instructions for a byte of a frame: 17 480 were counted for a full batch, which has some 430.
const FRAMED_BYTE: u64 = 41;

/// What is 48 KB of bins to begin, picoseconds: by so much the first word was read earlier on the model
/// of the chip once they were begun ahead (179 us became 144).
const BEGIN_PS: u64 = 35_000_000;

/// One of the two waits for the chip's converter in a health record, picoseconds (`board.md`).
const CHIP_ADC_PS: u64 = 23_000_000;

/// Something that takes long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// The bins begin anew.
    Begin,
    /// A full batch is framed.
    Batch,
    /// What had been gathered of a batch is framed, ahead of a mark.
    Rest,
    /// The bins are marked.
    Mark,
    /// The health record is made and framed.
    Record,
    /// A register is read back.
    ReadBack,
    /// A reply or an event is framed.
    Other,
}

/// A conversion, and what was done from its reading to the next.
#[derive(Debug, Clone)]
pub struct Conversion {
    pub edge_ps: u64,
    /// When its reading began.
    pub read_ps: u64,
    /// What was done, and when it began.
    pub work: Vec<(u64, Work)>,
}

/// A board whose work takes the time that it takes on the chip.
pub struct TimedBoard<'b> {
    inner: VirtualBoard<'b, Noisy, Link>,
    part: Part,
    /// Edge that was stamped last, picoseconds.
    edge_ps: u64,
    /// When the part at work began, picoseconds.
    since_ps: u64,
    /// The bins hold something to be marked.
    filled: bool,
    /// The next frame is the record that is being made.
    record: bool,
    /// What was done ahead of the first conversion.
    pub ahead: Vec<(u64, Work)>,
    pub conversions: Vec<Conversion>,
}

impl<'b> TimedBoard<'b> {
    pub fn new(bench: &'b Bench<Noisy>) -> Self {
        Self {
            inner: VirtualBoard::new(bench, Link::new(None), describe("virtual")),
            part: Part::Rest,
            edge_ps: 0,
            since_ps: 0,
            filled: false,
            record: false,
            ahead: Vec::new(),
            conversions: Vec::new(),
        }
    }

    pub fn link(&mut self) -> &mut Link {
        self.inner.environment_mut()
    }

    /// Notes that `work` begins, and lets its time pass.
    fn spend(&mut self, work: Work, ps: u64) {
        let now_ps = self.inner.bench().now_ps();
        self.note(now_ps, work);
        self.inner.bench().advance_ps(ps);
    }

    fn note(&mut self, at_ps: u64, work: Work) {
        let last = self.conversions.last_mut();
        let list = last.map_or(&mut self.ahead, |conversion| &mut conversion.work);
        list.push((at_ps, work));
    }
}

impl<'b> Platform for TimedBoard<'b> {
    type Spi = Spi<'b, Noisy>;
    type Drdy = Latched<'b, Noisy>;
    type Sync = SyncPin<'b, Noisy>;
    type Delay = Delay<'b, Noisy>;

    fn board(&self) -> Board {
        self.inner.board()
    }

    fn now(&self) -> u64 {
        self.inner.now()
    }

    fn trigger_on(&mut self, axis: usize) {
        self.inner.trigger_on(axis);
    }

    fn take_edge_stamp(&mut self) -> Option<u64> {
        let stamp = self.inner.take_edge_stamp()?;
        self.edge_ps = self.inner.bench().last_edge_ps(0)?;
        Some(stamp)
    }

    fn receive(&mut self) -> Option<u8> {
        self.inner.receive()
    }

    fn transmit(&mut self, frame: &[u8]) -> bool {
        let work = match self.part {
            Part::Framing => Work::Batch,
            Part::Health if self.record => Work::Record,
            Part::Health => Work::Rest,
            _ => Work::Other,
        };
        self.record = false;
        self.spend(work, frame.len() as u64 * FRAMED_BYTE * INSTRUCTION_PS);
        self.inner.transmit(frame)
    }

    fn transmit_idle(&self) -> bool {
        self.inner.transmit_idle()
    }

    fn temperature_centi_celsius(&mut self) -> Option<i16> {
        self.record = true;
        self.inner.bench().advance_ps(CHIP_ADC_PS);
        self.inner.temperature_centi_celsius()
    }

    fn supply_mv(&mut self) -> Option<u16> {
        self.inner.bench().advance_ps(CHIP_ADC_PS);
        self.inner.supply_mv()
    }

    fn self_test(&mut self, on: bool) {
        self.inner.self_test(on);
    }

    fn select_range(&mut self, range: SensorRange) {
        self.inner.select_range(range);
    }

    fn sectors(&mut self) -> &mut dyn Sectors {
        self.inner.sectors()
    }

    fn bins(&mut self) -> &mut ProofBins {
        match self.part {
            Part::Bins => {
                self.inner.bench().advance_ps(BINS * INSTRUCTION_PS);
                self.filled = true;
            }
            // Bins that hold nothing say so at once.
            Part::Health if self.filled => self.spend(Work::Mark, DIGESTS * INSTRUCTION_PS),
            Part::Health => {}
            _ => {
                self.spend(Work::Begin, BEGIN_PS);
                self.filled = false;
            }
        }
        self.inner.bins()
    }

    fn enter(&mut self, part: Part) {
        let now_ps = self.inner.bench().now_ps();
        match (self.part, part) {
            (Part::Rest, Part::Read) => self.conversions.push(Conversion {
                edge_ps: self.edge_ps,
                read_ps: now_ps,
                work: Vec::new(),
            }),
            // Most conversions read none, and then no time has passed.
            (Part::ReadBack, Part::Rest) if now_ps > self.since_ps => {
                self.note(self.since_ps, Work::ReadBack);
            }
            _ => {}
        }
        self.part = part;
        self.since_ps = now_ps;
    }

    fn feed_watchdog(&mut self) {
        self.inner.feed_watchdog();
    }

    fn enter_loader(&mut self) {
        self.inner.enter_loader();
    }

    fn restart(&mut self) {
        self.inner.restart();
    }
}
