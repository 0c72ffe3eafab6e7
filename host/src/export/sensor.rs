//! What the formats of simulators and calibrators have in common: one sensor of one or three
//! axes, in SI units, with a few numbers an axis.

use crate::model::{Coefficient, PerCoefficient};
use crate::signal::Dimension;

use super::input::Input;

/// A sensor in SI units.
pub struct Sensor {
    /// Accelerometer or gyroscope.
    pub dimension: Dimension,
    /// Its axes.
    pub axes: Vec<SensorAxis>,
}

/// One axis of a sensor.
pub struct SensorAxis {
    /// Its name.
    pub name: String,
    /// Coefficients in SI units.
    pub coefficients: PerCoefficient<f64>,
    /// Bounds of those that could not be resolved from zero, in SI units.
    pub bounds: PerCoefficient<Option<f64>>,
    /// Factor from the unit of the model to the SI unit.
    pub factor: f64,
}

impl Sensor {
    /// The sensor of `input`.
    ///
    /// # Errors
    /// If its axes are not all accelerations or all rates of rotation.
    pub fn new(input: &Input) -> anyhow::Result<Self> {
        let mut axes = Vec::new();
        let mut dimension = None;
        for (axis, bounds) in input.model.axes.iter().zip(&input.bounds) {
            let Some((measures, factor)) = axis.unit.si() else {
                anyhow::bail!(
                    "{}: axis {} is in {}, which is neither acceleration nor rotation; scale the \
                     data first (inm analyze --unit, --scale)",
                    input.name,
                    axis.name,
                    axis.unit
                );
            };
            if *dimension.get_or_insert(measures) != measures {
                anyhow::bail!(
                    "{}: accelerometers and gyroscopes in one model; export them one after the \
                     other (inm analyze --columns)",
                    input.name
                );
            }
            axes.push(SensorAxis {
                name: axis.name.clone(),
                coefficients: PerCoefficient::from_fn(|one| {
                    axis.coefficients.get(one).abs() * factor
                }),
                bounds: PerCoefficient::from_fn(|one| bounds.get(one).map(|bound| bound * factor)),
                factor,
            });
        }
        Ok(Self {
            dimension: dimension.unwrap_or(Dimension::Acceleration),
            axes,
        })
    }

    /// SI unit of the signal.
    pub const fn unit(&self) -> &'static str {
        match self.dimension {
            Dimension::Acceleration => "m/s^2",
            Dimension::Rotation => "rad/s",
        }
    }

    /// One number for each of three axes; a single axis stands for all.
    ///
    /// # Errors
    /// If there are neither one nor three.
    pub fn three<T: Copy>(&self, of: impl Fn(&SensorAxis) -> T) -> anyhow::Result<[T; 3]> {
        match &self.axes[..] {
            [all] => Ok([of(all); 3]),
            [x, y, z] => Ok([of(x), of(y), of(z)]),
            axes => anyhow::bail!(
                "the format has one or three axes, the model {}; choose some (inm analyze \
                 --columns)",
                axes.len()
            ),
        }
    }

    /// What of the coefficients `these` is there and does not fit, in words; one line each.
    pub fn left_out(&self, these: &[Coefficient]) -> Vec<String> {
        these
            .iter()
            .filter(|&&one| {
                self.axes
                    .iter()
                    .any(|axis| *axis.coefficients.get(one) > 0.0)
            })
            .map(|one| format!("{} ({})", one.symbol(), one.name()))
            .collect()
    }

    /// What of `input` has no place in a file that holds N, B, K and the effects `placed`, as a comment after `mark`;
    /// nothing where all has.
    pub fn left_out_comment(&self, input: &Input, mark: char, placed: &[&str]) -> String {
        let effects = input.model.axes.iter().flat_map(|axis| &axis.effects);
        let effects = effects.map(|one| one.kind().name());
        let effects = effects.filter(|name| !placed.contains(name));
        let mut left_out = self.left_out(&[Coefficient::Q, Coefficient::R]);
        left_out.extend(effects.map(str::to_owned));
        if left_out.is_empty() {
            return String::new();
        }
        let left_out = left_out.join(", ");
        format!("{mark} Not in this file, for want of a place: {left_out}.\n")
    }
}

/// A number as every one of these languages reads a floating-point number: with point, sign of
/// the exponent and seven digits (YAML 1.1 takes `4e-5` for a word).
pub fn float(value: f64) -> String {
    let text = format!("{value:.6e}");
    match text.split_once('e') {
        Some((digits, exponent)) if !exponent.starts_with('-') => format!("{digits}e+{exponent}"),
        _ => text,
    }
}
