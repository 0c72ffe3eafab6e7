//! A calibration in words.

use std::fmt::Write as _;

use inm_protocol::{SensorCalibration, SensorRange};
use jiff::Timestamp;

use super::Kept;
use crate::calibrate::{Doubt, FRAME, Found, Since};

/// A range in words.
fn range(range: SensorRange) -> &'static str {
    match range {
        SensorRange::G4 => "4 g",
        SensorRange::G12 => "12 g",
    }
}

/// What a session found.
pub(super) fn found(found: &Found) -> String {
    let mut text = format!(
        "range {}, {} positions in {:.0} s, gravity {} m/s^2{}\nacceleration = M (reading - zero), {}\n\n",
        range(found.range),
        found.positions,
        found.session_s,
        found.gravity_m_s2,
        found
            .mcu_celsius
            .map_or_else(String::new, |celsius| format!(
                ", microcontroller {celsius:.2} degC"
            )),
        found.frame
    );
    for parameter in &found.parameters {
        let _ = writeln!(
            text,
            "{:<8}{:>12.6} +- {:.6} {}",
            parameter.name, parameter.value, parameter.half_width, parameter.unit
        );
    }
    text += &checked(found);
    if let Some(before) = &found.since {
        text += &since(before);
    }
    for doubt in &found.doubts {
        text += &doubted(doubt, found.gravity_m_s2);
    }
    text += match (found.stored, found.doubts.is_empty()) {
        (true, _) => "kept on the board\n",
        (false, true) => "kept nowhere\n",
        (false, false) => "kept nowhere: read the positions again\n",
    };
    text
}

/// How far what was left to check bears the intervals out.
fn checked(found: &Found) -> String {
    let (chi_squared, p_value, wander) = (
        found.chi_squared,
        found.p_value,
        found.drift_m_s2_per_root_s,
    );
    match found.tilt_mrad {
        None => format!(
            "\n95 % intervals. Misfits by the noise of the positions alone: chi^2 {chi_squared:.1}, p {p_value:.2e}; \
             between them the zeros wander by {wander:.1e} m/s^2 in a second.\n"
        ),
        Some(tilt_mrad) => format!(
            "\n95 % intervals, for faces that are off level by {tilt_mrad} mrad (standard deviation) and zeros that wander by \
             {wander:.1e} m/s^2 in a second.\n{} of 18 readings are left to check: chi^2 {chi_squared:.1}, p {p_value:.2e}. \
             They see what opposite faces have in common; what is off one way on a face and the other way on the one opposite, \
             as on a cube that is not square, is in the misalignments, and nothing shows it.\n",
            found.freedom
        ),
    }
}

/// A position that the others do not bear out.
fn doubted(doubt: &Doubt, gravity_m_s2: f64) -> String {
    match (doubt.or_position, doubt.axis) {
        (Some(other), Some(axis)) => format!(
            "DOUBTED: in position {} or {other} {axis} is {:+.1e} m/s^2 ({:.1} mrad) off what the others say (p {:.1e}): \
             did the face lie flat, is the table as level as that?\n",
            doubt.position,
            doubt.misfit_m_s2,
            1e3 * (doubt.misfit_m_s2 / gravity_m_s2).abs(),
            doubt.p_value
        ),
        _ => format!(
            "DOUBTED: position {} is {:+.1e} m/s^2 from gravity by the others (p {:.1e}): was it at rest?\n",
            doubt.position, doubt.misfit_m_s2, doubt.p_value
        ),
    }
}

/// What became of the parameters.
fn since(since: &Since) -> String {
    let celsius = since.mcu_celsius.map_or_else(String::new, |celsius| {
        format!(", microcontroller {celsius:.2} degC")
    });
    let mut text = format!(
        "\nagainst the one of {} that the board keeps, gravity {} m/s^2{celsius}; sd: standard deviations of both\n",
        moment(since.unix_s),
        since.gravity_m_s2
    );
    for change in &since.changes {
        let _ = writeln!(
            text,
            "{:<8}{:>+13.6} {:<6}{:>+8.1} sd",
            change.name, change.difference, change.unit, change.deviations
        );
    }
    text.push('\n');
    text
}

/// What a board keeps.
pub(super) fn kept(kept: &Kept) -> String {
    let of = format!("board {}, range {}", kept.serial, range(kept.range));
    match &kept.calibration {
        None => format!("{of}: keeps no calibration\n"),
        Some(calibration) => format!("{of}: {}", record(calibration)),
    }
}

fn record(record: &SensorCalibration) -> String {
    let when = moment(record.unix_s);
    let celsius = record.centi_celsius.map_or_else(String::new, |centi| {
        format!(", microcontroller {:.2} degC", f64::from(centi) / 100.0)
    });
    let mut text = format!(
        "calibrated {when} from {} positions, gravity {} m/s^2{celsius}\n{FRAME}\n",
        record.positions,
        f64::from(record.gravity_um_s2) * 1e-6
    );
    let names = ["xx", "yx", "yy", "zx", "zy", "zz"];
    for (name, (row, deviation)) in names
        .iter()
        .zip(record.rows.iter().zip(record.row_deviations))
    {
        let [row, deviation] =
            [f64::from(*row), f64::from(deviation)].map(|one| one * SensorCalibration::ROW_UNIT);
        let _ = writeln!(
            text,
            "{name:<8}{row:>14.6e} sd {deviation:.1e} m/s^2 per count"
        );
    }
    for (name, (zero, deviation)) in ["X", "Y", "Z"]
        .iter()
        .zip(record.zero.iter().zip(record.zero_deviations))
    {
        let _ = writeln!(text, "zero {name}  {zero:>14} sd {deviation} counts");
    }
    text
}

/// A time of the wall clock.
fn moment(unix_s: i64) -> String {
    Timestamp::from_second(unix_s)
        .map_or_else(|_| "an unknown time".to_owned(), |time| time.to_string())
}
