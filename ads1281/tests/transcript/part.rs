//! Registers of a part, and what passes as they are written and read.

use ads1281::calibrate::Calibration;
use ads1281::config::Config;
use ads1281::register::{Config0, Rate};

/// How the part is configured here, all of it other than it comes out of a reset.
pub const CONFIG: fn() -> Config = || {
    let calibration = Calibration {
        offset: -5,
        gain: 0x41_2345,
    };
    let config0 = Config0 {
        rate: Rate::Sps2000,
        ..Config0::default()
    };
    Config {
        config0,
        calibration,
        ..Config::default()
    }
};

/// 00h to 0Ah as they must read with [`CONFIG`] written: ID of some part, 2000/s linear, the
/// reserved byte, HPF at reset, OFC, FSC.
pub const REGISTERS: [u8; 11] = [
    0x10, 0x5A, 0x08, 0x32, 0x03, 0xFB, 0xFF, 0xFF, 0x45, 0x23, 0x41,
];

/// SDATAC, WREG of one register, WREG of eight, RREG of eleven.
#[rustfmt::skip]
pub const CONFIGURE: [u8; 27] = [
    0x11,
    0x41, 0x00, 0x5A,
    0x43, 0x07, 0x32, 0x03, 0xFB, 0xFF, 0xFF, 0x45, 0x23, 0x41,
    0x20, 0x0A, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
];

/// 00h to 0Ah of some part after RESET, as tabulated for the family.
pub const DEFAULTS: [u8; 11] = [
    0x10, 0x52, 0x08, 0x32, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x40,
];

/// SDATAC, RREG of eleven.
pub const IDENTIFY: [u8; 14] = [0x11, 0x20, 0x0A, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];

/// What DOUT shows meanwhile.
pub fn identify_answers(registers: [u8; 11]) -> Vec<u8> {
    let mut dout = vec![0xA5; IDENTIFY.len() - registers.len()];
    dout.extend(registers);
    dout
}

/// What DOUT shows meanwhile: the registers, after the two bytes of RREG.
pub fn configure_answers(registers: [u8; 11]) -> Vec<u8> {
    let mut dout = vec![0xA5; CONFIGURE.len() - registers.len()];
    dout.extend(registers);
    dout
}
