//! The noise of a short stream, against what converter and sensor have by themselves.

use inm_protocol::{AXES, Identity};

use super::{Check, Verdict};
use crate::analyse::{AnalysisOptions, AxisAnalysis, analyse};
use crate::data_sheet::SheetNoise;
use crate::inspect::AXIS_NAMES;
use crate::link::Connect;
use crate::source::SourceError;
use crate::source::board::{BoardSource, Plan, Stop};

/// Averaging time, seconds: above the corners of the sensors (300 Hz), below what drifts.
const TAU_S: f64 = 0.1;

/// Length of the stream, seconds: forty averages of [`TAU_S`], which give the deviation to some 10 %.
const STREAM_S: f64 = 4.0;

/// Records for 4 s with the board's settings, and compares the noise of each axis.
///
/// # Errors
/// What the link says; of a board whose converters do not start, that.
pub(super) fn noise(
    connect: Box<dyn Connect>,
    identity: &Identity,
) -> Result<Vec<Check>, SourceError> {
    let rate_hz = f64::from(identity.settings.rate.hz());
    let plan = Plan {
        samples: Some((STREAM_S * rate_hz) as u64),
        ..Plan::default()
    };
    let mut source = BoardSource::start(connect, plan, None, Stop::default())?;
    let analysis = analyse(&mut source, &AnalysisOptions::default(), |_| {})?;
    let limits = SheetNoise::on(identity.range).plausible();
    let checks = (0..AXES).map(|axis| check(axis, analysis.axes.get(axis), limits));
    Ok(checks.collect())
}

/// The deviation at [`TAU_S`] as the density of white noise that would have it.
fn check(axis: usize, analysed: Option<&AxisAnalysis>, limits: [f64; 2]) -> Check {
    let unit = "m/s^2/sqrt(Hz)";
    let curve = analysed.map_or(&[][..], |axis| &axis.allan);
    let away = |tau_s: f64| (tau_s / TAU_S).ln().abs();
    let nearest = curve
        .iter()
        .min_by(|one, other| away(one.tau_s).total_cmp(&away(other.tau_s)));
    let Some(point) = nearest else {
        return Check::of("noise", Some(axis), 0.0, unit, limits).without(
            Verdict::Failed,
            format!("{} gave no samples", AXIS_NAMES[axis]),
        );
    };
    let density = point.adev * point.tau_s.sqrt();
    let reason = if density < limits[0] {
        "quieter than the converter itself: nothing of the sensor arrives"
    } else {
        "louder than the sensor: vibration, supply, or an output that is not connected"
    };
    Check::of("noise", Some(axis), density, unit, limits).explained(reason)
}
