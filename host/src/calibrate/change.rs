//! What became of a calibration since the one before it.

use inm_firmware::mma7331l::Scaling;
use inm_protocol::SensorCalibration;
use serde::Serialize;

use super::{NAMES, PARAMETERS};

/// A parameter against what it was.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Change {
    /// What it is, as [`NAMES`] has it.
    pub name: &'static str,
    /// The new value less the old.
    pub difference: f64,
    /// The same in standard deviations of both together.
    pub deviations: f64,
    /// `1` of the matrix, by the nominal scale; `m/s^2` of zeros.
    pub unit: &'static str,
}

/// A calibration against the one that the board kept until then.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Since {
    /// When the old one was found, seconds since 1970-01-01 UTC.
    pub unix_s: i64,
    /// Temperature of the microcontroller by then, degrees Celsius; `None` where it was not measured.
    pub mcu_celsius: Option<f64>,
    /// Gravity that it counts by, m/s^2: scales differ by as much as this does.
    pub gravity_m_s2: f64,
    /// The nine parameters.
    pub changes: Vec<Change>,
}

impl Since {
    /// Of two calibrations of a range, whose nominal scale this is.
    pub fn new(old: &SensorCalibration, new: &SensorCalibration, scaling: Scaling) -> Self {
        Self {
            unix_s: old.unix_s,
            mcu_celsius: old.centi_celsius.map(|centi| f64::from(centi) / 100.0),
            gravity_m_s2: f64::from(old.gravity_um_s2) * 1e-6,
            changes: (0..PARAMETERS)
                .map(|at| change(at, old, new, scaling))
                .collect(),
        }
    }
}

fn change(at: usize, old: &SensorCalibration, new: &SensorCalibration, scaling: Scaling) -> Change {
    let [(was, was_sd), (is, is_sd)] = [old, new].map(|record| match at.checked_sub(6) {
        None => (record.rows[at], record.row_deviations[at]),
        Some(axis) => (record.zero[axis], record.zero_deviations[axis]),
    });
    let (counts, unit) = if at < 6 {
        (SensorCalibration::ROW_UNIT / scaling.scale(), "1")
    } else {
        (scaling.scale(), "m/s^2")
    };
    let difference = f64::from(is) - f64::from(was);
    Change {
        name: NAMES[at],
        difference: difference * counts,
        deviations: difference / f64::from(was_sd).hypot(f64::from(is_sd)),
        unit,
    }
}

#[cfg(test)]
mod tests {
    use inm_protocol::SensorRange;

    use super::*;

    #[test]
    fn a_change_is_told_in_the_unit_of_its_parameter_and_in_deviations_of_both() {
        let scaling = Scaling::new(2_500_000, SensorRange::G4, 2_800_000);
        let old = SensorCalibration {
            rows: [400_000_000; 6],
            row_deviations: [3000; 6],
            zero: [-1000; 3],
            zero_deviations: [300; 3],
            centi_celsius: Some(2150),
            gravity_um_s2: 9_810_000,
            unix_s: 7,
            ..SensorCalibration::default()
        };
        let mut new = SensorCalibration {
            row_deviations: [4000; 6],
            zero_deviations: [400; 3],
            ..old
        };
        new.rows[3] -= 10_000;
        new.zero[1] += 1500;
        let since = Since::new(&old, &new, scaling);
        assert_eq!((since.unix_s, since.mcu_celsius), (7, Some(21.5)));
        assert!((since.gravity_m_s2 - 9.81).abs() < 1e-9);
        for (at, change) in since.changes.iter().enumerate() {
            let (deviations, difference) = match at {
                3 => (-2.0, -1e-12 / scaling.scale()),
                7 => (3.0, 1500.0 * scaling.scale()),
                _ => (0.0, 0.0),
            };
            assert_eq!(change.name, NAMES[at]);
            assert!((change.deviations - deviations).abs() < 1e-9, "{change:?}");
            let off = (change.difference - difference).abs();
            assert!(off <= 1e-9 * difference.abs(), "{change:?}");
        }
    }
}
