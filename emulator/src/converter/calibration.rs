//! OFSCAL and GANCAL: the part measures its input and sets its calibration registers (SBAS378D
//! page 27).

use super::Converter;
use crate::{
    Output, Rule, Signal,
    word::{CODE_MAX, FSC_UNITY},
};

/// Readings that OFSCAL and GANCAL average.
const CALIBRATION_READINGS: i64 = 16;

/// A calibration under way.
#[derive(Debug, Clone)]
pub(super) struct Calibration {
    gain: bool,
    left: i64,
    sum: i64,
}

impl<S: Signal> Converter<S> {
    pub(super) fn start_calibration(&mut self, at_ps: u64, gain: bool) {
        if self.registers.output() == Output::FirHighPass {
            self.breach(at_ps, Rule::HighPassDuringCalibration);
        }
        self.calibration = Some(Calibration {
            gain,
            left: CALIBRATION_READINGS,
            sum: 0,
        });
    }

    /// One reading into the calibration's average; the last one sets the registers.
    pub(super) fn calibrate(&mut self) {
        let Some(calibration) = &mut self.calibration else {
            return;
        };
        calibration.sum += i64::from(self.conversion.next_code(&self.registers));
        calibration.left -= 1;
        if calibration.left > 0 {
            return;
        }
        let mean = calibration.sum / CALIBRATION_READINGS;
        if calibration.gain {
            let offset = i64::from(self.registers.ofc()) << 7;
            let fsc = (CODE_MAX * i64::from(FSC_UNITY))
                .checked_div(mean - offset)
                .and_then(|fsc| u32::try_from(fsc).ok())
                .unwrap_or(u32::MAX);
            self.registers.set_fsc(fsc);
        } else {
            // OFC counts 2^8 of the 32-bit word, 2^7 of the code.
            self.registers.set_ofc(((mean + 64) >> 7) as i32);
        }
        self.calibration = None;
    }
}
