//! Task: another data rate and filter than RESET leaves, written and read back, with RESET wired to a
//! pin.
//!
//! `main` runs it against a transcript of the bus in place of a part.

use ads1281::config::Config;
use ads1281::register::{Config0, Output, Phase, Rate};
use ads1281::{Ads1281, DataReady, Error, Polled, RESET_US, ResetPin, SETTLING_READINGS};
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiBus;
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Level};
use embedded_hal_mock::eh1::spi::{Mock as Spi, Transaction as Bytes};

/// 4000/s, minimum phase, high-pass at its default corner: what must be awaited, in readings.
fn configure<S: SpiBus, D: DataReady, W: DelayNs, R: ResetPin>(
    converter: &mut Ads1281<S, D, W, R>,
) -> Result<u32, Error<S::Error>> {
    converter.reset()?;
    converter.pause_us(RESET_US);
    converter.configure(&Config {
        config0: Config0 {
            rate: Rate::Sps4000,
            phase: Phase::Minimum,
            output: Output::FirHighPass,
            ..Config0::default()
        },
        ..Config::default()
    })?;
    Ok(SETTLING_READINGS)
}

fn main() {
    let byte = |(sent, answer)| {
        [
            Bytes::transfer_in_place(vec![sent], vec![answer]),
            Bytes::flush(),
        ]
    };
    let written = [0x32, 0x03, 0, 0, 0, 0, 0, 0x40];
    // SDATAC; WREG of CONFIG0; WREG of the eight from HPF0 on; RREG of all eleven.
    let sent = [
        &[0x11, 0x41, 0x00, 0x67, 0x43, 0x07][..],
        &written,
        &[0x20, 0x0A],
    ]
    .concat();
    let mut bus: Vec<(u8, u8)> = sent.into_iter().map(|sent| (sent, 0)).collect();
    let read = [&[0x10, 0x67, 0x08][..], &written].concat();
    bus.extend(read.into_iter().map(|answer| (0, answer)));
    let bus: Vec<_> = bus.into_iter().flat_map(byte).collect();
    let mut spi = Spi::new(&bus);
    let mut drdy = Pin::new(&[Level::get(State::High)]);
    let mut reset = Pin::new(&[State::Low, State::High].map(Level::set));
    let converter = Ads1281::new(spi.clone(), Polled::new(drdy.clone()), NoopDelay);
    let mut converter = converter.with_reset(reset.clone());
    let settling = configure(&mut converter).expect("it reads what was written");
    println!("good from reading {settling} on");
    spi.done();
    drdy.done();
    reset.done();
}

#[test]
fn it_runs() {
    main();
}
