//! Driver of the ADS1281, a 31-bit delta-sigma converter (Texas Instruments, SBAS378D).
//!
//! ```text
//!   command   opcodes        register   addresses and fields     config  settings to registers
//!   word      one reading    calibrate  OFC and FSC
//!   slip      the level jumped by two, word by word or (slip_mean) under much noise
//! ```
//!
//! The part has no CS: every clock counts, nothing realigns a shifted stream but its RESET pin
//! or 64 data periods without a clock, and a command in the wrong mode is lost without a word.
//! The driver therefore owns its bus, knows the mode, keeps the gap of 24 clocks after every
//! byte of a command, leaves read-continuous mode before it touches a register, and reads back
//! what it wrote.
//!
//! On the emulator's bench; on the board bus, pin and delay are the chip's.
//!
//! ```
//! use embedded_hal::delay::DelayNs;
//! use inm_emulator::{Bench, Constant, Converter};
//! use inm_firmware::ads1281::{Ads1281, POWER_UP_US};
//!
//! let bench = Bench::new([0, 1, 2].map(|axis| Converter::new(Constant(1000 * axis))));
//! let mut converter = Ads1281::new(bench.spi(2), bench.drdy(2), bench.delay());
//! bench.delay().delay_us(POWER_UP_US);
//! converter.reset()?;
//! converter.read_continuously()?;
//! converter.forget_edge();
//! bench.run_until_edge(2, u64::MAX).expect("a conversion within 64 ms");
//! let reading = converter.read()?;
//! assert_eq!(reading.word.value(), 2000);
//! assert!(!reading.torn);
//! # Ok::<(), inm_firmware::ads1281::Error>(())
//! ```

pub mod calibrate;
pub mod command;
pub mod config;
mod error;
pub mod register;
pub mod slip;
pub mod slip_mean;
pub mod word;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::InputPin;
use embedded_hal::spi::SpiBus;
use inm_protocol::REGISTERS;

use calibrate::Calibration;
use command::{Command, read_registers, write_registers};
use config::Config;
pub use error::Error;
use register::{Address, id_is_plausible, is_silence};
use word::{Reading, Word};

/// Clock of the converter, hertz: the highest it allows, on which its data rates are stated.
pub const CLOCK_HZ: u32 = 4_096_000;

/// Pause after each byte of a command, nanoseconds: 24 clocks (SBAS378D, page 30), rounded up.
pub const GAP_NS: u32 = 5_860;

/// The converter puts the next word into its output register this long before DRDY falls,
/// nanoseconds: 4 clocks (SBAS378D, page 24), rounded up.
pub const UPDATE_LEAD_NS: u32 = 980;

/// Pause after RESET before the next command, microseconds. Two clocks are asked for; this
/// leaves the part time to load its registers.
pub const RESET_US: u32 = 1_000;

/// From power on until the part listens, microseconds: 2^16 clocks, rounded up.
pub const POWER_UP_US: u32 = 20_000;

/// Readings interrupted by SYNC, by RESET and by every register write (SBAS378D, page 21).
pub const SETTLING_READINGS: u32 = 63;

/// Data periods without a clock after which the serial interface starts a new byte: 64, and
/// two for the phase.
pub const IDLE_READINGS: u32 = 66;

/// DRDY, active low: the level, and a falling edge remembered.
pub trait DataReady: InputPin {
    /// Whether the pin has fallen since the last call.
    ///
    /// The edge is latched by hardware (as in the pending register of an EXTI) or by an
    /// interrupt handler, so that an edge is seen whatever the program did meanwhile, and two
    /// count as one.
    fn take_edge(&mut self) -> bool;
}

/// What the serial interface does with a clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
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

/// One converter on its own bus.
#[derive(Debug)]
pub struct Ads1281<SPI, DRDY, DELAY> {
    spi: SPI,
    drdy: DRDY,
    delay: DELAY,
    mode: Mode,
}

impl<SPI, DRDY, DELAY> Ads1281<SPI, DRDY, DELAY>
where
    SPI: SpiBus<u8>,
    DRDY: DataReady,
    DELAY: DelayNs,
{
    /// Takes the bus and the pin. Nothing is sent and so nothing can fail; the first thing to
    /// do is a [`reset`](Self::reset).
    pub fn new(spi: SPI, drdy: DRDY, delay: DELAY) -> Self {
        Self {
            spi,
            drdy,
            delay,
            mode: Mode::Unknown,
        }
    }

    /// Gives bus, pin and delay back.
    pub fn release(self) -> (SPI, DRDY, DELAY) {
        (self.spi, self.drdy, self.delay)
    }

    /// What the interface does with a clock.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// RESET: registers to their default. Wait [`RESET_US`] before the next call.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn reset(&mut self) -> Result<(), Error> {
        self.mode = Mode::Unknown;
        self.command(Command::Reset)?;
        self.forget_edge();
        Ok(())
    }

    /// STANDBY: stops converting, keeps the registers.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn standby(&mut self) -> Result<(), Error> {
        self.stop()?;
        self.command(Command::Standby)
    }

    /// WAKEUP: leaves stand-by.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn wakeup(&mut self) -> Result<(), Error> {
        self.stop()?;
        self.command(Command::Wakeup)
    }

    /// SYNC by command, where the pin is not wired. Drops [`SETTLING_READINGS`].
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn synchronise(&mut self) -> Result<(), Error> {
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
    pub fn calibrate_offset(&mut self) -> Result<(), Error> {
        self.calibrate(Command::OffsetCalibration)
    }

    /// GANCAL. The converter must have settled with its input at positive full scale; the
    /// result stands in FSC at the next edge of DRDY.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn calibrate_gain(&mut self) -> Result<(), Error> {
        self.calibrate(Command::GainCalibration)
    }

    fn calibrate(&mut self, command: Command) -> Result<(), Error> {
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
    pub fn read_continuously(&mut self) -> Result<(), Error> {
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
    pub fn stop(&mut self) -> Result<(), Error> {
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
    pub fn request(&mut self) -> Result<(), Error> {
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
    pub fn take_new(&mut self) -> Result<Option<Reading>, Error> {
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
    pub fn read(&mut self) -> Result<Reading, Error> {
        match self.mode {
            Mode::Continuous => {}
            Mode::Requested => self.mode = Mode::Stopped,
            Mode::Unknown | Mode::Stopped => return Err(Error::Mode),
        }
        self.take_edge();
        // DIN is decoded even now: it must stay low.
        let mut bytes = [0; 4];
        self.spi.transfer_in_place(&mut bytes).map_err(Error::bus)?;
        self.spi.flush().map_err(Error::bus)?;
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
    pub fn is_ready(&mut self) -> Result<bool, Error> {
        self.drdy.is_low().map_err(|_| Error::Pin)
    }

    /// All registers as a RESET leaves them: an identity that can be an ADS1281's, CONFIG1, which is
    /// reserved, and the others at their defaults. Nothing was written since the
    /// [`reset`](Self::reset). Takes about 0.2 ms at 1.3 MHz and leaves the interface stopped.
    ///
    /// # Errors
    /// [`Error::WrongId`] if the identity cannot be that of an ADS1281, or all registers read 00h
    /// or FFh: nobody is there, or not up yet. [`Error::Verify`] with the first register that is
    /// not at its default; [`Error::Bus`].
    pub fn identify(&mut self) -> Result<[u8; REGISTERS], Error> {
        self.read_verified(&Config::default())
    }

    /// Writes CONFIG0, then HPF to FSC, and reads all back. CONFIG1 is left alone.
    ///
    /// Leaves the interface stopped; [`SETTLING_READINGS`] are lost, and the converters of a
    /// board need one common SYNC afterwards. Takes about 0.35 ms at 1.3 MHz.
    ///
    /// # Errors
    /// [`Error::WrongId`]; [`Error::Verify`] with the first register that does not read what
    /// was written; [`Error::Bus`].
    pub fn configure(&mut self, config: &Config) -> Result<[u8; REGISTERS], Error> {
        self.write_registers(Address::Config0, &[config.config0.bits()])?;
        self.write_registers(Address::Hpf0, &config.block())?;
        self.read_verified(config)
    }

    /// All registers, if they are those of an ADS1281 under this configuration.
    fn read_verified(&mut self, config: &Config) -> Result<[u8; REGISTERS], Error> {
        let registers = self.read_all_registers()?;
        let [found, ..] = registers;
        if !id_is_plausible(found) || is_silence(&registers) {
            return Err(Error::WrongId { found });
        }
        match config.difference(&registers) {
            None => Ok(registers),
            Some((address, wrote, found)) => Err(Error::Verify {
                address,
                wrote,
                found,
            }),
        }
    }

    /// OFC and FSC as they stand. Leaves the interface stopped.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn read_calibration(&mut self) -> Result<Calibration, Error> {
        let mut ofc = [0; 3];
        let mut fsc = [0; 3];
        self.read_registers(Address::Ofc0, &mut ofc)?;
        self.read_registers(Address::Fsc0, &mut fsc)?;
        Ok(Calibration::from_registers(ofc, fsc))
    }

    /// Registers 00h to 0Ah. Leaves the interface stopped.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn read_all_registers(&mut self) -> Result<[u8; REGISTERS], Error> {
        let mut registers = [0; REGISTERS];
        self.read_registers(Address::Id, &mut registers)?;
        Ok(registers)
    }

    /// One register. Leaves the interface stopped.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn read_register(&mut self, address: Address) -> Result<u8, Error> {
        let mut value = [0];
        self.read_registers(address, &mut value)?;
        Ok(value[0])
    }

    /// One register between two conversions: SDATAC, RREG, RDATAC, about 70 us at 1.3 MHz.
    ///
    /// The word of the last conversion should have been read. That of a conversion that ends
    /// meanwhile is lost: the interface does not take it in while it is stopped.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn check_register(&mut self, address: Address) -> Result<u8, Error> {
        let value = self.read_register(address);
        self.read_continuously()?;
        self.forget_edge();
        value
    }

    #[inline(never)]
    fn read_registers(&mut self, first: Address, values: &mut [u8]) -> Result<(), Error> {
        self.stop()?;
        for byte in read_registers(first, values.len() as u8) {
            self.send(byte)?;
        }
        for value in values {
            *value = self.send(0)?;
        }
        Ok(())
    }

    #[inline(never)]
    fn write_registers(&mut self, first: Address, values: &[u8]) -> Result<(), Error> {
        self.stop()?;
        for byte in write_registers(first, values.len() as u8) {
            self.send(byte)?;
        }
        for &value in values {
            self.send(value)?;
        }
        Ok(())
    }

    fn command(&mut self, command: Command) -> Result<(), Error> {
        self.send(command.opcode()).map(drop)
    }

    /// Exchanges one byte of a command and keeps the gap after it. Once in the image for all who
    /// call it: beside the gap a call takes no time.
    #[inline(never)]
    fn send(&mut self, byte: u8) -> Result<u8, Error> {
        let mut buffer = [byte];
        let result = self.spi.transfer_in_place(&mut buffer);
        // The gap counts from the last clock, which may be still to come when a buffered bus
        // returns; and it is kept after a fault too.
        let result = result.and(self.spi.flush());
        self.gap();
        result.map_err(Error::bus)?;
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
