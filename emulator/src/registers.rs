//! The register file, 00h to 0Ah, and what its fields mean.
//!
//! Family map (ADS1282, ADS1283 data sheets; ADS1281 differs in 02h, which is reserved there).

use crate::Phase;

/// Number of registers.
pub const COUNT: usize = 11;

/// Read-only identity: the upper nibble is the maker's, the lower is zero.
pub(crate) const ID: u8 = 0x00;
/// SYNC, 1, DR2..0, PHS, FILTR1..0.
pub(crate) const CONFIG0: u8 = 0x01;
/// Reserved on the ADS1281: never to be written.
pub(crate) const RESERVED: u8 = 0x02;

const HPF: usize = 0x03;
const OFC: usize = 0x05;
const FSC: usize = 0x08;

const RESET: [u8; COUNT] = [
    0x10, 0x52, 0x08, 0x32, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x40,
];

/// What the field FILTR selects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Modulator bits on M0 and M1; no words, no DRDY.
    Modulator,
    /// Sinc stage only, 32 times the data rate.
    Sinc,
    /// Sinc and FIR stages, the reset value.
    Fir,
    /// Sinc and FIR stages and high-pass filter.
    FirHighPass,
}

/// The register file of one converter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Registers {
    bytes: [u8; COUNT],
}

impl Registers {
    /// Contents of `address`; `None` beyond 0Ah.
    pub fn get(&self, address: u8) -> Option<u8> {
        self.bytes.get(usize::from(address)).copied()
    }

    /// Writes `address` if it is one that can be written.
    pub fn set(&mut self, address: u8, value: u8) {
        if address == ID || address == RESERVED {
            return;
        }
        if let Some(byte) = self.bytes.get_mut(usize::from(address)) {
            *byte = value;
        }
    }

    /// Gives the part an identity that it should not have.
    pub(crate) fn set_id(&mut self, id: u8) {
        self.bytes[usize::from(ID)] = id;
    }

    /// Back to the defaults. The identity is in silicon and stays.
    pub(crate) fn reset(&mut self) {
        let id = self.bytes[usize::from(ID)];
        *self = Self::default();
        self.set_id(id);
    }

    fn config0(&self) -> u8 {
        self.bytes[usize::from(CONFIG0)]
    }

    /// Continuous-sync mode (true) or pulse-sync.
    pub fn continuous_sync(&self) -> bool {
        self.config0() & 0x80 != 0
    }

    /// Decimation of the sinc stage, 128 to 8. The undefined settings of DR act as the fastest.
    pub fn sinc_decimation(&self) -> u32 {
        128 >> ((self.config0() >> 3) & 7).min(4)
    }

    /// Conversions a second of the FIR filter: fCLK / 4 / 32 / N (SBAS378D page 15).
    pub fn data_rate_hz(&self) -> u32 {
        32_000 / self.sinc_decimation()
    }

    /// Words a second on DOUT: 32 times the data rate when the sinc stage is read.
    pub fn word_rate_hz(&self) -> u32 {
        match self.output() {
            Output::Sinc => 32 * self.data_rate_hz(),
            _ => self.data_rate_hz(),
        }
    }

    /// Phase response of the FIR stages.
    pub fn phase(&self) -> Phase {
        if self.config0() & 4 == 0 {
            Phase::Linear
        } else {
            Phase::Minimum
        }
    }

    /// What leaves the converter.
    pub fn output(&self) -> Output {
        match self.config0() & 3 {
            0 => Output::Modulator,
            1 => Output::Sinc,
            2 => Output::Fir,
            _ => Output::FirHighPass,
        }
    }

    /// Register word of the high-pass corner.
    pub fn hpf(&self) -> u16 {
        u16::from_le_bytes([self.bytes[HPF], self.bytes[HPF + 1]])
    }

    /// Offset calibration, 24-bit two's complement.
    pub fn ofc(&self) -> i32 {
        // Left-justified first, so that the shift back extends the sign.
        let [low, middle, high] = [self.bytes[OFC], self.bytes[OFC + 1], self.bytes[OFC + 2]];
        i32::from_le_bytes([0, low, middle, high]) >> 8
    }

    /// Full-scale calibration, 24-bit unsigned; 400000h is unit gain.
    pub fn fsc(&self) -> u32 {
        u32::from_le_bytes([self.bytes[FSC], self.bytes[FSC + 1], self.bytes[FSC + 2], 0])
    }

    /// Sets the offset calibration; the value saturates at 24 bits.
    pub fn set_ofc(&mut self, ofc: i32) {
        let bytes = ofc.clamp(-(1 << 23), (1 << 23) - 1).to_le_bytes();
        self.bytes[OFC..OFC + 3].copy_from_slice(&bytes[..3]);
    }

    /// Sets the full-scale calibration; the value saturates at 24 bits.
    pub fn set_fsc(&mut self, fsc: u32) {
        let bytes = fsc.min(0xFF_FFFF).to_le_bytes();
        self.bytes[FSC..FSC + 3].copy_from_slice(&bytes[..3]);
    }
}

impl Default for Registers {
    fn default() -> Self {
        Self { bytes: RESET }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::word::FSC_UNITY;

    #[test]
    fn fields_decode_the_listed_settings() {
        let mut registers = Registers::default();
        assert_eq!(registers.data_rate_hz(), 1000);
        assert_eq!(registers.output(), Output::Fir);
        assert_eq!(registers.hpf(), 0x0332);
        assert_eq!((registers.ofc(), registers.fsc()), (0, FSC_UNITY));
        for (config0, rate) in [
            (0x42, 250),
            (0x4A, 500),
            (0x52, 1000),
            (0x5A, 2000),
            (0x62, 4000),
        ] {
            registers.set(CONFIG0, config0);
            assert_eq!(registers.data_rate_hz(), rate, "{config0:02X}h");
        }
        registers.set(CONFIG0, 0xD7);
        assert!(registers.continuous_sync());
        assert_eq!(registers.phase(), Phase::Minimum);
        assert_eq!(registers.output(), Output::FirHighPass);
        registers.set(CONFIG0, 0x51);
        assert_eq!(registers.word_rate_hz(), 32_000);
    }

    #[test]
    fn calibration_words_keep_their_sign_and_saturate() {
        let mut registers = Registers::default();
        for ofc in [-1, 1, -(1 << 23), (1 << 23) - 1] {
            registers.set_ofc(ofc);
            assert_eq!(registers.ofc(), ofc);
        }
        registers.set_ofc(i32::MAX);
        assert_eq!(registers.ofc(), (1 << 23) - 1);
        registers.set_fsc(u32::MAX);
        assert_eq!(registers.fsc(), 0xFF_FFFF);
    }

    #[test]
    fn identity_and_reserved_register_cannot_be_written() {
        let mut registers = Registers::default();
        for address in [ID, RESERVED, 0x0B, 0x1F] {
            registers.set(address, 0xFF);
        }
        assert_eq!(registers, Registers::default());
        assert_eq!(registers.get(0x0B), None);
    }
}
