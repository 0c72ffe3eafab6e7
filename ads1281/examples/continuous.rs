//! Task: every conversion, as it comes. RESET, look who is there, then read continuously and wait for
//! DRDY.
//!
//! `main` runs it against a transcript of the bus in place of a part.

use ads1281::word::Sign;
use ads1281::{Ads1281, DataReady, Error, POWER_UP_US, Polled, RESET_US};
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiBus;
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Level};
use embedded_hal_mock::eh1::spi::{Mock as Spi, Transaction as Bytes};

/// The next values, in steps of VREF / (2 (2^30 - 1)); `None` for a word that must not be used.
fn read<S: SpiBus, D: DataReady, W: DelayNs, const N: usize>(
    converter: &mut Ads1281<S, D, W>,
) -> Result<[Option<i32>; N], Error<S::Error>> {
    converter.pause_us(POWER_UP_US);
    converter.reset()?;
    converter.pause_us(RESET_US);
    let registers = converter.identify()?;
    println!("identity {:02X}h", registers[0]);
    converter.read_continuously()?;
    let mut values = [None; N];
    for value in &mut values {
        let reading = loop {
            if let Some(reading) = converter.take_new()? {
                break reading;
            }
        };
        let good = !reading.torn && reading.word.sign(Default::default()) == Sign::Good;
        *value = good.then(|| reading.word.value());
    }
    Ok(values)
}

fn main() {
    let byte = |sent, answer| {
        [
            Bytes::transfer_in_place(vec![sent], vec![answer]),
            Bytes::flush(),
        ]
    };
    let word = |answer: i32| {
        let answer = answer.to_be_bytes().to_vec();
        [Bytes::transfer_in_place(vec![0; 4], answer), Bytes::flush()]
    };
    let defaults = [0x10, 0x52, 0x08, 0x32, 0x03, 0, 0, 0, 0, 0, 0x40];
    let mut bus = vec![];
    // RESET, SDATAC, RREG of eleven, RDATAC.
    bus.extend([0x06, 0x11, 0x20, 0x0A].map(|sent| byte(sent, 0)).concat());
    bus.extend(defaults.map(|answer| byte(0, answer)).concat());
    bus.extend(byte(0x10, 0));
    bus.extend([2000, -4001].map(word).concat());
    let mut spi = Spi::new(&bus);
    // High where a look after a command finds it, then it falls twice.
    let levels = [1, 1, 0, 0, 0, 1, 0, 0, 0];
    let levels = levels.map(|level| Level::get(if level == 1 { State::High } else { State::Low }));
    let mut pin = Pin::new(&levels);
    let mut converter = Ads1281::new(spi.clone(), Polled::new(pin.clone()), NoopDelay);
    let values: [_; 2] = read(&mut converter).expect("no fault in the transcript");
    println!("{values:?}");
    assert_eq!(values, [Some(1000), Some(-2001)]);
    spi.done();
    pin.done();
}

#[test]
fn it_runs() {
    main();
}
