//! Task: one word when it is asked for, the interface stopped in between, so that registers can be
//! reached at any time.
//!
//! `main` runs it against a transcript of the bus in place of a part.

use ads1281::word::Word;
use ads1281::{Ads1281, DataReady, Error, Polled};
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiBus;
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Level};
use embedded_hal_mock::eh1::spi::{Mock as Spi, Transaction as Bytes};

/// The word of the next conversion.
fn one_word<S: SpiBus, D: DataReady, W: DelayNs>(
    converter: &mut Ads1281<S, D, W>,
) -> Result<Word, Error<S::Error>> {
    converter.request()?;
    loop {
        if let Some(reading) = converter.take_new()? {
            return Ok(reading.word);
        }
    }
}

fn main() {
    let command = |sent| {
        [
            Bytes::transfer_in_place(vec![sent], vec![0]),
            Bytes::flush(),
        ]
    };
    let word = [
        Bytes::transfer_in_place(vec![0; 4], vec![0x7F, 0xFF, 0xFF, 0xFE]),
        Bytes::flush(),
    ];
    // SDATAC, RDATA, and the word behind the next fall of DRDY.
    let bus = [&command(0x11)[..], &command(0x12), &word].concat();
    let mut spi = Spi::new(&bus);
    let levels = [State::High, State::High, State::Low, State::Low, State::Low];
    let mut pin = Pin::new(&levels.map(Level::get));
    let mut converter = Ads1281::new(spi.clone(), Polled::new(pin.clone()), NoopDelay);
    let word = one_word(&mut converter).expect("no fault in the transcript");
    println!("{} of {}", word.value(), (1 << 30) - 1);
    assert_eq!(word.value(), (1 << 30) - 1);
    spi.done();
    pin.done();
}

#[test]
fn it_runs() {
    main();
}
