//! QEMU's `netduinoplus2`, a model of the STM32F405, with emulated converters.
//!
//! ```text
//!   qemu-system-arm -M netduinoplus2 -kernel inm-board -serial pty -icount shift=2,sleep=off -nographic
//! ```
//!
//! What QEMU 7.2 models works as on the board: core, NVIC, USART1 and the timers. RCC and GPIO
//! read as zero, so nothing here waits for an oscillator; the SPI answers zeros, so the
//! register-level emulator takes its place and a timer interrupt that of X's DRDY.
//!
//! The converters live in a time of their own, and the instrument sees no other. Each interrupt
//! allows them to run on to its moment, and the loop lets them: where the emulation is slower
//! than the part, bench time merely passes more slowly, and no conversion is lost.

use ads1281::Ads1281;
use cortex_m::peripheral::NVIC;
use inm_emulator::channel::{Channel, published};
use inm_emulator::filter::DECIMATION;
use inm_emulator::{Bench, Converter, Delay, Signal, Spi, SyncPin};
use inm_firmware::emulated::{self, Latched};
use inm_firmware::platform::LONGEST_SLEEP_US;
use inm_firmware::proof::ProofBins;
use inm_protocol::SensorRange;
use stm32f4xx_hal::gpio::GpioExt;
use stm32f4xx_hal::pac::{self, Interrupt, TIM3, interrupt};
use stm32f4xx_hal::rcc::{Enable, RccExt};

use crate::image::clock;
use crate::image::flash::Flash;
use crate::image::handover::Handover;
use crate::image::machine::{Machine, Sensors};
use crate::image::{describe, once, restart, stack, stamps, start_link, start_watchdog};

/// QEMU's timers count at 1 GHz, whatever drives them on the part.
const TIMER_INPUT_HZ: u32 = 1_000_000_000;

/// Ticks of both timers in a second.
const TIMER_HZ: u32 = 100_000_000;

/// Bench time of a tick, picoseconds.
const PS_PER_TICK: u64 = 1_000_000_000_000 / TIMER_HZ as u64;

/// Interrupts a second that let the bench run on: as many as the fastest conversions.
const PACE_HZ: u32 = 4000;

/// Bench time that passes at most between two steps without an edge, picoseconds: the longest sleep of
/// a board. Without it a bench that has fallen behind, as by a start, runs from SYNC to the first word
/// in one step.
const LONGEST_PS: u64 = LONGEST_SLEEP_US as u64 * 1_000_000;

/// Core clock by which QEMU's SysTick counts.
const CORE_HZ: u32 = 168_000_000;

/// Seed of the accelerometers' noise; the test on the host knows it too.
const SEED: u64 = 0x494e_4d31;

/// A published accelerometer that begins anew whenever the data rate changes.
///
/// What the converters put out after a start command at a new rate then depends on the seed
/// and the rate alone, not on how long the host let the board wait before it.
pub struct Record {
    axis: usize,
    channel: Channel,
}

impl Record {
    fn new(axis: usize) -> Self {
        Self {
            axis,
            channel: published(axis, SEED),
        }
    }
}

impl Signal for Record {
    fn set_rate(&mut self, input_hz: u32) {
        *self = Self::new(self.axis);
        self.channel.set_rate(input_hz);
    }

    fn next(&mut self) -> i32 {
        self.channel.next()
    }

    fn fill(&mut self, inputs: &mut [i32; DECIMATION]) {
        self.channel.fill(inputs);
    }
}

static PACEMAKER: Handover<TIM3> = Handover::new();

/// The emulated converters. Times are the bench's, picoseconds.
pub struct Emulated {
    bench: &'static Bench<Record>,
    /// How far the bench may run.
    allowed_ps: u64,
    /// The axis whose edges are stamped.
    trigger: usize,
    /// Latest edge that was stamped.
    stamped_ps: Option<u64>,
}

/// A driver on an emulated bus.
type Axis = Ads1281<Spi<'static, Record>, Latched<'static, Record>, Delay<'static, Record>>;

/// Brings the machine up.
pub fn start(
    bins: &'static mut ProofBins,
) -> (Machine<Emulated>, [Axis; 3], SyncPin<'static, Record>) {
    let mut core = once(cortex_m::Peripherals::take());
    let chip = once(pac::Peripherals::take());
    let watchdog = start_watchdog(chip.IWDG);
    // The reset clock stays.
    let mut rcc = chip.RCC.constrain();
    let divider = TIMER_INPUT_HZ / TIMER_HZ;
    clock::start(
        chip.TIM2,
        (TIMER_INPUT_HZ, divider),
        &mut core.SYST,
        CORE_HZ,
        &mut rcc,
    );
    let gpioa = chip.GPIOA.split(&mut rcc);
    let link = start_link(chip.USART1, gpioa.pa9, gpioa.pa10, &mut rcc);

    let bench = bench();
    // Building it took more stack than the board's program ever does.
    stack::repaint();

    TIM3::enable(&mut rcc);
    start_pacemaker(chip.TIM3, divider);

    let machine = Machine {
        board: describe([0; 3], TIMER_HZ, restart::reason(false)),
        sensors: Emulated {
            bench,
            allowed_ps: 0,
            trigger: 0,
            stamped_ps: None,
        },
        link,
        bins,
        watchdog,
        flash: Flash::new(chip.FLASH),
    };
    let axes = [0, 1, 2].map(|axis| emulated::converter(bench, axis));
    (machine, axes, bench.sync())
}

/// The bench, in a static. A function of its own, so that the copies that building it takes do
/// not stay on the stack.
#[inline(never)]
fn bench() -> &'static Bench<Record> {
    let bench = once(cortex_m::singleton!(: Bench<Record> =
        Bench::from_fn(converter)));
    // A breach of the part's rules is a matter for the tests on the host.
    bench.set_strict(false);
    bench
}

/// A function of its own, too: what it copies does not add up.
#[inline(never)]
fn converter(axis: usize) -> Converter<Record> {
    Converter::new(Record::new(axis))
}

fn start_pacemaker(timer: TIM3, divider: u32) {
    timer.psc().write(|w| w.psc().set((divider - 1) as u16));
    timer
        .arr()
        .write(|w| w.arr().set((TIMER_HZ / PACE_HZ - 1) as u16));
    timer.egr().write(|w| w.ug().set_bit());
    timer.dier().write(|w| w.uie().set_bit());
    timer.cr1().write(|w| w.cen().set_bit());
    PACEMAKER.give(timer);
    // SAFETY: the handler is defined below, what it needs is in place, and no critical section
    // is built on the interrupt's mask.
    #[allow(unsafe_code)]
    unsafe {
        NVIC::unmask(Interrupt::TIM3);
    }
}

/// In the part of X's DRDY interrupt on the board.
#[interrupt]
fn TIM3() {
    static mut TIMER: Option<TIM3> = None;
    if let Some(timer) = PACEMAKER.receive(TIMER) {
        timer.sr().modify(|_, w| w.uif().clear_bit());
        stamps::stamp();
    }
}

impl Sensors for Emulated {
    type Spi = Spi<'static, Record>;
    type Drdy = Latched<'static, Record>;
    type Sync = SyncPin<'static, Record>;
    type Delay = Delay<'static, Record>;

    fn now(&self) -> u64 {
        self.bench.now_ps() / PS_PER_TICK
    }

    fn trigger_on(&mut self, axis: usize) {
        self.trigger = axis;
    }

    fn take_edge_stamp(&mut self) -> Option<u64> {
        if let Some(stamp) = stamps::take() {
            self.allowed_ps = stamp * PS_PER_TICK;
        }
        // An edge may have come while a word was read; else the bench runs to the next.
        let mut edge_ps = self.bench.last_edge_ps(self.trigger);
        if edge_ps == self.stamped_ps {
            // However far the bench is behind: the instrument sees all times that it would on the
            // board, its deadlines among them.
            let deadline_ps = self.allowed_ps.min(self.bench.now_ps() + LONGEST_PS);
            edge_ps = Some(self.bench.run_until_edge(self.trigger, deadline_ps)?);
        }
        self.stamped_ps = edge_ps;
        edge_ps.map(|ps| ps / PS_PER_TICK)
    }

    /// The emulated accelerometers have no self-test.
    fn self_test(&mut self, _on: bool) {}

    /// Nor a second range.
    fn select_range(&mut self, _range: SensorRange) {}
}
