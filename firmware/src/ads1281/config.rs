//! From settings and calibration to the register words of a converter.

use inm_protocol::{Filter, Phase, REGISTERS, Settings};

use super::calibrate::Calibration;
use super::register::{Address, Config0, HPF_RESET, Output, SyncMode};

/// Everything that is written to a converter. Default is what a RESET leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
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

    /// The configuration for `settings`. Synchronisation is by pulse: the three converters
    /// share their clock, one edge aligns them for good.
    pub const fn new(settings: Settings, calibration: Calibration) -> Self {
        let (phase, output, high_pass) = match settings.filter {
            Filter::Modulator => (Phase::Linear, Output::Modulator, HPF_RESET),
            Filter::Sinc => (Phase::Linear, Output::Sinc, HPF_RESET),
            Filter::Fir {
                phase,
                high_pass: None,
            } => (phase, Output::Fir, HPF_RESET),
            Filter::Fir {
                phase,
                high_pass: Some(word),
            } => (phase, Output::FirHighPass, word),
        };
        Self {
            config0: Config0 {
                sync: SyncMode::Pulse,
                rate: settings.rate,
                phase,
                output,
            },
            high_pass,
            calibration,
        }
    }

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

/// Words a second that leave a converter under these settings, at [`CLOCK_HZ`](super::CLOCK_HZ).
pub const fn conversions_hz(settings: Settings) -> u32 {
    match settings.filter {
        Filter::Modulator => super::CLOCK_HZ / 4,
        Filter::Sinc => 32 * settings.rate.hz(),
        Filter::Fir { .. } => settings.rate.hz(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inm_protocol::Rate;

    /// The useful values of CONFIG0 as tabulated for the part, not as computed here.
    #[test]
    fn config0_matches_the_table() {
        let linear = [0x42, 0x4A, 0x52, 0x5A, 0x62];
        for (rate, expected) in Rate::ALL.into_iter().zip(linear) {
            let with = |filter| {
                Config::new(Settings { rate, filter }, Calibration::default())
                    .config0
                    .bits()
            };
            let fir = |phase, high_pass| Filter::Fir { phase, high_pass };
            assert_eq!(with(fir(Phase::Linear, None)), expected);
            assert_eq!(with(fir(Phase::Minimum, None)), expected + 4);
            assert_eq!(with(fir(Phase::Linear, Some(0x19A))), expected + 1);
            assert_eq!(with(Filter::Sinc), expected - 1);
            assert_eq!(with(Filter::Modulator), expected - 2);
        }
        assert_eq!(Config0::default().bits(), 0x52);
    }

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
