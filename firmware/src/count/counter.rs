//! A timer as a counter of instructions.

use core::cell::Cell;

use inm_firmware::Part;
use stm32f4xx_hal::pac::TIM5;

use super::said;

/// Names of the parts, in the order of [`Part`]; the last is what is not counted.
const NAMES: [&str; PARTS + 1] = [
    "rest",
    "read",
    "check",
    "bins",
    "framing",
    "read-back",
    "health",
    "outside",
];

/// Parts that are counted.
const PARTS: usize = Part::Health as usize + 1;

/// Time below the instrument, and of the counting itself.
pub const OUTSIDE: usize = PARTS;

/// Instructions of one stretch from one edge to the next, by part.
type Counts = [u32; PARTS + 1];

/// Counts of all stretches.
#[derive(Clone, Copy)]
struct Total {
    sum: u64,
    most: u32,
}

/// The counter, and what it found.
pub struct Counter {
    timer: TIM5,
    part: Cell<usize>,
    since: Cell<u32>,
    /// What [`Counter::turn`] itself adds to each part that it ends.
    overhead: Cell<u32>,
    counts: Cell<Counts>,
    parts: Cell<[Total; PARTS]>,
    /// Parts of the stretch with the most instructions.
    worst: Cell<Counts>,
    stretches: Cell<u32>,
}

impl Counter {
    /// Starts the timer and finds out what counting costs.
    pub fn start() -> Self {
        // SAFETY: nothing else in this program uses the timer.
        #[allow(unsafe_code)]
        let timer = unsafe { TIM5::steal() };
        timer.arr().write(|w| w.arr().set(u32::MAX));
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        let counter = Self {
            timer,
            part: Cell::new(OUTSIDE),
            since: Cell::new(0),
            overhead: Cell::new(0),
            counts: Cell::new([0; PARTS + 1]),
            parts: Cell::new([Total { sum: 0, most: 0 }; PARTS]),
            worst: Cell::new([0; PARTS + 1]),
            stretches: Cell::new(0),
        };
        counter.turn(Part::Rest as usize);
        counter.turn(OUTSIDE);
        counter
            .overhead
            .set(counter.counts.get()[Part::Rest as usize]);
        counter.counts.set([0; PARTS + 1]);
        counter
    }

    /// What follows counts for `part`; what counted before.
    #[inline(never)]
    pub fn turn(&self, part: usize) -> usize {
        let now = self.timer.cnt().read().bits();
        let before = self.part.replace(part);
        let spent = now.wrapping_sub(self.since.get());
        let mut counts = self.counts.get();
        counts[before] += spent.saturating_sub(self.overhead.get());
        self.counts.set(counts);
        self.since.set(self.timer.cnt().read().bits());
        before
    }

    /// Does not count `work`.
    pub fn pause<R>(&self, work: impl FnOnce() -> R) -> R {
        let part = self.turn(OUTSIDE);
        let result = work();
        self.turn(part);
        result
    }

    /// Instructions of `work`, which belongs to no stretch.
    pub fn count(&self, work: impl FnOnce()) -> u32 {
        let before = self.counts.replace([0; PARTS + 1]);
        self.turn(Part::Rest as usize);
        work();
        self.turn(OUTSIDE);
        self.counts.replace(before)[Part::Rest as usize]
    }

    /// Counts `step`, a turn of the loop, if it says that it did something. The first that takes
    /// a conversion ends a stretch and begins the next; `true` then.
    pub fn step(&self, step: impl FnOnce() -> bool) -> (bool, bool) {
        let before = self.counts.replace([0; PARTS + 1]);
        self.turn(Part::Rest as usize);
        let busy = step();
        self.turn(OUTSIDE);
        let counts = self.counts.replace(before);
        let conversion = busy && counts[Part::Bins as usize] > 0;
        if conversion {
            self.end_stretch(&before);
            self.counts.set(counts);
        } else if busy {
            let mut sum = before;
            for (sum, count) in sum.iter_mut().zip(counts) {
                *sum += count;
            }
            self.counts.set(sum);
        }
        (busy, conversion)
    }

    fn end_stretch(&self, counts: &Counts) {
        // What came before the first conversion belongs to the start.
        if counts[Part::Bins as usize] == 0 {
            return;
        }
        let mut parts = self.parts.get();
        for (part, &count) in parts.iter_mut().zip(counts) {
            part.sum += u64::from(count);
            part.most = part.most.max(count);
        }
        self.parts.set(parts);
        self.stretches.set(self.stretches.get() + 1);
        if total(counts) > total(&self.worst.get()) {
            self.worst.set(*counts);
        }
    }

    /// Says what was found: of each part the sum over all conversions, the most in one, and
    /// what it was in the worst conversion of all.
    pub fn say(&self) {
        let conversions = self.stretches.get();
        said::line(format_args!("conversions {conversions}"));
        let parts = self.parts.get();
        let worst = self.worst.get();
        for ((name, part), worst) in NAMES.iter().zip(parts).zip(worst) {
            said::line(format_args!(
                "part {name} {} {} {worst}",
                part.sum, part.most
            ));
        }
    }
}

/// Instructions of a stretch.
fn total(counts: &Counts) -> u32 {
    counts[..PARTS].iter().sum()
}
