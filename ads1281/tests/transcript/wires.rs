//! A hand-written bus with its pins: it keeps what passes, and answers as it is told.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use ads1281::{Ads1281, DataReady};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{self, InputPin, OutputPin};
use embedded_hal::spi::{self, ErrorKind, SpiBus};

/// What the wires saw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    Byte(u8),
    Flush,
    Pause { ns: u32 },
    Reset { low: bool },
}

#[derive(Default)]
pub struct Wires {
    pub steps: Vec<Step>,
    /// Bytes on DOUT, one for each on DIN; zeros when used up.
    pub dout: VecDeque<u8>,
    /// Fail the transfer after that many bytes: those left, and all of them.
    pub fault_after: Option<(usize, usize)>,
    pub edge: bool,
    /// An edge arrives when that many bytes have passed.
    pub edge_after: Option<usize>,
    pub level_low: bool,
}

#[derive(Clone, Default)]
pub struct Mock(pub Rc<RefCell<Wires>>);

/// An error of the bus that says more than its kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Overrun {
    /// Bytes that had passed.
    pub at: usize,
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

pub type Driver = Ads1281<Mock, Mock, Mock>;

pub fn driver() -> (Driver, Mock) {
    let mock = Mock::default();
    let driver = Ads1281::new(mock.clone(), mock.clone(), mock.clone());
    (driver, mock)
}

/// A driver in continuous mode, and its wires with nothing logged.
pub fn continuous() -> (Driver, Mock) {
    let (mut driver, mock) = driver();
    driver.read_continuously().expect("no fault set");
    mock.clear();
    (driver, mock)
}

impl Mock {
    pub fn clear(&self) {
        self.0.borrow_mut().steps.clear();
    }

    pub fn answers(&self, dout: &[u8]) {
        self.0.borrow_mut().dout = dout.iter().copied().collect();
    }

    pub fn set_edge(&self) {
        self.0.borrow_mut().edge = true;
    }

    /// Bytes on DIN since the last look.
    pub fn bytes(&self) -> Vec<u8> {
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
    pub fn assert_gaps(&self) {
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
