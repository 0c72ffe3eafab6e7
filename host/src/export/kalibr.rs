//! imu.yaml of kalibr.
//!
//! Its model is white noise and a random walk of the bias (wiki page "IMU Noise Model"): a sample's
//! white noise has the standard deviation `noise_density * sqrt(update_rate)`, so the density is
//! the root of a two-sided one and the same as N; `random_walk` is K. Both have to be above zero,
//! and are one for all axes.

use std::fmt::Write;

use super::input::Input;
use super::sensor::{Sensor, SensorAxis, float};
use crate::model::Coefficient;
use crate::signal::Dimension;

/// The file.
///
/// # Errors
/// If the model has no white noise or no random walk, or is in no unit of motion.
pub fn render(input: &Input) -> anyhow::Result<String> {
    let sensor = Sensor::new(input)?;
    let (name, other, derivative) = match sensor.dimension {
        Dimension::Acceleration => ("accelerometer", "gyroscope", "m/s^3"),
        Dimension::Rotation => ("gyroscope", "accelerometer", "rad/s^2"),
    };
    let unit = sensor.unit();
    let white = largest(input, &sensor, Coefficient::N)?;
    let walk = largest(input, &sensor, Coefficient::K)?;
    let mut text = String::new();
    writeln!(text, "# {}: noise model for kalibr", input.name)?;
    writeln!(
        text,
        "# Continuous time, roots of two-sided densities: a sample's white noise has the standard\n\
         # deviation noise_density * sqrt(update_rate), and the bias changes by random_walk /\n\
         # sqrt(update_rate) a sample. Kalibr has one value for all axes: the largest is given."
    )?;
    writeln!(
        text,
        "{name}_noise_density: {}  # {unit}/sqrt(Hz); {}",
        float(white.value),
        white.comment
    )?;
    writeln!(
        text,
        "{name}_random_walk: {}  # {derivative}/sqrt(Hz); {}",
        float(walk.value),
        walk.comment
    )?;
    writeln!(
        text,
        "# Kalibr wants {other}_noise_density and {other}_random_walk as well: from a record of \
         the {other}."
    )?;
    let left_out = sensor.left_out(&[Coefficient::Q, Coefficient::B, Coefficient::R]);
    let effects = input.model.axes.iter().flat_map(|axis| &axis.effects);
    let effects = effects.map(|effect| effect.kind().name().to_owned());
    let left_out: Vec<String> = left_out.into_iter().chain(effects).collect();
    if !left_out.is_empty() {
        writeln!(
            text,
            "# Not in this file, for want of a place: {}.",
            left_out.join(", ")
        )?;
    }
    writeln!(
        text,
        "rostopic: /imu0  # where the data are published; yours to set"
    )?;
    writeln!(text, "update_rate: {:?}  # Hz", input.model.rate_hz)?;
    Ok(text)
}

struct Largest {
    value: f64,
    comment: String,
}

/// The largest of the axes; where a coefficient could not be resolved from zero, its bound counts.
fn largest(input: &Input, sensor: &Sensor, coefficient: Coefficient) -> anyhow::Result<Largest> {
    let of = |axis: &SensorAxis| {
        let value = *axis.coefficients.get(coefficient);
        let bound = axis.bounds.get(coefficient).unwrap_or(0.0);
        (value.max(bound), value == 0.0)
    };
    let (value, is_bound) = sensor
        .axes
        .iter()
        .map(of)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((0.0, false));
    anyhow::ensure!(
        value > 0.0,
        "{}: kalibr refuses a {} of zero, and the model has no {}; export the analysis of a \
         longer record, or put a bound into a model file",
        input.name,
        coefficient.name(),
        coefficient.symbol()
    );
    let symbol = coefficient.symbol();
    let mut comment = match is_bound {
        true => format!("{symbol} is not resolved from zero, this is its 95 % bound"),
        false => symbol.to_owned(),
    };
    if sensor.axes.len() > 1 {
        let all = sensor
            .axes
            .iter()
            .map(|axis| format!("{} {:.3e}", axis.name, of(axis).0));
        write!(comment, " ({})", all.collect::<Vec<_>>().join(", "))?;
    }
    Ok(Largest { value, comment })
}
