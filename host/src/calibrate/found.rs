//! A calibration that was found as it is told, and as a board keeps it.

use inm_firmware::mma7331l::Scaling;
use inm_protocol::{SensorCalibration, SensorRange};
use serde::Serialize;

use super::{Doubt, Fit, NAMES, PARAMETERS, Since};

/// The frame of the result, in words.
pub const FRAME: &str = "x along the sensitive axis of X, y in the plane of X and Y";

/// Half a 95 % interval of the normal law, standard deviations: what is kept as a deviation gives the
/// interval back.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// One parameter with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// What it is, as [`NAMES`] has it.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Half of its 95 % interval.
    pub half_width: f64,
    /// `1` of the matrix, by the nominal scale; `m/s^2` of zeros.
    pub unit: &'static str,
}

/// What a session found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// Range of the accelerometers.
    pub range: SensorRange,
    /// The frame, in words.
    pub frame: &'static str,
    /// Gravity that it counts by, m/s^2.
    pub gravity_m_s2: f64,
    /// Temperature of the microcontroller, degrees Celsius; `None` where it has no sensor.
    pub mcu_celsius: Option<f64>,
    /// Positions.
    pub positions: usize,
    /// Time from the first to the last, seconds.
    pub session_s: f64,
    /// The nine parameters.
    pub parameters: Vec<Parameter>,
    /// Wander of the zeros that the positions show, m/s^2 per root second.
    pub drift_m_s2_per_root_s: f64,
    /// Squared misfits by the noise of the stretches alone.
    pub chi_squared: f64,
    /// Chance of a larger one if nothing wandered between the positions.
    pub p_value: f64,
    /// Positions that the others do not bear out, the worst first.
    pub doubts: Vec<Doubt>,
    /// Against what the board kept for this range until now, if it did.
    pub since: Option<Since>,
    /// Whether the board keeps it.
    pub stored: bool,
    /// As a board keeps it.
    pub record: SensorCalibration,
}

/// Circumstances of a session.
#[derive(Debug, Clone, Copy)]
pub struct Circumstances {
    /// Range of the accelerometers.
    pub range: SensorRange,
    /// Gravity that it counts by, m/s^2.
    pub gravity_m_s2: f64,
    /// Temperature of the microcontroller, 0.01 degC.
    pub centi_celsius: Option<i16>,
    /// Time from the first to the last position, seconds.
    pub session_s: f64,
    /// Wall clock, seconds since 1970-01-01 UTC.
    pub unix_s: i64,
    /// What the board kept for this range until now.
    pub before: Option<SensorCalibration>,
}

impl Found {
    /// From a fit to readings by this scale.
    pub fn new(fit: &Fit, doubts: Vec<Doubt>, scaling: Scaling, of: Circumstances) -> Self {
        let parameter = |at: usize| Parameter {
            name: NAMES[at],
            value: fit.values[at],
            half_width: fit.half_widths[at],
            unit: if at < 6 { "1" } else { "m/s^2" },
        };
        let record = record(fit, scaling, of);
        Self {
            range: of.range,
            frame: FRAME,
            gravity_m_s2: of.gravity_m_s2,
            mcu_celsius: of.centi_celsius.map(|centi| f64::from(centi) / 100.0),
            positions: fit.misfits_m_s2.len(),
            session_s: of.session_s,
            parameters: (0..PARAMETERS).map(parameter).collect(),
            drift_m_s2_per_root_s: fit.drift,
            chi_squared: fit.chi_squared,
            p_value: fit.p_value,
            doubts,
            since: of.before.map(|old| Since::new(&old, &record, scaling)),
            stored: false,
            record,
        }
    }
}

/// The parameters in counts of the code, as a board keeps them.
fn record(fit: &Fit, scaling: Scaling, of: Circumstances) -> SensorCalibration {
    let per_row = scaling.scale() / SensorCalibration::ROW_UNIT;
    let per_zero = 1.0 / scaling.scale();
    // A deviation of nothing would be none: rounded up.
    let deviation = |half_width: f64, unit: f64| (half_width / NORMAL_95 * unit).ceil() as u32;
    SensorCalibration {
        range: of.range,
        unix_s: of.unix_s,
        centi_celsius: of.centi_celsius,
        gravity_um_s2: (of.gravity_m_s2 * 1e6).round() as u32,
        positions: u16::try_from(fit.misfits_m_s2.len()).unwrap_or(u16::MAX),
        rows: std::array::from_fn(|at| (fit.values[at] * per_row).round() as i32),
        row_deviations: std::array::from_fn(|at| deviation(fit.half_widths[at], per_row)),
        zero: std::array::from_fn(|axis| {
            (fit.values[6 + axis] * per_zero + scaling.zero()).round() as i32
        }),
        zero_deviations: std::array::from_fn(|axis| deviation(fit.half_widths[6 + axis], per_zero)),
    }
}
