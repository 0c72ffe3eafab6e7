//! The pins beside the bus: DRDY, whose edges must not be missed, and RESET, which may be left out.

use core::convert::Infallible;

use embedded_hal::digital::{Error as _, ErrorKind, ErrorType, InputPin, OutputPin};

/// DRDY, active low: the level, and a falling edge remembered.
pub trait DataReady: InputPin {
    /// Whether the pin has fallen since the last call.
    ///
    /// The edge is latched by hardware (as in the pending register of an EXTI) or by an
    /// interrupt handler, so that an edge is seen whatever the program did meanwhile, and two
    /// count as one.
    fn take_edge(&mut self) -> bool;
}

/// DRDY without a latch: an edge is a low level where the last look saw a high one.
///
/// For a program that does nothing but look. DRDY rises at the first clock of a reading; without one it is
/// high for four clocks only, ahead of its fall (SBAS378D, pages 21 and 24). Whoever looks too rarely misses
/// words, and one that is torn is not noticed. Use the latch of an interrupt wherever words must not be lost.
#[derive(Debug)]
pub struct Polled<PIN> {
    pin: PIN,
    was_high: bool,
}

impl<PIN: InputPin> Polled<PIN> {
    /// Looks at this pin from now on; a level that is low already is no edge.
    pub fn new(pin: PIN) -> Self {
        let was_high = false;
        Self { pin, was_high }
    }
}

impl<PIN: ErrorType> ErrorType for Polled<PIN> {
    type Error = PIN::Error;
}

impl<PIN: InputPin> InputPin for Polled<PIN> {
    fn is_high(&mut self) -> Result<bool, Self::Error> {
        self.pin.is_high()
    }

    fn is_low(&mut self) -> Result<bool, Self::Error> {
        self.pin.is_low()
    }
}

impl<PIN: InputPin> DataReady for Polled<PIN> {
    /// A pin that cannot be read shows no edge; [`is_ready`](crate::Ads1281::is_ready) tells the error.
    fn take_edge(&mut self) -> bool {
        let is_high = self.pin.is_high().unwrap_or(false);
        core::mem::replace(&mut self.was_high, is_high) && !is_high
    }
}

/// The RESET pin of a part, wired or not: [`Wired`] or [`NoReset`], chosen by
/// [`with_reset`](crate::Ads1281::with_reset).
pub trait ResetPin {
    /// Whether there is one.
    const WIRED: bool;

    /// Pulls it `low`, or lets it be high.
    ///
    /// # Errors
    /// What kind of error the pin reports.
    fn drive(&mut self, low: bool) -> Result<(), ErrorKind>;
}

/// RESET is tied high: the part is reset by command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NoReset;

impl ResetPin for NoReset {
    const WIRED: bool = false;

    fn drive(&mut self, _: bool) -> Result<(), ErrorKind> {
        Ok::<(), Infallible>(()).map_err(|never| never.kind())
    }
}

/// RESET is wired to this output, active low.
#[derive(Debug)]
pub struct Wired<PIN>(pub PIN);

impl<PIN: OutputPin> ResetPin for Wired<PIN> {
    const WIRED: bool = true;

    fn drive(&mut self, low: bool) -> Result<(), ErrorKind> {
        let done = if low {
            self.0.set_low()
        } else {
            self.0.set_high()
        };
        done.map_err(|error| error.kind())
    }
}
