//! A host that keeps the rules, byte by byte, for tests that look at what the part does.
#![allow(dead_code, reason = "each test binary uses its own part of this")]

use embedded_hal::{delay::DelayNs, spi::SpiBus};
use inm_emulator::{Bench, Converter, Signal};

pub const SDATAC: u8 = 0x11;
pub const RDATAC: u8 = 0x10;
pub const RDATA: u8 = 0x12;
pub const SYNC: u8 = 0x04;
pub const RESET: u8 = 0x06;

/// Three copies of a signal, powered up for 17 ms.
pub fn bench<S: Signal + Copy>(signal: S) -> Bench<S> {
    bench_of([0, 1, 2].map(|_| Converter::new(signal)))
}

/// These converters, powered up for 17 ms.
pub fn bench_of<S: Signal>(converters: [Converter<S>; 3]) -> Bench<S> {
    let bench = Bench::new(converters);
    bench.delay().delay_ms(17);
    bench
}

/// Sends bytes with the gap behind each.
pub fn send<S: Signal>(bench: &Bench<S>, axis: usize, bytes: &[u8]) {
    for &byte in bytes {
        bench
            .spi(axis)
            .write(&[byte])
            .expect("no bus error injected");
        bench.delay().delay_us(6);
    }
}

/// Reads registers; SDATAC must be in force.
pub fn registers<S: Signal, const N: usize>(bench: &Bench<S>, axis: usize, address: u8) -> [u8; N] {
    send(bench, axis, &[0x20 + address, N as u8 - 1]);
    [(); N].map(|()| {
        let mut byte = [0];
        bench
            .spi(axis)
            .transfer_in_place(&mut byte)
            .expect("no bus error injected");
        bench.delay().delay_us(6);
        byte[0]
    })
}

/// Writes CONFIG0 and leaves the converter in read-continuous mode.
pub fn configure<S: Signal>(bench: &Bench<S>, axis: usize, config0: u8) {
    send(bench, axis, &[SDATAC, 0x41, 0x00, config0, RDATAC]);
}

/// Clocks 32 bits.
pub fn word<S: Signal>(bench: &Bench<S>, axis: usize) -> u32 {
    let mut bytes = [0; 4];
    bench
        .spi(axis)
        .transfer_in_place(&mut bytes)
        .expect("no bus error injected");
    u32::from_be_bytes(bytes)
}

/// Waits for the next DRDY edge, at most a second, and reads the word.
pub fn next_word<S: Signal>(bench: &Bench<S>, axis: usize) -> u32 {
    bench
        .run_until_edge(axis, bench.now_ps() + 1_000_000_000_000)
        .expect("a conversion within a second");
    word(bench, axis)
}
