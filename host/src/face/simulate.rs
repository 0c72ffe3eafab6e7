//! A simulated record: a model in, a source out.

use crate::model::whole::Model;
use crate::simulate::source::Simulation;

/// Samples beyond which an index is no exact `f64` any more.
const MOST: f64 = (1_u64 << 53) as f64;

/// Samples an axis in `duration_s` seconds at `rate_hz`.
///
/// # Errors
/// In words, if that is none, or more than can be counted.
pub fn samples(duration_s: f64, rate_hz: f64) -> Result<u64, String> {
    let length = (duration_s * rate_hz).round();
    // Written so that NaN is refused as well.
    if rate_hz > 0.0 && (1.0..MOST).contains(&length) {
        Ok(length as u64)
    } else {
        Err(format!(
            "--duration {duration_s} at --rate {rate_hz} gives no samples; both are numbers above \
             zero"
        ))
    }
}

/// The correlation of `axes` axes with `upper` above its diagonal, row by row (for three axes: 12,
/// 13, 23).
///
/// # Errors
/// In words, if these are not as many numbers as there are pairs.
pub fn correlation(upper: &[f64], axes: usize) -> Result<Vec<Vec<f64>>, String> {
    let wanted = axes * axes.saturating_sub(1) / 2;
    if upper.len() != wanted {
        return Err(format!(
            "--correlation has {} numbers; {axes} axes have {wanted} pairs",
            upper.len()
        ));
    }
    let mut matrix = vec![vec![1.0; axes]; axes];
    let pairs = (0..axes).flat_map(|i| (i + 1..axes).map(move |j| (i, j)));
    for ((i, j), &value) in pairs.zip(upper) {
        matrix[i][j] = value;
        matrix[j][i] = value;
    }
    Ok(matrix)
}

/// A record of `model`, `samples` samples an axis, made as it is read; the same `seed` gives the same
/// data. Axes that follow the `temperature` need it, one value a sample.
///
/// # Errors
/// In words, if the model is none that data can be made of, lacks what an axis follows, or the
/// temperature is shorter than the record.
///
/// ```
/// use inm_host::{Model, Source, simulate};
///
/// let model = Model::open("published:X")?;
/// let mut record = simulate(&model, 4000, 1, None)?;
/// assert_eq!(record.expected_len(), Some(4000));
/// let samples = record.next_columns(4000).remove(0);
/// assert_eq!(samples, simulate(&model, 4000, 1, None)?.next_columns(4000).remove(0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate(
    model: &Model,
    samples: u64,
    seed: u64,
    temperature: Option<Vec<f64>>,
) -> Result<Simulation, String> {
    match temperature {
        Some(temperature) => Simulation::at_temperature(model, samples, seed, temperature),
        None => Simulation::new(model, samples, seed),
    }
}
