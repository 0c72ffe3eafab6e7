//! The driver against a hand-written bus: the exact bytes on DIN, the gaps between them, and
//! what it makes of the answers. Opcodes and addresses stand here as numbers of the data sheet
//! (SBAS378D, page 30), not as the driver's own constants.

mod part;
mod wires;

use std::rc::Rc;

use ads1281::calibrate::Calibration;
use ads1281::register::Address;
use ads1281::{DataReady, Error, Mode, Polled};
use part::{CONFIG, CONFIGURE, DEFAULTS, IDENTIFY, REGISTERS, configure_answers, identify_answers};
use wires::{Driver, Mock, Overrun, Step, continuous, driver};

#[test]
fn construction_sends_nothing_and_release_gives_all_back() {
    let (driver, mock) = driver();
    assert_eq!(driver.mode(), Mode::Unknown);
    let (spi, drdy, delay) = driver.release();
    assert_eq!(mock.bytes(), []);
    drop((spi, drdy, delay));
    assert_eq!(Rc::strong_count(&mock.0), 1);
}

#[test]
fn configuration_is_written_around_the_reserved_register_and_read_back() {
    let (mut driver, mock) = driver();
    mock.answers(&configure_answers(REGISTERS));
    assert_eq!(driver.configure(&CONFIG()), Ok(REGISTERS));
    mock.assert_gaps();
    assert_eq!(mock.bytes(), CONFIGURE);
    assert_eq!(driver.mode(), Mode::Stopped);
}

#[test]
fn a_register_that_reads_otherwise_is_named() {
    for address in [1, 3, 4, 5, 6, 7, 8, 9, 10] {
        let mut registers = REGISTERS;
        registers[address] ^= 0x04;
        let (mut driver, mock) = driver();
        mock.answers(&configure_answers(registers));
        assert_eq!(
            driver.configure(&CONFIG()),
            Err(Error::Verify {
                address: Address::ALL[address],
                wrote: REGISTERS[address],
                found: registers[address],
            })
        );
    }
}

#[test]
fn the_reserved_register_may_read_anything() {
    let mut registers = REGISTERS;
    registers[2] = 0xC3;
    let (mut driver, mock) = driver();
    mock.answers(&configure_answers(registers));
    assert_eq!(driver.configure(&CONFIG()), Ok(registers));
}

#[test]
fn an_identity_that_is_not_the_parts_is_refused() {
    for (id, good) in [(0x00, true), (0xF0, true), (0xFF, false), (0x01, false)] {
        let mut registers = DEFAULTS;
        registers[0] = id;
        let expected = if good {
            Ok(registers)
        } else {
            Err(Error::WrongId { found: id })
        };
        let (mut driver, mock) = driver();
        mock.answers(&identify_answers(registers));
        assert_eq!(driver.identify(), expected);
        assert_eq!(mock.bytes(), IDENTIFY);
    }
}

#[test]
fn registers_of_all_zeros_or_ones_are_nobodys() {
    for found in [0x00, 0xFF] {
        let (mut driver, mock) = driver();
        mock.answers(&identify_answers([found; 11]));
        assert_eq!(driver.identify(), Err(Error::WrongId { found }));
        let (mut driver, mock) = self::driver();
        mock.answers(&configure_answers([found; 11]));
        assert_eq!(driver.configure(&CONFIG()), Err(Error::WrongId { found }));
    }
}

#[test]
fn who_is_identified_is_at_its_defaults_but_for_the_reserved_register() {
    for address in 1..11 {
        let mut registers = DEFAULTS;
        registers[address] ^= 0x04;
        let expected = if address == 2 {
            Ok(registers)
        } else {
            Err(Error::Verify {
                address: Address::ALL[address],
                wrote: DEFAULTS[address],
                found: registers[address],
            })
        };
        let (mut driver, mock) = driver();
        mock.answers(&identify_answers(registers));
        assert_eq!(driver.identify(), expected, "register {address}");
    }
}

#[test]
fn every_command_has_its_opcode_and_mode() {
    type Call = fn(&mut Driver) -> Result<(), Error<Overrun>>;
    let calls: [(&str, Call, &[u8]); 9] = [
        ("RESET", Driver::reset, &[0x06]),
        ("RDATAC, already on", Driver::read_continuously, &[]),
        ("SDATAC", Driver::stop, &[0x11]),
        ("STANDBY", Driver::standby, &[0x11, 0x02]),
        ("WAKEUP", Driver::wakeup, &[0x11, 0x00]),
        ("SYNC", Driver::synchronise, &[0x11, 0x04]),
        ("RDATA", Driver::request, &[0x11, 0x12]),
        ("OFSCAL", Driver::calibrate_offset, &[0x11, 0x60, 0x10]),
        ("GANCAL", Driver::calibrate_gain, &[0x11, 0x61, 0x10]),
    ];
    for (name, call, expected) in calls {
        let (mut driver, mock) = continuous();
        assert_eq!(call(&mut driver), Ok(()), "{name}");
        mock.assert_gaps();
        assert_eq!(mock.bytes(), expected, "{name}");
    }
}

#[test]
fn the_interface_is_stopped_once_and_again_after_a_reset() {
    let (mut driver, mock) = continuous();
    driver.stop().expect("no fault set");
    driver.stop().expect("no fault set");
    assert_eq!(mock.bytes(), [0x11]);
    driver.reset().expect("no fault set");
    assert_eq!(driver.mode(), Mode::Unknown);
    driver.stop().expect("no fault set");
    assert_eq!(mock.bytes(), [0x06, 0x11]);
}

#[test]
fn a_word_is_read_in_one_go_with_din_low() {
    let (mut driver, mock) = continuous();
    mock.answers(&[0x12, 0x34, 0x56, 0x78]);
    let reading = driver.read().expect("no fault set");
    assert_eq!(reading.word.0, 0x1234_5678);
    assert!(!reading.torn);
    let steps = mock.0.borrow().steps.clone();
    let zero = Step::Byte(0);
    // The word may be replaced 4 clocks ahead of the edge that tells of it.
    let wait = Step::Pause { ns: 980 };
    assert_eq!(steps, [zero, zero, zero, zero, Step::Flush, wait]);
}

#[test]
fn an_edge_during_the_reading_tears_it_and_the_next() {
    for bytes in 1..=4 {
        let (mut driver, mock) = continuous();
        mock.set_edge();
        mock.0.borrow_mut().edge_after = Some(bytes);
        let torn = driver.take_new().expect("no fault").expect("an edge");
        assert!(torn.torn, "edge after {bytes} bytes");
        assert_eq!(driver.take_new(), Ok(None), "its word has been shifted out");
        mock.set_edge();
        let next = driver.take_new().expect("no fault").expect("an edge");
        assert!(!next.torn);
    }
}

#[test]
fn an_edge_before_the_reading_does_not_tear_it() {
    let (mut driver, mock) = continuous();
    mock.set_edge();
    assert!(!driver.read().expect("no fault set").torn);
    assert_eq!(driver.take_new(), Ok(None));
}

#[test]
fn a_word_is_refused_where_there_is_none() {
    let (mut driver, mock) = driver();
    assert_eq!(driver.read(), Err(Error::Mode));
    driver.stop().expect("no fault set");
    assert_eq!(driver.read(), Err(Error::Mode));
    driver.request().expect("no fault set");
    mock.clear();
    assert!(driver.read().is_ok());
    assert_eq!(mock.bytes(), [0; 4]);
    assert_eq!(driver.read(), Err(Error::Mode), "RDATA asks for one word");
}

#[test]
fn one_register_is_checked_between_two_conversions() {
    let (mut driver, mock) = continuous();
    mock.answers(&[0, 0, 0, 0x5A, 0]);
    assert_eq!(driver.check_register(Address::Config0), Ok(0x5A));
    mock.assert_gaps();
    let first = mock.0.borrow().steps[0];
    assert!(matches!(first, Step::Pause { .. }), "a word came before");
    assert_eq!(mock.bytes(), [0x11, 0x21, 0x00, 0x00, 0x10]);
    assert_eq!(driver.mode(), Mode::Continuous);
}

#[test]
fn a_conversion_that_ends_during_a_check_is_lost() {
    let (mut driver, mock) = continuous();
    mock.0.borrow_mut().edge_after = Some(3);
    driver
        .check_register(Address::Config0)
        .expect("no fault set");
    assert_eq!(driver.take_new(), Ok(None));
}

#[test]
fn a_bus_fault_is_kept_as_it_came_and_the_driver_keeps_its_feet() {
    for bytes in 0..CONFIGURE.len() {
        let (mut driver, mock) = driver();
        mock.0.borrow_mut().fault_after = Some((bytes, bytes));
        assert_eq!(
            driver.configure(&CONFIG()),
            Err(Error::Bus(Overrun { at: bytes })),
            "after {bytes} bytes"
        );
        mock.answers(&configure_answers(REGISTERS)[if bytes > 0 { 1 } else { 0 }..]);
        assert_eq!(driver.configure(&CONFIG()), Ok(REGISTERS));
    }
    let (mut driver, mock) = continuous();
    mock.set_edge();
    mock.0.borrow_mut().fault_after = Some((2, 2));
    assert_eq!(driver.take_new(), Err(Error::Bus(Overrun { at: 2 })));
}

#[test]
fn calibration_words_are_read_from_their_registers() {
    let (mut driver, mock) = driver();
    mock.answers(&[0, 0, 0, 0xFB, 0xFF, 0xFF, 0, 0, 0x45, 0x23, 0x41]);
    let expected = Calibration {
        offset: -5,
        gain: 0x41_2345,
    };
    assert_eq!(driver.read_calibration(), Ok(expected));
    assert_eq!(
        mock.bytes(),
        [0x11, 0x25, 0x02, 0, 0, 0, 0x28, 0x02, 0, 0, 0]
    );
}

#[test]
fn the_level_of_drdy_is_active_low() {
    let (mut driver, mock) = driver();
    assert_eq!(driver.is_ready(), Ok(false));
    mock.0.borrow_mut().level_low = true;
    assert_eq!(driver.is_ready(), Ok(true));
}

#[test]
fn a_reset_pin_that_is_wired_is_pulled_and_no_command_sent() {
    let (driver, mock) = driver();
    let mut driver = driver.with_reset(mock.clone());
    mock.set_edge();
    driver.reset().expect("no fault set");
    let steps = mock.0.borrow().steps.clone();
    let [low, high] = [true, false].map(|low| Step::Reset { low });
    let &[first, Step::Pause { ns }, last] = &steps[..] else {
        panic!("{steps:?}");
    };
    assert_eq!([first, last], [low, high]);
    // Two clocks of 4.096 MHz are asked for.
    assert!(f64::from(ns) >= 2.0 / 4.096e6 * 1e9, "{ns} ns");
    assert_eq!(driver.mode(), Mode::Unknown);
    assert_eq!(driver.take_new(), Ok(None), "an edge of before");
}

#[test]
fn a_polled_pin_shows_each_fall_once() {
    let mock = Mock::default();
    let mut pin = Polled::new(mock.clone());
    let mut look = |low| {
        mock.0.borrow_mut().level_low = low;
        pin.take_edge()
    };
    let levels = [true, true, false, false, true, true, false, true];
    let edges = levels.map(&mut look);
    assert_eq!(
        edges,
        [false, false, false, false, true, false, false, true]
    );
}
