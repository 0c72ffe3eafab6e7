//! The modulator's over-range behaviour, ahead of the digital filter.
//!
//! Inside +-103 % of full scale the modulator is transparent here. Beyond that it saturates
//! stably at all ones or all zeros and takes up to 12 modulator cycles to recover (SBAS378D page
//! 12). A density of ones of 90 % is full scale, so 100 % is 1.25 times full scale: that is what
//! the filter then averages.

use crate::filter::DECIMATION;

/// Full scale in steps of the 31-bit code.
pub(crate) const FULL_SCALE: i32 = 1 << 30;
/// The largest input that the modulator follows: 103 % of full scale (SBAS378D page 27).
const LIMIT: i32 = (FULL_SCALE as i64 * 103 / 100) as i32;
/// What a saturated modulator reads as.
const SATURATED: i32 = FULL_SCALE / 4 * 5;
/// Modulator cycles that recovery takes.
const RECOVERY_CYCLES: u32 = 12;

/// The modulator's memory of an overload.
#[derive(Debug, Clone, Default)]
pub(crate) struct Modulator {
    /// Inputs until recovery.
    recovering: u32,
    /// What it is stuck at until then.
    stuck_at: i32,
}

impl Modulator {
    /// Replaces the inputs that the modulator cannot follow. One input lasts `decimation` cycles.
    pub(crate) fn pass(&mut self, inputs: &mut [i32], decimation: u32) {
        let mut reach = 0;
        for &input in inputs.iter() {
            reach |= input.unsigned_abs();
        }
        // The common case at the cost of one comparison: no input needs the 31st bit.
        if reach < FULL_SCALE as u32 && self.recovering == 0 {
            return;
        }
        for input in inputs {
            if input.unsigned_abs() > LIMIT as u32 {
                self.recovering = RECOVERY_CYCLES.div_ceil(decimation);
                self.stuck_at = if *input > 0 { SATURATED } else { -SATURATED };
                *input = self.stuck_at;
            } else if self.recovering > 0 {
                self.recovering -= 1;
                *input = self.stuck_at;
            }
        }
    }
}

/// Inputs of one conversion.
pub(crate) type Block = [i32; DECIMATION];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saturates_beyond_103_percent_and_recovers_in_12_cycles() {
        let mut inputs = [0, LIMIT, LIMIT + 1, 5, 5, 5, -LIMIT - 1, 7, 7, 7];
        Modulator::default().pass(&mut inputs, 8);
        let (high, low) = (SATURATED, -SATURATED);
        assert_eq!(inputs, [0, LIMIT, high, high, high, 5, low, low, low, 7]);
        let mut inputs = [LIMIT + 1, 5, 5];
        Modulator::default().pass(&mut inputs, 16);
        assert_eq!(inputs, [high, high, 5]);
    }
}
