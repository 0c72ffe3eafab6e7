//! All that is written to a converter, as its register words.

use super::calibrate::Calibration;
use super::register::{Address, Config0, HPF_RESET, REGISTERS};

/// Everything that is written to a converter. Default is what a RESET leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config {
    /// CONFIG0, 01h.
    pub config0: Config0,
    /// HPF, 03h and 04h.
    pub high_pass: u16,
    /// OFC and FSC, 05h to 0Ah.
    pub calibration: Calibration,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            config0: Config0::default(),
            high_pass: HPF_RESET,
            calibration: Calibration::default(),
        }
    }
}

impl Config {
    /// Registers of the block 03h to 0Ah.
    pub const BLOCK: usize = 8;

    /// Registers 03h to 0Ah, in order.
    pub const fn block(&self) -> [u8; Self::BLOCK] {
        let [hpf0, hpf1] = self.high_pass.to_le_bytes();
        let [ofc0, ofc1, ofc2, _] = self.calibration.offset.to_le_bytes();
        let [fsc0, fsc1, fsc2, _] = self.calibration.gain.to_le_bytes();
        [hpf0, hpf1, ofc0, ofc1, ofc2, fsc0, fsc1, fsc2]
    }

    /// What a register must read; `None` for those that are not written, 00h and 02h.
    pub fn expected(&self, address: Address) -> Option<u8> {
        match address {
            Address::Id | Address::Config1 => None,
            Address::Config0 => Some(self.config0.bits()),
            _ => self
                .block()
                .get(address.index() - Address::Hpf0.index())
                .copied(),
        }
    }

    /// First register that differs from what was written, with what it reads.
    pub fn difference(&self, registers: &[u8; REGISTERS]) -> Option<(Address, u8, u8)> {
        Address::ALL.into_iter().find_map(|address| {
            let wrote = self.expected(address)?;
            let found = *registers.get(address.index())?;
            (wrote != found).then_some((address, wrote, found))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_block_is_little_endian() {
        let config = Config {
            high_pass: 0x0332,
            calibration: Calibration {
                offset: -2,
                gain: 0x40_1234,
            },
            ..Config::default()
        };
        assert_eq!(
            config.block(),
            [0x32, 0x03, 0xFE, 0xFF, 0xFF, 0x34, 0x12, 0x40]
        );
        assert_eq!(config.expected(Address::Ofc2), Some(0xFF));
        assert_eq!(config.expected(Address::Config1), None);
    }
}
