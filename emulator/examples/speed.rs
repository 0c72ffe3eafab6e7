//! Time per conversion of one axis: noise, pole, filter and an SPI read of four bytes.
//!
//! `cargo run --release -p inm-emulator --example speed`

use std::time::Instant;

use embedded_hal::{delay::DelayNs, spi::SpiBus};
use inm_emulator::{Bench, Conversion, Converter, Registers, Signal, channel::published};

const CONVERSIONS: u32 = 1_000_000;

fn main() -> Result<(), inm_emulator::BusError> {
    let mut channel = published(0, 1);
    channel.set_rate(64_000);
    let mut inputs = [0; 32];
    let mut sum = 0_i64;
    report("signal", || {
        channel.fill(&mut inputs);
        sum += i64::from(inputs[0]);
    });

    let registers = Registers::default();
    let mut conversion = Conversion::new(published(0, 1));
    report("signal and filter", || {
        sum += i64::from(conversion.next_word(&registers));
    });

    let bench = Bench::new([0, 1, 2].map(|axis| Converter::new(published(axis, 1))));
    bench.delay().delay_ms(16);
    let mut failed = None;
    report("one axis through the bus", || {
        bench.run_until_edge(0, u64::MAX);
        let mut word = [0; 4];
        failed = bench.spi(0).transfer_in_place(&mut word).err().or(failed);
        sum += i64::from(i32::from_be_bytes(word));
    });
    // The sum keeps the work from being optimised away.
    println!("{CONVERSIONS} conversions each, checksum {sum:x}");
    failed.map_or(Ok(()), Err)
}

fn report(what: &str, mut conversion: impl FnMut()) {
    let start = Instant::now();
    for _ in 0..CONVERSIONS {
        conversion();
    }
    let ns = start.elapsed().as_secs_f64() * 1e9 / f64::from(CONVERSIONS);
    println!("{what:<26}{ns:6.0} ns a conversion");
}
