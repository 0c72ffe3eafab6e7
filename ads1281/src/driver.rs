//! One converter on its own bus: the modes of its interface, commands, and words.

mod registers;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::Error as _;
use embedded_hal::spi::SpiBus;

use super::command::Command;
use super::pins::{DataReady, NoReset, ResetPin, Wired};
use super::word::{Reading, Word};
use super::{Error, GAP_NS, RESET_PULSE_US, UPDATE_LEAD_NS};

/// What the serial interface does with a clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Not known: after power on and RESET. The sources disagree on which mode it leaves.
    Unknown,
    /// Data come without being asked for.
    Continuous,
    /// Registers can be reached.
    Stopped,
    /// One word was asked for and has not been read.
    Requested,
}

/// One converter on its own bus, with its RESET pin wired or not.
#[derive(Debug)]
pub struct Ads1281<SPI, DRDY, DELAY, RESET = NoReset> {
    spi: SPI,
    drdy: DRDY,
    delay: DELAY,
    reset: RESET,
    mode: Mode,
}

impl<SPI, DRDY, DELAY> Ads1281<SPI, DRDY, DELAY> {
    /// Takes the bus and the pin of a part whose RESET pin is tied high. Nothing is sent and so
    /// nothing can fail; the first thing to do is a [`reset`](Self::reset).
    pub fn new(spi: SPI, drdy: DRDY, delay: DELAY) -> Self {
        Self {
            spi,
            drdy,
            delay,
            reset: NoReset,
            mode: Mode::Unknown,
        }
    }

    /// The same part with its RESET pin wired to `pin`, which should be high: [`reset`](Self::reset)
    /// pulls it low, and then realigns a shifted interface, too.
    pub fn with_reset<PIN>(self, pin: PIN) -> Ads1281<SPI, DRDY, DELAY, Wired<PIN>> {
        Ads1281 {
            spi: self.spi,
            drdy: self.drdy,
            delay: self.delay,
            reset: Wired(pin),
            mode: self.mode,
        }
    }
}

impl<SPI, DRDY, DELAY, RESET> Ads1281<SPI, DRDY, DELAY, RESET>
where
    SPI: SpiBus<u8>,
    DRDY: DataReady,
    DELAY: DelayNs,
    RESET: ResetPin,
{
    /// Gives bus, pin and delay back; RESET, if it is wired, stays as it is.
    pub fn release(self) -> (SPI, DRDY, DELAY) {
        (self.spi, self.drdy, self.delay)
    }

    /// What the interface does with a clock.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// RESET, by pin where it is wired, else by command: registers to their default. Wait
    /// [`RESET_US`](super::RESET_US) before the next call.
    ///
    /// # Errors
    /// [`Error::Bus`]; [`Error::Pin`] if the pin cannot be driven.
    pub fn reset(&mut self) -> Result<(), Error<SPI::Error>> {
        self.mode = Mode::Unknown;
        if RESET::WIRED {
            self.reset.drive(true).map_err(Error::Pin)?;
            self.delay.delay_us(RESET_PULSE_US);
            self.reset.drive(false).map_err(Error::Pin)?;
        } else {
            self.command(Command::Reset)?;
        }
        self.forget_edge();
        Ok(())
    }

    /// STANDBY: stops converting, keeps the registers.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn standby(&mut self) -> Result<(), Error<SPI::Error>> {
        self.stop()?;
        self.command(Command::Standby)
    }

    /// WAKEUP: leaves stand-by.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn wakeup(&mut self) -> Result<(), Error<SPI::Error>> {
        self.stop()?;
        self.command(Command::Wakeup)
    }

    /// SYNC by command, where the pin is not wired. Drops [`SETTLING_READINGS`](super::SETTLING_READINGS).
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn synchronise(&mut self) -> Result<(), Error<SPI::Error>> {
        self.stop()?;
        self.command(Command::Sync)?;
        self.forget_edge();
        Ok(())
    }

    /// OFSCAL. The converter must have settled with its input at zero and the high-pass off;
    /// the result stands in OFC at the next edge of DRDY, with the interface in continuous
    /// mode until then.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn calibrate_offset(&mut self) -> Result<(), Error<SPI::Error>> {
        self.calibrate(Command::OffsetCalibration)
    }

    /// GANCAL. The converter must have settled with its input at positive full scale; the
    /// result stands in FSC at the next edge of DRDY.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn calibrate_gain(&mut self) -> Result<(), Error<SPI::Error>> {
        self.calibrate(Command::GainCalibration)
    }

    fn calibrate(&mut self, command: Command) -> Result<(), Error<SPI::Error>> {
        self.stop()?;
        self.command(command)?;
        self.forget_edge();
        self.read_continuously()
    }

    /// RDATAC: from the next edge of DRDY on, each word can be [read](Self::read).
    ///
    /// # Errors
    /// [`Error::Bus`].
    #[inline(never)]
    pub fn read_continuously(&mut self) -> Result<(), Error<SPI::Error>> {
        if self.mode != Mode::Continuous {
            self.command(Command::ReadContinuous)?;
            self.mode = Mode::Continuous;
        }
        Ok(())
    }

    /// SDATAC, unless the interface has stopped already.
    ///
    /// # Errors
    /// [`Error::Bus`].
    #[inline(never)]
    pub fn stop(&mut self) -> Result<(), Error<SPI::Error>> {
        if self.mode != Mode::Stopped {
            // Whatever was clocked before may have been a word.
            self.gap();
            self.command(Command::StopContinuous)?;
            self.mode = Mode::Stopped;
        }
        Ok(())
    }

    /// RDATA: asks for one word, to be [read](Self::read) after the next edge of DRDY.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn request(&mut self) -> Result<(), Error<SPI::Error>> {
        self.stop()?;
        self.command(Command::ReadData)?;
        self.forget_edge();
        self.mode = Mode::Requested;
        Ok(())
    }

    /// Reads the word of a new conversion; `None` if DRDY has not fallen since the last one.
    ///
    /// # Errors
    /// As for [`read`](Self::read).
    pub fn take_new(&mut self) -> Result<Option<Reading>, Error<SPI::Error>> {
        if self.take_edge() {
            self.read().map(Some)
        } else {
            Ok(None)
        }
    }

    /// Clocks one word out. Must end 4 clocks (1 us) before the next edge of DRDY; the reading
    /// says if it did not. The word of that edge is lost then, too: part of it has been shifted
    /// out already.
    ///
    /// # Errors
    /// [`Error::Mode`] unless in continuous mode or after [`request`](Self::request);
    /// [`Error::Bus`].
    pub fn read(&mut self) -> Result<Reading, Error<SPI::Error>> {
        match self.mode {
            Mode::Continuous => {}
            Mode::Requested => self.mode = Mode::Stopped,
            Mode::Unknown | Mode::Stopped => return Err(Error::Mode),
        }
        self.take_edge();
        // DIN is decoded even now: it must stay low.
        let mut bytes = [0; 4];
        self.spi.transfer_in_place(&mut bytes).map_err(Error::Bus)?;
        self.spi.flush().map_err(Error::Bus)?;
        // The word is replaced this long ahead of the edge that tells.
        self.delay.delay_ns(UPDATE_LEAD_NS);
        Ok(Reading {
            word: Word::from_bytes(bytes),
            torn: self.take_edge(),
        })
    }

    /// Whether DRDY has fallen since the last call and the last reading.
    pub fn take_edge(&mut self) -> bool {
        self.drdy.take_edge()
    }

    /// Drops an edge of a word that nobody wants.
    pub fn forget_edge(&mut self) {
        self.take_edge();
    }

    /// Whether DRDY is low.
    ///
    /// # Errors
    /// [`Error::Pin`].
    pub fn is_ready(&mut self) -> Result<bool, Error<SPI::Error>> {
        self.drdy.is_low().map_err(|error| Error::Pin(error.kind()))
    }

    fn command(&mut self, command: Command) -> Result<(), Error<SPI::Error>> {
        self.send(command.opcode()).map(drop)
    }

    /// Exchanges one byte of a command and keeps the gap after it. Once in the image for all who
    /// call it: beside the gap a call takes no time.
    #[inline(never)]
    fn send(&mut self, byte: u8) -> Result<u8, Error<SPI::Error>> {
        let mut buffer = [byte];
        let result = self.spi.transfer_in_place(&mut buffer);
        // The gap counts from the last clock, which may be still to come when a buffered bus
        // returns; and it is kept after a fault too.
        let result = result.and(self.spi.flush());
        self.gap();
        result.map_err(Error::Bus)?;
        Ok(buffer[0])
    }

    /// Waits.
    pub fn pause_us(&mut self, micros: u32) {
        self.delay.delay_us(micros);
    }

    fn gap(&mut self) {
        self.delay.delay_ns(GAP_NS);
    }
}
