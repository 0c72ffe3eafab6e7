//! From the filter's output to the word on DOUT: calibration, clipping, the redundant sign bit.
//!
//! The 32-bit word holds the 31-bit code in its upper bits; the lowest repeats the sign, except
//! in a clipped word, where it is the opposite (SBAS378D page 24).

use crate::Registers;

/// Largest 31-bit code, +VREF/2.
pub const CODE_MAX: i64 = (1 << 30) - 1;
/// Smallest 31-bit code, -VREF/2 and one step.
pub const CODE_MIN: i64 = -(1 << 30);

/// FSC of unit gain (SBAS378D page 27).
pub const FSC_UNITY: u32 = 0x40_0000;

/// Word of a code that passed the FIR stages.
pub fn fir_word(code: i64) -> u32 {
    if code > CODE_MAX {
        0x7FFF_FFFF
    } else if code < CODE_MIN {
        0x8000_0000
    } else {
        ((code as u32) << 1) | u32::from(code < 0)
    }
}

/// Word of a code that passed the sinc stage alone: half scale, no redundant bit, 6 dB of
/// head-room.
pub fn sinc_word(code: i64) -> u32 {
    code.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as u32
}

/// `(in - OFC * 256) * FSC / 400000h` (SBAS378D page 27), where OFC counts 2^8 of the 32-bit word.
///
/// Code in, code out, not yet clipped: an offset may bring an input beyond full scale back into
/// range.
pub fn calibrated(code: i32, registers: &Registers) -> i64 {
    let offset = i64::from(registers.ofc()) << 7;
    ((i64::from(code) - offset) * i64::from(registers.fsc())) >> 22
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_table() {
        assert_eq!(fir_word(CODE_MAX + 1), 0x7FFF_FFFF);
        assert_eq!(fir_word(CODE_MAX), 0x7FFF_FFFE);
        assert_eq!(fir_word(0), 0);
        assert_eq!(fir_word(-1), 0xFFFF_FFFF);
        assert_eq!(fir_word(CODE_MIN), 0x8000_0001);
        assert_eq!(fir_word(CODE_MIN - 1), 0x8000_0000);
        assert_eq!(sinc_word(CODE_MAX), 0x3FFF_FFFF);
        assert_eq!(sinc_word(-1), 0xFFFF_FFFF);
        assert_eq!(sinc_word(CODE_MIN), 0xC000_0000);
    }

    #[test]
    fn calibration_takes_the_offset_first_and_scales_it_too() {
        let mut registers = Registers::default();
        registers.set_ofc(2);
        assert_eq!(calibrated(1000, &registers), 1000 - 256);
        registers.set_fsc(0x80_0000);
        assert_eq!(calibrated(1000, &registers), 2 * (1000 - 256));
        registers.set_ofc(-(1 << 23));
        registers.set_fsc(0x20_0000);
        assert_eq!(calibrated(0, &registers), 1 << 29);
        // The most that the registers can make of an input: no overflow.
        registers.set_fsc(0xFF_FFFF);
        assert_eq!(fir_word(calibrated(i32::MAX, &registers)), 0x7FFF_FFFF);
    }
}
