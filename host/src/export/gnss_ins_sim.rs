//! Error model of gnss-ins-sim (Aceinna), as a Python file.
//!
//! Its simulator (pathgen.py, `acc_gen` and `bias_drift`) adds white noise of the deviation
//! `vrw / sqrt(dt)` and one first-order Markov process of the deviation `b_drift` and the
//! correlation time `b_corr`, all in SI units; `vrw` (`arw` for a gyroscope) is N. `IMU.set_accel_error`
//! and `set_gyro_error` hand the dictionary on as it is, though their comments speak of roots of
//! an hour. B, K and slow Markov noise become the one Markov process that comes closest to the
//! Allan curve, and the file says how close.

use std::fmt::Write;

use super::input::Input;
use super::sensor::{Sensor, float};
use crate::model::axis::ModelAxis;
use crate::model::markov::Markov;
use crate::model::white::White;
use crate::model::{Coefficient, Term};
use crate::signal::Dimension;

/// Correlation times tried, an octave.
const TRIED_PER_OCTAVE: f64 = 4.0;

/// Averaging times compared, an octave.
const COMPARED_PER_OCTAVE: f64 = 2.0;

/// Shortest averaging time compared, samples.
const SHORTEST: f64 = 16.0;

/// The file.
///
/// # Errors
/// If the model has neither one nor three axes, or is in no unit of motion.
pub fn render(input: &Input) -> anyhow::Result<String> {
    let sensor = Sensor::new(input)?;
    let (name, white, setter) = match sensor.dimension {
        Dimension::Acceleration => ("accel_err", "vrw", "set_accel_error"),
        Dimension::Rotation => ("gyro_err", "arw", "set_gyro_error"),
    };
    let unit = sensor.unit();
    let drifts: Vec<Drift> = input
        .model
        .axes
        .iter()
        .map(|axis| Drift::new(axis, input.model.rate_hz, input.longest_s))
        .collect();
    let indices = match drifts.len() {
        1 => [0; 3],
        _ => [0, 1, 2],
    };
    let noise = sensor.three(|axis| *axis.coefficients.get(Coefficient::N))?;
    let factors = sensor.three(|axis| axis.factor)?;
    let row = |value: &dyn Fn(usize) -> f64| {
        let values: Vec<String> = (0..3).map(|axis| python(value(axis))).collect();
        format!("np.array([{}])", values.join(", "))
    };
    let mut text = String::new();
    write!(
        text,
        "# {}: noise model for gnss-ins-sim, SI units\n\
         #     imu = imu_model.IMU(accuracy='low-accuracy', axis=6, gps=False)\n\
         #     imu.{setter}({name})\n\
         import numpy as np\n\n\
         {name} = {{\n",
        input.name
    )?;
    writeln!(
        text,
        "    # bias, {unit}: left at zero, the mean of a record at rest holds gravity\n    'b': {},",
        row(&|_| 0.0)
    )?;
    writeln!(
        text,
        "    # standard deviation of the drift, {unit}\n    'b_drift': {},",
        row(&|axis| drifts[indices[axis]].markov.deviation * factors[axis])
    )?;
    writeln!(
        text,
        "    # its correlation time, s\n    'b_corr': {},",
        row(&|axis| drifts[indices[axis]].markov.time_s)
    )?;
    writeln!(
        text,
        "    # white noise, ({unit})/sqrt(Hz), root of the two-sided density\n    '{white}': {},",
        row(&|axis| noise[axis])
    )?;
    writeln!(text, "}}")?;
    accuracy(&mut text, input, &drifts)?;
    text += &sensor.left_out_comment(input, '#', &["markov"]);
    Ok(text)
}

/// How well the drifts stand for what they stand for, in comments.
fn accuracy(text: &mut String, input: &Input, drifts: &[Drift]) -> std::fmt::Result {
    writeln!(
        text,
        "# The drift stands for B, K and slow Markov noise. Allan deviation of this file against \
         the model\n# without Q and what else has no place here, largest difference from {:.3} s \
         to {:.0} s:",
        SHORTEST / input.model.rate_hz,
        input.longest_s
    )?;
    for (axis, drift) in input.model.axes.iter().zip(drifts) {
        writeln!(text, "#     {}: {:.0} %", axis.name, drift.percent)?;
    }
    Ok(())
}

fn python(value: f64) -> String {
    if value.is_infinite() {
        "np.inf".to_owned()
    } else {
        float(value)
    }
}

/// The one Markov process that stands for all slow noise of an axis.
struct Drift {
    markov: Markov,
    /// Largest difference of the Allan deviation, percent.
    percent: f64,
}

impl Drift {
    fn new(axis: &ModelAxis, rate_hz: f64, longest_s: f64) -> Self {
        let slow = slow(axis);
        let white = White {
            root_density: slow.coefficients.n,
        };
        let law = slow.law(rate_hz);
        let octaves = (longest_s * rate_hz / SHORTEST).log2().max(1.0);
        let factors: Vec<u64> = (0..=(octaves * COMPARED_PER_OCTAVE) as u32)
            .map(|k| (SHORTEST * (f64::from(k) / COMPARED_PER_OCTAVE).exp2()) as u64)
            .collect();
        // Relative to the model: the white part, and that of a process of unit deviation.
        let relative = |term: &dyn Term, m| term.allan_variance(m, rate_hz) / law.allan_variance(m);
        let whites: Vec<f64> = factors.iter().map(|&m| relative(&white, m)).collect();
        let none = Markov {
            deviation: 0.0,
            time_s: f64::INFINITY,
        };
        if law.terms().len() <= usize::from(slow.coefficients.n != 0.0) {
            return Self {
                markov: none,
                percent: 0.0,
            };
        }
        let tried = (octaves * TRIED_PER_OCTAVE) as u32;
        let mut best = (f64::INFINITY, none, percent(&whites));
        for step in 0..=tried {
            let unit = Markov {
                deviation: 1.0,
                time_s: SHORTEST / rate_hz * (f64::from(step) / TRIED_PER_OCTAVE).exp2(),
            };
            let units: Vec<f64> = factors.iter().map(|&m| relative(&unit, m)).collect();
            let variance = likeliest(&units, &whites);
            let parts: Vec<f64> = units
                .iter()
                .zip(&whites)
                .map(|(u, w)| w + variance * u)
                .collect();
            let misfit: f64 = parts.iter().map(|part| (part - 1.0).powi(2)).sum();
            if misfit < best.0 {
                let markov = Markov {
                    deviation: variance.sqrt(),
                    ..unit
                };
                best = (misfit, markov, percent(&parts));
            }
        }
        Self {
            markov: best.1,
            percent: best.2,
        }
    }
}

/// What of an axis the white noise and the drift of the file stand for.
fn slow(axis: &ModelAxis) -> ModelAxis {
    let mut slow = axis.clone();
    slow.chain = None;
    slow.coefficients.q = 0.0;
    slow.coefficients.r = 0.0;
    slow.effects
        .retain(|effect| effect.kind().name() == "markov");
    slow
}

/// The variance `D` of least squares for `white + D unit = 1`, parts of the model's Allan variance.
fn likeliest(units: &[f64], whites: &[f64]) -> f64 {
    let pairs = units.iter().zip(whites);
    let (up, down) = pairs.fold((0.0, 0.0), |(up, down), (u, w)| {
        (up + u * (1.0 - w), down + u * u)
    });
    (up / down).max(0.0)
}

/// Largest difference of the deviation, percent, where these parts of the variance are there.
fn percent(parts: &[f64]) -> f64 {
    let error = |part: &f64| (part.sqrt() - 1.0).abs();
    100.0 * parts.iter().map(error).fold(0.0, f64::max)
}
