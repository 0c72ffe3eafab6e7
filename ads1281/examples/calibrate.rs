//! Task: the offset measured by the part itself, and what it found.
//!
//! `main` runs it against a transcript of the bus in place of a part.

use ads1281::calibrate::{AVERAGED_READINGS, Calibration};
use ads1281::{Ads1281, DataReady, Error, Polled, SETTLING_READINGS};
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiBus;
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Level};
use embedded_hal_mock::eh1::spi::{Mock as Spi, Transaction as Bytes};

/// Offset and gain words behind OFSCAL. The input is at zero, the high-pass off, and
/// [`SETTLING_READINGS`] have passed since the configuration; the next edge of DRDY comes once
/// [`AVERAGED_READINGS`] were averaged.
fn offset<S: SpiBus, D: DataReady, W: DelayNs>(
    converter: &mut Ads1281<S, D, W>,
) -> Result<Calibration, Error<S::Error>> {
    converter.calibrate_offset()?;
    while !converter.take_edge() {}
    converter.read_calibration()
}

fn main() {
    println!("{SETTLING_READINGS} readings to settle, {AVERAGED_READINGS} to average");
    let byte = |(sent, answer)| {
        [
            Bytes::transfer_in_place(vec![sent], vec![answer]),
            Bytes::flush(),
        ]
    };
    // SDATAC, OFSCAL, RDATAC; behind the edge SDATAC, RREG of OFC and of FSC.
    let bus = [
        [(0x11, 0), (0x60, 0), (0x10, 0), (0x11, 0)],
        [(0x25, 0), (0x02, 0), (0, 0xFB), (0, 0xFF)],
        [(0, 0xFF), (0x28, 0), (0x02, 0), (0, 0x00)],
    ]
    .concat();
    let bus = [bus, vec![(0, 0x00), (0, 0x40)]].concat();
    let bus: Vec<_> = bus.into_iter().flat_map(byte).collect();
    let mut spi = Spi::new(&bus);
    let levels = [State::High, State::High, State::Low];
    let mut pin = Pin::new(&levels.map(Level::get));
    let mut converter = Ads1281::new(spi.clone(), Polled::new(pin.clone()), NoopDelay);
    let found = offset(&mut converter).expect("no fault in the transcript");
    println!(
        "offset {} steps of 256, gain {:06X}h",
        found.offset, found.gain
    );
    assert_eq!((found.offset, found.gain), (-5, 0x40_0000));
    spi.done();
    pin.done();
}

#[test]
fn it_runs() {
    main();
}
