//! The run: a stream, then the bins alone, then the interrupts.
//!
//! ```text
//!   counter   a timer as a counter of instructions, split by part
//!   outside   buses, pins and the machine below the instrument: not counted, or replaced
//!   said      what was counted, through semihosting; ends QEMU
//! ```

mod counter;
mod outside;
mod said;

use core::hint::black_box;

use cortex_m::peripheral::NVIC;
use inm_firmware::proof::ProofBins;
use inm_firmware::{Instrument, Platform};
use inm_protocol::{AXES, Code, Flags, samples_load};
use stm32f4xx_hal::pac::Interrupt;

use crate::board;
use crate::image::once;
use counter::Counter;
use outside::{Counted, Outside};

/// Conversions counted: ten health records, and every level of the bins up to averages of
/// 10 000.
const CONVERSIONS: u32 = 40_000;

/// Conversions for the bins alone, which reach higher levels so.
const BINS_CONVERSIONS: u64 = 1 << 18;

/// One in so many of those is missing: runs that nearly all levels have differences in.
const GAP: u64 = 65_521;

/// A frame of that many bytes shows what a byte costs in the interrupt.
const BYTES: usize = 64;

/// Counts everything and says it; ends QEMU.
pub extern "C" fn run(bins: &'static mut ProofBins) -> ! {
    let (machine, converters, sync) = board::start(bins);
    defmt::info!("start, {}", defmt::Debug2Format(machine.restart()));
    let counter = once(cortex_m::singleton!(: Counter = Counter::start()));
    let counter: &'static Counter = counter;
    let converters = converters.map(|one| outside::converter(one, counter));
    let sync = Outside::new(sync, counter);
    cortex_m::interrupt::disable();
    let mut instrument = Instrument::new(Counted::new(machine, counter), converters, sync);

    let mut conversions = 0;
    while conversions < CONVERSIONS {
        let (busy, conversion) = counter.step(|| instrument.step());
        conversions += u32::from(conversion);
        let_interrupts_in();
        if !busy {
            instrument.platform().sleep();
        }
    }
    counter.say();
    let load = samples_load(outside::settings(), instrument.platform().board().baud);
    said::line(format_args!("link {} bytes/s", load.needed));

    count_interrupts(instrument.platform_mut(), counter);
    let bins = instrument.platform_mut().bins();
    count_bins("bins-whole", bins, counter, |_| false);
    count_bins("bins-gaps", bins, counter, |index| index % GAP == 0);
    let spent = counter.count(|| {
        black_box(bins.mark(BINS_CONVERSIONS));
    });
    said::line(format_args!("alone digests 1 {spent} {spent}"));
    said::end();
}

/// Interrupts that wait are served now.
fn let_interrupts_in() {
    // SAFETY: no critical section is open here.
    #[allow(unsafe_code)]
    unsafe {
        cortex_m::interrupt::enable();
    }
    cortex_m::asm::isb();
    cortex_m::interrupt::disable();
}

/// The interrupt of an edge, and that of the transmitter, without and with bytes to send.
fn count_interrupts(platform: &mut Counted, counter: &Counter) {
    let_interrupts_in();
    NVIC::mask(Interrupt::TIM3);
    let nothing = counter.count(let_interrupts_in);
    let one = |name, bytes, interrupt| {
        NVIC::pend(interrupt);
        let spent = counter.count(let_interrupts_in) - nothing;
        said::line(format_args!("interrupt {name} {bytes} {spent}"));
    };
    one("transmit", 0, Interrupt::USART1);
    // The queue is empty: there is room.
    platform.transmit(&[0; BYTES]);
    one("transmit", BYTES, Interrupt::USART1);
    // SAFETY: as at the start; the handler has run before.
    #[allow(unsafe_code)]
    unsafe {
        NVIC::unmask(Interrupt::TIM3);
    }
    one("edge", 0, Interrupt::TIM3);
}

/// The bins alone, on words of no pattern; those of `missing` do not come.
fn count_bins(name: &str, bins: &mut ProofBins, counter: &Counter, missing: impl Fn(u64) -> bool) {
    bins.begin(0);
    let mut word = 1_u32;
    let (mut sum, mut most, mut taken) = (0_u64, 0, 0_u64);
    for index in 0..BINS_CONVERSIONS {
        let codes = [(); AXES].map(|()| {
            // Numerical Recipes' quick generator, as good as any for the bins' arithmetic.
            word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            Code(word.cast_signed() >> 8)
        });
        if missing(index) {
            continue;
        }
        let spent = counter.count(|| {
            bins.conversion(black_box(index), &codes, &[Flags::NONE; AXES]);
        });
        sum += u64::from(spent);
        most = most.max(spent);
        taken += 1;
    }
    said::line(format_args!("alone {name} {taken} {sum} {most}"));
}
