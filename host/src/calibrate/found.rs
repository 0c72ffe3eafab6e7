//! A calibration that was found as it is told, and as a board keeps it.

use inm_firmware::mma7331l::Scaling;
use inm_protocol::{SensorCalibration, SensorRange};
use serde::Serialize;

use super::{
    CUBE_FRAME, CUBE_NAMES, CubeFit, Doubt, FACES, FREEDOM, Fit, NAMES, PARAMETERS, Since,
};

/// The frame of the result, in words.
pub const FRAME: &str = "x along the sensitive axis of X, y in the plane of X and Y";

/// Half a 95 % interval of the normal law, standard deviations: what is kept as a deviation gives the
/// interval back.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// One parameter with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// What it is, as [`NAMES`] has it, on a cube [`CUBE_NAMES`].
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
    /// How far off level each face of a cube is taken to be, a standard deviation in two directions, mrad; `None`
    /// where there was no cube.
    pub tilt_mrad: Option<f64>,
    /// The nine parameters, twelve on a cube.
    pub parameters: Vec<Parameter>,
    /// Wander of the zeros that the positions show, m/s^2 per root second; on a cube that which is expected, where they do not.
    pub drift_m_s2_per_root_s: f64,
    /// What was left to check: readings less parameters.
    pub freedom: usize,
    /// Squared misfits by the noise of the stretches alone, on a cube by wander and tilts besides.
    pub chi_squared: f64,
    /// Chance of a larger one if nothing wandered between the positions; on a cube, if all is as it is taken to be.
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
        let positions = fit.misfits_m_s2.len();
        let record = record(&fit.values, &fit.half_widths, positions, scaling, of);
        Self {
            frame: FRAME,
            parameters: parameters(&NAMES, &fit.values, &fit.half_widths),
            drift_m_s2_per_root_s: fit.drift,
            freedom: positions - PARAMETERS,
            chi_squared: fit.chi_squared,
            p_value: fit.p_value,
            doubts,
            ..Self::of(record, scaling, of)
        }
    }

    /// From a fit on a cube whose faces are off level by so many mrad. A board keeps it in the frame of the sensors.
    pub fn on_cube(fit: CubeFit, tilt_mrad: f64, scaling: Scaling, of: Circumstances) -> Self {
        let record = record(&fit.kept, &fit.kept_half_widths, FACES, scaling, of);
        Self {
            frame: CUBE_FRAME,
            tilt_mrad: Some(tilt_mrad),
            parameters: parameters(&CUBE_NAMES, &fit.values, &fit.half_widths),
            drift_m_s2_per_root_s: fit.drift,
            freedom: FREEDOM,
            chi_squared: fit.chi_squared,
            p_value: fit.p_value,
            doubts: fit.doubts,
            ..Self::of(record, scaling, of)
        }
    }

    /// What does not depend on how it was found, the rest empty.
    fn of(record: SensorCalibration, scaling: Scaling, of: Circumstances) -> Self {
        Self {
            range: of.range,
            frame: FRAME,
            gravity_m_s2: of.gravity_m_s2,
            mcu_celsius: of.centi_celsius.map(|centi| f64::from(centi) / 100.0),
            positions: usize::from(record.positions),
            session_s: of.session_s,
            tilt_mrad: None,
            parameters: Vec::new(),
            drift_m_s2_per_root_s: f64::NAN,
            freedom: 0,
            chi_squared: f64::NAN,
            p_value: f64::NAN,
            doubts: Vec::new(),
            since: of.before.map(|old| Since::new(&old, &record, scaling)),
            stored: false,
            record,
        }
    }
}

/// Parameters, of which the last three are zeros.
fn parameters(names: &[&'static str], values: &[f64], half_widths: &[f64]) -> Vec<Parameter> {
    let zeros = names.len() - 3;
    let parameter = |at: usize| Parameter {
        name: names[at],
        value: values[at],
        half_width: half_widths[at],
        unit: if at < zeros { "1" } else { "m/s^2" },
    };
    (0..names.len()).map(parameter).collect()
}

/// The parameters in counts of the code, as a board keeps them.
fn record(
    values: &[f64; PARAMETERS],
    half_widths: &[f64; PARAMETERS],
    positions: usize,
    scaling: Scaling,
    of: Circumstances,
) -> SensorCalibration {
    let per_row = scaling.scale() / SensorCalibration::ROW_UNIT;
    let per_zero = 1.0 / scaling.scale();
    // A deviation of nothing would be none: rounded up.
    let deviation = |half_width: f64, unit: f64| (half_width / NORMAL_95 * unit).ceil() as u32;
    SensorCalibration {
        range: of.range,
        unix_s: of.unix_s,
        centi_celsius: of.centi_celsius,
        gravity_um_s2: (of.gravity_m_s2 * 1e6).round() as u32,
        positions: u16::try_from(positions).unwrap_or(u16::MAX),
        rows: std::array::from_fn(|at| (values[at] * per_row).round() as i32),
        row_deviations: std::array::from_fn(|at| deviation(half_widths[at], per_row)),
        zero: std::array::from_fn(|axis| {
            (values[6 + axis] * per_zero + scaling.zero()).round() as i32
        }),
        zero_deviations: std::array::from_fn(|axis| deviation(half_widths[6 + axis], per_zero)),
    }
}
