//! Whether a board that was found is the one that the recording is of.

use inm_protocol::{AXES, Identity, REGISTERS};

use super::BoardSource;
use crate::link::{LinkError, axis_name};

/// First register of the calibration words: OFC0 to OFC2 and FSC0 to FSC2 follow each other.
const CALIBRATION: usize = 5;

impl BoardSource {
    /// Refuses a board whose samples would mean something else. Its range can be selected again.
    pub(super) fn check_identity(&self, found: &Identity) -> Result<(), LinkError> {
        let recorded = &self.identity;
        let what = if found.serial != recorded.serial {
            let [found, recorded] = [found, recorded].map(|one| {
                let words = one.serial.map(|word| format!("{word:08x}"));
                words.concat()
            });
            differs("serial number", &found, &recorded)
        } else if found.firmware != recorded.firmware || found.platform != recorded.platform {
            let [found, recorded] =
                [found, recorded].map(|one| format!("{} for {}", one.firmware, one.platform));
            differs("firmware", &found, &recorded)
        } else if found.converter_clock_hz != recorded.converter_clock_hz {
            differs(
                "converter clock, Hz,",
                &found.converter_clock_hz,
                &recorded.converter_clock_hz,
            )
        } else if found.timer_hz != recorded.timer_hz {
            differs("timer, Hz,", &found.timer_hz, &recorded.timer_hz)
        } else if found.reference_uv != recorded.reference_uv {
            differs(
                "reference, uV,",
                &found.reference_uv,
                &recorded.reference_uv,
            )
        } else if found.sensor_supply_uv != recorded.sensor_supply_uv {
            differs(
                "sensor supply, uV,",
                &found.sensor_supply_uv,
                &recorded.sensor_supply_uv,
            )
        } else {
            return Ok(());
        };
        Err(self.other(what))
    }

    /// Refuses a board that has lost, or got, a calibration: the scale of its samples changed.
    pub(super) fn check_calibration(
        &self,
        found: &[[u8; REGISTERS]; AXES],
    ) -> Result<(), LinkError> {
        let recorded = &self.header.registers;
        for (axis, (found, recorded)) in (0..).zip(found.iter().zip(recorded)) {
            let [found, recorded] = [found, recorded].map(|all| &all[CALIBRATION..]);
            if found != recorded {
                return Err(self.other(format!(
                    "the calibration of {} (OFC, FSC) is {found:02x?}, in the recording {recorded:02x?}",
                    axis_name(axis)
                )));
            }
        }
        Ok(())
    }

    fn other(&self, what: String) -> LinkError {
        LinkError::OtherBoard {
            port: self.connect.name(),
            what,
        }
    }
}

fn differs(
    what: &str,
    found: &impl std::fmt::Display,
    recorded: &impl std::fmt::Display,
) -> String {
    format!("its {what} is {found}, the recording is of {recorded}")
}
