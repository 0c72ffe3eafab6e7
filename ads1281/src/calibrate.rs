//! Offset and gain registers, OFC and FSC.
//!
//! The part computes (SBAS378D, page 27)
//!
//! ```text
//!   word = clip32((filtered - 256 * OFC) * FSC / 400000h)
//! ```
//!
//! OFC is 24-bit two's complement, FSC 24-bit unsigned. The offset is scaled by the gain, so
//! that the order is offset first, then gain. Whether OFSCAL allows for what OFC holds already
//! is not said: both are written to their neutral value before an offset calibration, and FSC
//! before a gain calibration.

use super::register::FSC_UNITY;

/// Readings that OFSCAL and GANCAL average.
pub const AVERAGED_READINGS: u32 = 16;

/// What a converter corrects its words by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Calibration {
    /// OFC, -2^23 to 2^23 - 1, in steps of 256 of the 32-bit word.
    pub offset: i32,
    /// FSC, 0 to 2^24 - 1; 400000h is one.
    pub gain: u32,
}

impl Default for Calibration {
    fn default() -> Self {
        Self {
            offset: 0,
            gain: FSC_UNITY,
        }
    }
}

impl Calibration {
    /// From the registers 05h to 0Ah.
    pub const fn from_registers([ofc0, ofc1, ofc2]: [u8; 3], [fsc0, fsc1, fsc2]: [u8; 3]) -> Self {
        Self {
            // Left-justified and shifted back, so that bit 23 becomes the sign.
            offset: i32::from_le_bytes([0, ofc0, ofc1, ofc2]) >> 8,
            gain: u32::from_le_bytes([fsc0, fsc1, fsc2, 0]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_to_calibration() {
        let found = Calibration::from_registers([0xFE, 0xFF, 0xFF], [0x00, 0x00, 0x40]);
        assert_eq!(
            found,
            Calibration {
                offset: -2,
                gain: FSC_UNITY
            }
        );
        let found = Calibration::from_registers([0xFF, 0xFF, 0x7F], [0xFF, 0xFF, 0xFF]);
        assert_eq!(found.offset, 8_388_607);
        assert_eq!(found.gain, 16_777_215);
    }
}
