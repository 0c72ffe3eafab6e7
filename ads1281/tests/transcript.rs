//! The driver against a hand-written bus: the exact bytes on DIN, the gaps between them, and
//! what it makes of the answers. Opcodes and addresses stand here as numbers of the data sheet
//! (SBAS378D, page 30), not as the driver's own constants.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use ads1281::calibrate::Calibration;
use ads1281::config::Config;
use ads1281::register::{Address, Config0, Rate};
use ads1281::{Ads1281, DataReady, Error, Mode, Polled};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{self, InputPin, OutputPin};
use embedded_hal::spi::{self, ErrorKind, SpiBus};

/// What the wires saw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Byte(u8),
    Flush,
    Pause { ns: u32 },
    Reset { low: bool },
}

#[derive(Default)]
struct Wires {
    steps: Vec<Step>,
    /// Bytes on DOUT, one for each on DIN; zeros when used up.
    dout: VecDeque<u8>,
    /// Fail the transfer after that many bytes: those left, and all of them.
    fault_after: Option<(usize, usize)>,
    edge: bool,
    /// An edge arrives when that many bytes have passed.
    edge_after: Option<usize>,
    level_low: bool,
}

#[derive(Clone, Default)]
struct Mock(Rc<RefCell<Wires>>);

/// An error of the bus that says more than its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Overrun {
    /// Bytes that had passed.
    at: usize,
}

impl spi::Error for Overrun {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Overrun
    }
}

impl spi::ErrorType for Mock {
    type Error = Overrun;
}

impl SpiBus<u8> for Mock {
    fn read(&mut self, _: &mut [u8]) -> Result<(), Overrun> {
        panic!("the level on DIN is left open here, and the part decodes it");
    }

    fn write(&mut self, words: &[u8]) -> Result<(), Overrun> {
        let mut words = words.to_vec();
        self.transfer_in_place(&mut words)
    }

    fn transfer(&mut self, _: &mut [u8], _: &[u8]) -> Result<(), Overrun> {
        panic!("not used");
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Overrun> {
        let mut wires = self.0.borrow_mut();
        for word in words {
            if let Some((left, at)) = wires.fault_after {
                if left == 0 {
                    wires.fault_after = None;
                    return Err(Overrun { at });
                }
                wires.fault_after = Some((left - 1, at));
            }
            wires.steps.push(Step::Byte(*word));
            *word = wires.dout.pop_front().unwrap_or(0);
            if let Some(left) = &mut wires.edge_after {
                *left -= 1;
                if *left == 0 {
                    wires.edge_after = None;
                    wires.edge = true;
                }
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), Overrun> {
        self.0.borrow_mut().steps.push(Step::Flush);
        Ok(())
    }
}

impl DelayNs for Mock {
    fn delay_ns(&mut self, ns: u32) {
        self.0.borrow_mut().steps.push(Step::Pause { ns });
    }
}

impl digital::ErrorType for Mock {
    type Error = Infallible;
}

impl InputPin for Mock {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.borrow().level_low)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.borrow().level_low)
    }
}

impl OutputPin for Mock {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().steps.push(Step::Reset { low: true });
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().steps.push(Step::Reset { low: false });
        Ok(())
    }
}

impl DataReady for Mock {
    fn take_edge(&mut self) -> bool {
        std::mem::take(&mut self.0.borrow_mut().edge)
    }
}

type Driver = Ads1281<Mock, Mock, Mock>;

fn driver() -> (Driver, Mock) {
    let mock = Mock::default();
    let driver = Ads1281::new(mock.clone(), mock.clone(), mock.clone());
    (driver, mock)
}

/// A driver in continuous mode, and its wires with nothing logged.
fn continuous() -> (Driver, Mock) {
    let (mut driver, mock) = driver();
    driver.read_continuously().expect("no fault set");
    mock.clear();
    (driver, mock)
}

impl Mock {
    fn clear(&self) {
        self.0.borrow_mut().steps.clear();
    }

    fn answers(&self, dout: &[u8]) {
        self.0.borrow_mut().dout = dout.iter().copied().collect();
    }

    fn set_edge(&self) {
        self.0.borrow_mut().edge = true;
    }

    /// Bytes on DIN since the last look.
    fn bytes(&self) -> Vec<u8> {
        let steps = std::mem::take(&mut self.0.borrow_mut().steps);
        steps
            .into_iter()
            .filter_map(|step| match step {
                Step::Byte(byte) => Some(byte),
                _ => None,
            })
            .collect()
    }

    /// Asserts that each byte is flushed and followed by at least 24 clocks at 4.096 MHz.
    fn assert_gaps(&self) {
        let wires = self.0.borrow();
        for (k, step) in wires.steps.iter().enumerate() {
            if let Step::Byte(byte) = step {
                assert_eq!(wires.steps.get(k + 1), Some(&Step::Flush), "{byte:02X}h");
                let Some(Step::Pause { ns }) = wires.steps.get(k + 2) else {
                    panic!("no gap after byte {k}, {byte:02X}h");
                };
                assert!(f64::from(*ns) >= 24.0 / 4.096e6 * 1e9, "{ns} ns");
                assert!(*ns < 10_000, "{ns} ns: longer than it needs to be");
            }
        }
    }
}

const CONFIG: fn() -> Config = || {
    let calibration = Calibration {
        offset: -5,
        gain: 0x41_2345,
    };
    let config0 = Config0 {
        rate: Rate::Sps2000,
        ..Config0::default()
    };
    Config {
        config0,
        calibration,
        ..Config::default()
    }
};

/// 00h to 0Ah as they must read with [`CONFIG`] written: ID of some part, 2000/s linear, the
/// reserved byte, HPF at reset, OFC, FSC.
const REGISTERS: [u8; 11] = [
    0x10, 0x5A, 0x08, 0x32, 0x03, 0xFB, 0xFF, 0xFF, 0x45, 0x23, 0x41,
];

/// SDATAC, WREG of one register, WREG of eight, RREG of eleven.
#[rustfmt::skip]
const CONFIGURE: [u8; 27] = [
    0x11,
    0x41, 0x00, 0x5A,
    0x43, 0x07, 0x32, 0x03, 0xFB, 0xFF, 0xFF, 0x45, 0x23, 0x41,
    0x20, 0x0A, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
];

/// 00h to 0Ah of some part after RESET, as tabulated for the family.
const DEFAULTS: [u8; 11] = [
    0x10, 0x52, 0x08, 0x32, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x40,
];

/// SDATAC, RREG of eleven.
const IDENTIFY: [u8; 14] = [0x11, 0x20, 0x0A, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];

/// What DOUT shows meanwhile.
fn identify_answers(registers: [u8; 11]) -> Vec<u8> {
    let mut dout = vec![0xA5; IDENTIFY.len() - registers.len()];
    dout.extend(registers);
    dout
}

/// What DOUT shows meanwhile: the registers, after the two bytes of RREG.
fn configure_answers(registers: [u8; 11]) -> Vec<u8> {
    let mut dout = vec![0xA5; CONFIGURE.len() - registers.len()];
    dout.extend(registers);
    dout
}

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
