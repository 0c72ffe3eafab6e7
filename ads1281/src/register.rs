//! Register map: addresses, fields, reset values.
//!
//! The map is that of the family (ADS1282-SP data sheet and the vendor's example code) with the
//! cells of the ADS1281 as far as SBAS378D was read; CONFIG1 holds multiplexer and gain on the
//! ADS1282, is reserved here, and is never written.

use super::CLOCK_HZ;

/// Registers of the part, 00h to 0Ah.
pub const REGISTERS: usize = 11;

/// Address of a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Address {
    /// Identification: low nibble 0, high nibble factory set. Read only.
    Id = 0x00,
    /// Filter, data rate, kind of synchronisation: [`Config0`].
    Config0 = 0x01,
    /// Reserved on this part: left at its reset value.
    Config1 = 0x02,
    /// High-pass corner, low byte.
    Hpf0 = 0x03,
    /// High-pass corner, high byte.
    Hpf1 = 0x04,
    /// Offset, low byte.
    Ofc0 = 0x05,
    /// Offset, middle byte.
    Ofc1 = 0x06,
    /// Offset, high byte.
    Ofc2 = 0x07,
    /// Gain, low byte.
    Fsc0 = 0x08,
    /// Gain, middle byte.
    Fsc1 = 0x09,
    /// Gain, high byte.
    Fsc2 = 0x0A,
}

impl Address {
    /// All registers in order.
    pub const ALL: [Self; REGISTERS] = [
        Self::Id,
        Self::Config0,
        Self::Config1,
        Self::Hpf0,
        Self::Hpf1,
        Self::Ofc0,
        Self::Ofc1,
        Self::Ofc2,
        Self::Fsc0,
        Self::Fsc1,
        Self::Fsc2,
    ];

    /// Place in a table of all registers.
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Reset value of the HPF word: corner at 5e-4 of the data rate.
pub const HPF_RESET: u16 = 0x0332;

/// FSC word of gain one, the reset value.
pub const FSC_UNITY: u32 = 0x40_0000;

/// Whether nobody answers: DOUT stays low or high, as without a part or one that is not up yet.
/// CONFIG0 of a part can be neither 00h nor FFh.
pub fn is_silence(registers: &[u8; REGISTERS]) -> bool {
    *registers == [0x00; REGISTERS] || *registers == [0xFF; REGISTERS]
}

/// Whether an ID register can be that of an ADS1281: its low nibble is 0.
pub const fn id_is_plausible(id: u8) -> bool {
    id & 0x0F == 0
}

/// How SYNC acts (SBAS378D, page 21).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SyncMode {
    /// Each rising edge restarts the filter; DRDY stays high until the data have settled.
    #[default]
    Pulse,
    /// SYNC is a clock: the filter restarts only when its period does not fit. DRDY goes on
    /// and the words read zero until settled.
    Continuous,
}

/// DR field: output data rate of the FIR filter at a clock of 4.096 MHz (SBAS378D, pages 11 and 15).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Rate {
    /// 250 conversions a second.
    Sps250 = 0b000,
    /// 500 conversions a second.
    Sps500 = 0b001,
    /// 1000 conversions a second, the reset value.
    #[default]
    Sps1000 = 0b010,
    /// 2000 conversions a second.
    Sps2000 = 0b011,
    /// 4000 conversions a second.
    Sps4000 = 0b100,
}

impl Rate {
    /// All rates, slowest first.
    pub const ALL: [Self; 5] = [
        Self::Sps250,
        Self::Sps500,
        Self::Sps1000,
        Self::Sps2000,
        Self::Sps4000,
    ];

    /// Conversions a second at a clock of 4.096 MHz; at another clock in proportion.
    pub const fn hz(self) -> u32 {
        250 << self as u32
    }
}

/// PHS field: impulse response of the FIR stages (SBAS378D, page 15).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Phase {
    /// Symmetric, group delay 31 conversions.
    #[default]
    Linear = 0,
    /// Shortest delay, about 5 conversions at DC.
    Minimum = 1,
}

/// FILTR field: what leaves the converter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Output {
    /// Modulator bits, digital filter off.
    Modulator = 0b00,
    /// Sinc stage only.
    Sinc = 0b01,
    /// Sinc and FIR stages.
    #[default]
    Fir = 0b10,
    /// Sinc and FIR stages, then the high-pass.
    FirHighPass = 0b11,
}

/// CONFIG0, 01h. Default is the reset value, 52h.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config0 {
    /// SYNC, bit 7.
    pub sync: SyncMode,
    /// DR, bits 5 to 3: data rate of the FIR output.
    pub rate: Rate,
    /// PHS, bit 2: phase response of the FIR stages.
    pub phase: Phase,
    /// FILTR, bits 1 and 0.
    pub output: Output,
}

impl Default for Config0 {
    fn default() -> Self {
        Self {
            sync: SyncMode::Pulse,
            rate: Rate::Sps1000,
            phase: Phase::Linear,
            output: Output::Fir,
        }
    }
}

impl Config0 {
    /// Bit 6: MODE on the ADS1282, where 1 is high resolution; kept at its reset value of 1.
    const ALWAYS: u8 = 1 << 6;

    /// The register's value.
    pub const fn bits(self) -> u8 {
        let sync = match self.sync {
            SyncMode::Pulse => 0,
            SyncMode::Continuous => 1 << 7,
        };
        sync | Self::ALWAYS | (self.rate as u8) << 3 | (self.phase as u8) << 2 | self.output as u8
    }

    /// Words a second that leave the part, at [`CLOCK_HZ`].
    pub const fn words_hz(self) -> u32 {
        match self.output {
            // One clock in four is one of the modulator.
            Output::Modulator => CLOCK_HZ / 4,
            // The FIR stages decimate by 32.
            Output::Sinc => 32 * self.rate.hz(),
            Output::Fir | Output::FirHighPass => self.rate.hz(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The useful values of CONFIG0 as tabulated for the part, not as computed here.
    #[test]
    fn config0_matches_the_table() {
        let linear = [0x42, 0x4A, 0x52, 0x5A, 0x62];
        for (rate, expected) in Rate::ALL.into_iter().zip(linear) {
            let with = |phase, output| {
                Config0 {
                    sync: SyncMode::Pulse,
                    rate,
                    phase,
                    output,
                }
                .bits()
            };
            assert_eq!(with(Phase::Linear, Output::Fir), expected);
            assert_eq!(with(Phase::Minimum, Output::Fir), expected + 4);
            assert_eq!(with(Phase::Linear, Output::FirHighPass), expected + 1);
            assert_eq!(with(Phase::Linear, Output::Sinc), expected - 1);
            assert_eq!(with(Phase::Linear, Output::Modulator), expected - 2);
        }
        assert_eq!(Config0::default().bits(), 0x52);
        let sync = SyncMode::Continuous;
        assert_eq!(
            Config0 {
                sync,
                ..Config0::default()
            }
            .bits(),
            0xD2
        );
    }

    /// Rates of SBAS378D, page 11: the modulator's 1.024 MHz decimated by 4096 to 256.
    #[test]
    fn the_rates_are_those_of_the_decimation() {
        for (rate, decimation) in Rate::ALL.into_iter().zip([4096, 2048, 1024, 512, 256]) {
            let with = |output| {
                Config0 {
                    rate,
                    output,
                    ..Config0::default()
                }
                .words_hz()
            };
            assert_eq!(with(Output::Fir), 1_024_000 / decimation);
            assert_eq!(with(Output::Sinc), 1_024_000 / (decimation / 32));
            assert_eq!(with(Output::Modulator), 1_024_000);
        }
    }
}
