//! Three converters on three SPI buses, a common SYNC line and a common clock.

use core::cell::{Cell, RefCell, RefMut};

use crate::{
    Converter, Delay, Drdy, Fault, Registers, Rule, Sent, Signal, Spi, SyncPin, Violation,
    time::{PS_PER_S, SYNC_PULSE_PS},
};

/// SCLK of the board: 168 MHz / 128.
const SCLK_HZ: u32 = 1_312_500;

/// The virtual bench.
///
/// Its parts ([`Bench::spi`] and so on) borrow it shared: they can be handed to a driver and to
/// the driver's surroundings alike. Whatever takes time on the board, a byte on a bus or a delay,
/// advances the common virtual time.
///
/// A breach of the part's rules panics with the rule's text unless [`Bench::set_strict`] says
/// otherwise; the first one is kept in either case.
#[derive(Debug)]
pub struct Bench<S> {
    converters: [RefCell<Converter<S>>; 3],
    bit_ps: [Cell<u64>; 3],
    now_ps: Cell<u64>,
    sync_high: Cell<bool>,
    sync_changed_ps: Cell<Option<u64>>,
    strict: Cell<bool>,
    violation: Cell<Option<Violation>>,
}

impl<S: Signal> Bench<S> {
    /// A bench that is powered up at time zero.
    pub fn new(converters: [Converter<S>; 3]) -> Self {
        Self::on(converters.map(RefCell::new))
    }

    /// As [`Self::new`], converter after converter in its place: a stack has to hold one copy
    /// less of all three.
    #[inline]
    pub fn from_fn(mut converter: impl FnMut(usize) -> Converter<S>) -> Self {
        // Written out: `map` takes a copy on the way.
        Self::on([
            RefCell::new(converter(0)),
            RefCell::new(converter(1)),
            RefCell::new(converter(2)),
        ])
    }

    #[inline]
    fn on(converters: [RefCell<Converter<S>>; 3]) -> Self {
        Self {
            converters,
            bit_ps: [const { Cell::new(PS_PER_S / SCLK_HZ as u64) }; 3],
            now_ps: Cell::new(0),
            sync_high: Cell::new(true),
            sync_changed_ps: Cell::new(None),
            strict: Cell::new(true),
            violation: Cell::new(None),
        }
    }

    /// The SPI bus of `axis` (0 to 2, like all axes here).
    ///
    /// # Panics
    ///
    /// If there is no such axis.
    pub fn spi(&self, axis: usize) -> Spi<'_, S> {
        Spi::new(self, checked(axis))
    }

    /// The DRDY pin of `axis`.
    ///
    /// # Panics
    ///
    /// If there is no such axis.
    pub fn drdy(&self, axis: usize) -> Drdy<'_, S> {
        Drdy::new(self, checked(axis))
    }

    /// A delay that passes virtual time.
    pub fn delay(&self) -> Delay<'_, S> {
        Delay::new(self)
    }

    /// The SYNC line of all three converters; high at first.
    pub fn sync(&self) -> SyncPin<'_, S> {
        SyncPin::new(self)
    }

    /// Sets SCLK of one bus, hertz; 1.3125 MHz at first.
    pub fn set_sclk_hz(&self, axis: usize, sclk_hz: u32) {
        self.bit_ps[axis].set(PS_PER_S / u64::from(sclk_hz.max(1)));
    }

    /// Virtual time since power-on, picoseconds.
    pub fn now_ps(&self) -> u64 {
        self.now_ps.get()
    }

    /// Lets time pass.
    pub fn advance_ps(&self, ps: u64) {
        self.now_ps.set(self.now_ps.get().saturating_add(ps));
    }

    /// Advances to the next falling edge on the DRDY pin of `axis` after now, but no further than
    /// `deadline_ps`. Returns the time of the edge, or `None` at the deadline.
    ///
    /// A converter that will never show an edge again (in standby, say) advances to the deadline,
    /// too: a deadline of `u64::MAX` then leaves no time to go on in.
    pub fn run_until_edge(&self, axis: usize, deadline_ps: u64) -> Option<u64> {
        let mut converter = self.converters[axis].borrow_mut();
        converter.catch_up(self.now_ps());
        while let Some(next_ps) = converter
            .timeline()
            .next_ps()
            .filter(|&at| at <= deadline_ps)
        {
            converter.catch_up(next_ps);
            self.now_ps.set(next_ps);
            if converter.timeline().fell_ps() == Some(next_ps) {
                return Some(next_ps);
            }
        }
        self.now_ps.set(self.now_ps().max(deadline_ps));
        None
    }

    /// Time of the latest falling edge on the DRDY pin of `axis`, picoseconds; `None` if there was none
    /// since its conversions started afresh.
    pub fn last_edge_ps(&self, axis: usize) -> Option<u64> {
        self.converter(axis).timeline().fell_ps()
    }

    /// Time at which the converter of `axis` next does something by itself, picoseconds: makes a word, or
    /// lets DRDY fall. `None` while it does not convert.
    pub fn next_change_ps(&self, axis: usize) -> Option<u64> {
        self.converter(axis).timeline().next_ps()
    }

    /// Lets a fault happen now.
    pub fn inject(&self, axis: usize, fault: Fault) {
        self.converter(axis).suffer(self.now_ps(), fault);
    }

    /// Lets a fault happen when word number `word` of `axis` is about to be made. False if eight
    /// faults are waiting already.
    pub fn inject_at(&self, axis: usize, word: u64, fault: Fault) -> bool {
        self.converter(axis).inject_at(word, fault)
    }

    /// Whether a breach of the rules panics (at first, it does).
    pub fn set_strict(&self, strict: bool) {
        self.strict.set(strict);
    }

    /// The first breach of the rules.
    pub fn violation(&self) -> Option<Violation> {
        self.violation.get()
    }

    /// Count and digest of the words that `axis` has made so far.
    pub fn sent(&self, axis: usize) -> Sent {
        self.converter(axis).sent()
    }

    /// Word number `index` of `axis`, if it is among the latest 32.
    pub fn word(&self, axis: usize, index: u64) -> Option<u32> {
        self.converter(axis).word(index)
    }

    /// The registers of `axis` as they are.
    pub fn registers(&self, axis: usize) -> Registers {
        self.converter(axis).registers().clone()
    }

    /// A converter, brought up to now.
    pub(crate) fn converter(&self, axis: usize) -> RefMut<'_, Converter<S>> {
        let mut converter = self.converters[axis].borrow_mut();
        converter.catch_up(self.now_ps());
        converter
    }

    /// Clocks bytes through a bus: `din` gives each, `dout` gets each.
    pub(crate) fn clock(
        &self,
        axis: usize,
        bytes: usize,
        din: impl Fn(usize) -> u8,
        mut dout: impl FnMut(usize, u8),
    ) {
        let bit_ps = self.bit_ps[axis].get();
        let mut converter = self.converters[axis].borrow_mut();
        let mut now_ps = self.now_ps();
        if let Some(later_ps) = converter.held_up_until(now_ps, bit_ps) {
            now_ps = later_ps;
        }
        for i in 0..bytes {
            dout(i, converter.clock(now_ps, bit_ps, din(i)));
            now_ps += 8 * bit_ps;
        }
        self.now_ps.set(now_ps);
        if let Some((at_ps, rule)) = converter.take_breach() {
            drop(converter);
            self.breach(at_ps, axis, rule);
        }
    }

    /// Sets the level of the SYNC line.
    pub(crate) fn set_sync(&self, high: bool) {
        if self.sync_high.replace(high) == high {
            return;
        }
        let now_ps = self.now_ps();
        let changed_ps = self.sync_changed_ps.replace(Some(now_ps));
        if changed_ps.is_some_and(|changed| now_ps - changed < SYNC_PULSE_PS) {
            self.breach(now_ps, 0, Rule::SyncPulse);
        }
        if high {
            for axis in 0..3 {
                self.converter(axis).sync(now_ps);
            }
        }
    }

    fn breach(&self, at_ps: u64, axis: usize, rule: Rule) {
        let violation = Violation { at_ps, axis, rule };
        if self.violation.get().is_none() {
            self.violation.set(Some(violation));
        }
        assert!(!self.strict.get(), "{violation}");
    }
}

/// The axis, if there is one.
fn checked(axis: usize) -> usize {
    assert!(axis < 3, "no axis {axis}: there are 0, 1 and 2");
    axis
}
