//! The rules that the part sets its driver, and a breach of one.

use core::fmt;

/// A rule of the ADS1281. Page numbers are those of SBAS378D.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rule {
    /// SCLK within 2^16 clocks of power-on.
    PowerOn,
    /// SCLK faster than fCLK/2.
    SclkTooFast,
    /// Less than 24/fCLK after a byte of a command (page 30).
    CommandGap,
    /// A byte on DIN that is no command; DIN is decoded during data reads as well.
    UnknownCommand(u8),
    /// Register access, RDATA or a calibration without SDATAC first (page 30).
    NotStopped,
    /// A write to the identity register.
    ReadOnlyRegister,
    /// A write to 02h, which is reserved on the ADS1281.
    ReservedRegister,
    /// Register access beyond 0Ah.
    RegisterRange {
        /// First register.
        address: u8,
        /// Number of registers.
        count: u8,
    },
    /// CONFIG0 written with bit 6 clear; it must be 1.
    FixedBit,
    /// CONFIG0 written with DR = 101..111, which are not defined.
    UndefinedRate,
    /// DIN not zero while a register is read.
    DinDuringRead(u8),
    /// Clocked after RDATA, before DRDY fell.
    RdataBeforeReady,
    /// OFSCAL or GANCAL with the high-pass filter on (page 27).
    HighPassDuringCalibration,
    /// SYNC pin low or high for less than 2/fCLK.
    SyncPulse,
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::PowerOn => f.write_str("clocked within 2^16 clocks of power-on; wait 16 ms"),
            Self::SclkTooFast => f.write_str("SCLK faster than fCLK/2 = 2.048 MHz"),
            Self::CommandGap => {
                f.write_str("less than 24/fCLK = 5.86 us after a byte of a command")
            }
            Self::UnknownCommand(byte) => write!(f, "no command: {byte:02X}h on DIN"),
            Self::NotStopped => f.write_str(
                "registers, RDATA and calibration need SDATAC first: the part is in read-continuous mode",
            ),
            Self::ReadOnlyRegister => f.write_str("write to the identity register 00h"),
            Self::ReservedRegister => f.write_str("write to the reserved register 02h"),
            Self::RegisterRange { address, count } => {
                write!(f, "{count} registers from {address:02X}h on reach beyond 0Ah")
            }
            Self::FixedBit => f.write_str("bit 6 of CONFIG0 must be written as 1"),
            Self::UndefinedRate => f.write_str("DR = 101..111 in CONFIG0 is not defined"),
            Self::DinDuringRead(byte) => {
                write!(f, "{byte:02X}h on DIN while a register is read; keep DIN low")
            }
            Self::RdataBeforeReady => f.write_str("data clocked after RDATA before DRDY fell"),
            Self::HighPassDuringCalibration => {
                f.write_str("calibration with the high-pass filter on")
            }
            Self::SyncPulse => f.write_str("SYNC pin changed within 2/fCLK of its last change"),
        }
    }
}

/// A breach of a rule: what, where and when.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Violation {
    /// Time of the breach, picoseconds.
    pub at_ps: u64,
    /// Converter concerned, 0 to 2.
    pub axis: usize,
    /// The rule.
    pub rule: Rule,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let us = self.at_ps / 1_000_000;
        write!(f, "ADS1281 {} at {us} us: {}", self.axis, self.rule)
    }
}
