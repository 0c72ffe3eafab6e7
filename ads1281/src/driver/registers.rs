//! The registers of a converter through its interface: identity, configuration, calibration. What is
//! written is read back.

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiBus;

use super::super::calibrate::Calibration;
use super::super::command::{read_registers, write_registers};
use super::super::config::Config;
use super::super::register::{Address, REGISTERS, id_is_plausible, is_silence};
use super::{Ads1281, DataReady, Error, ResetPin};

impl<SPI, DRDY, DELAY, RESET> Ads1281<SPI, DRDY, DELAY, RESET>
where
    SPI: SpiBus<u8>,
    DRDY: DataReady,
    DELAY: DelayNs,
    RESET: ResetPin,
{
    /// All registers as a RESET leaves them: an identity that can be an ADS1281's, CONFIG1, which is
    /// reserved, and the others at their defaults. Nothing was written since the
    /// [`reset`](Self::reset). Takes about 0.2 ms at 1.3 MHz and leaves the interface stopped.
    ///
    /// # Errors
    /// [`Error::WrongId`] if the identity cannot be that of an ADS1281, or all registers read 00h
    /// or FFh: nobody is there, or not up yet. [`Error::Verify`] with the first register that is
    /// not at its default; [`Error::Bus`].
    pub fn identify(&mut self) -> Result<[u8; REGISTERS], Error<SPI::Error>> {
        self.read_verified(&Config::default())
    }

    /// Writes CONFIG0, then HPF to FSC, and reads all back. CONFIG1 is left alone.
    ///
    /// Leaves the interface stopped; [`SETTLING_READINGS`](super::super::SETTLING_READINGS) are lost, and
    /// the converters of a board need one common SYNC afterwards. Takes about 0.35 ms at 1.3 MHz.
    ///
    /// # Errors
    /// [`Error::WrongId`]; [`Error::Verify`] with the first register that does not read what
    /// was written; [`Error::Bus`].
    pub fn configure(&mut self, config: &Config) -> Result<[u8; REGISTERS], Error<SPI::Error>> {
        self.write_registers(Address::Config0, &[config.config0.bits()])?;
        self.write_registers(Address::Hpf0, &config.block())?;
        self.read_verified(config)
    }

    /// All registers, if they are those of an ADS1281 under this configuration.
    fn read_verified(&mut self, config: &Config) -> Result<[u8; REGISTERS], Error<SPI::Error>> {
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
    pub fn read_calibration(&mut self) -> Result<Calibration, Error<SPI::Error>> {
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
    pub fn read_all_registers(&mut self) -> Result<[u8; REGISTERS], Error<SPI::Error>> {
        let mut registers = [0; REGISTERS];
        self.read_registers(Address::Id, &mut registers)?;
        Ok(registers)
    }

    /// One register. Leaves the interface stopped.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn read_register(&mut self, address: Address) -> Result<u8, Error<SPI::Error>> {
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
    pub fn check_register(&mut self, address: Address) -> Result<u8, Error<SPI::Error>> {
        let value = self.read_register(address);
        self.read_continuously()?;
        self.forget_edge();
        value
    }

    #[inline(never)]
    fn read_registers(
        &mut self,
        first: Address,
        values: &mut [u8],
    ) -> Result<(), Error<SPI::Error>> {
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
    fn write_registers(&mut self, first: Address, values: &[u8]) -> Result<(), Error<SPI::Error>> {
        self.stop()?;
        for byte in write_registers(first, values.len() as u8) {
            self.send(byte)?;
        }
        for &value in values {
            self.send(value)?;
        }
        Ok(())
    }
}
