//! accelparams or gyroparams for imuSensor of MATLAB.
//!
//! With `NoiseType` "single-sided" the white noise of a sample has the standard deviation
//! `NoiseDensity * sqrt(SampleRate)`, and N, B and K of an Allan curve go in as they are
//! (MathWorks, "Inertial Sensor Noise Analysis Using Allan Variance"); with the default
//! "double-sided" it has that times 1/sqrt(2). `fractalcoef` (R2023b) makes the bias instability
//! 1/f noise: with n poles, above about SampleRate / n.

use std::fmt::Write;

use super::input::Input;
use super::sensor::{Sensor, float};
use crate::model::Coefficient;
use crate::signal::Dimension;

/// Poles of the 1/f filter, as in the vendor's example.
const POLES: u32 = 500;

/// The file, a script.
///
/// # Errors
/// If the model has neither one nor three axes, or is in no unit of motion.
pub fn render(input: &Input) -> anyhow::Result<String> {
    let sensor = Sensor::new(input)?;
    let (function, property) = match sensor.dimension {
        Dimension::Acceleration => ("accelparams", "Accelerometer"),
        Dimension::Rotation => ("gyroparams", "Gyroscope"),
    };
    let unit = sensor.unit();
    let row = |coefficient: Coefficient| -> anyhow::Result<String> {
        let values = sensor.three(|axis| *axis.coefficients.get(coefficient))?;
        Ok(format!("[{}]", values.map(float).join(" ")))
    };
    let rate_hz = input.model.rate_hz;
    let mut text = String::new();
    writeln!(
        text,
        "% {}: noise model for imuSensor, MATLAB R2023b or later",
        input.name
    )?;
    writeln!(
        text,
        "% Single-sided: white noise of a sample has the deviation NoiseDensity * sqrt(SampleRate)."
    )?;
    writeln!(text, "params = {function}( ...")?;
    writeln!(text, "    'NoiseType', 'single-sided', ...")?;
    writeln!(
        text,
        "    'NoiseDensity', {}, ...  % N, ({unit})/sqrt(Hz)",
        row(Coefficient::N)?
    )?;
    writeln!(
        text,
        "    'BiasInstability', {}, ...  % B, {unit}",
        row(Coefficient::B)?
    )?;
    writeln!(
        text,
        "    'BiasInstabilityCoefficients', fractalcoef({POLES}), ...  % 1/f above about {:.3} Hz",
        rate_hz / f64::from(POLES)
    )?;
    writeln!(
        text,
        "    'RandomWalk', {});  % K, ({unit})*sqrt(Hz)",
        row(Coefficient::K)?
    )?;
    text += &sensor.left_out_comment(input, '%', &[]);
    writeln!(
        text,
        "% ConstantBias is left at zero: the mean of a record at rest holds gravity."
    )?;
    writeln!(
        text,
        "imu = imuSensor('accel-gyro', 'SampleRate', {rate_hz:?}, '{property}', params);"
    )?;
    Ok(text)
}
