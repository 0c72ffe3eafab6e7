//! A column of an array file that is no axis: the temperature recorded with it.

use crate::face::covariate::covariate;
use crate::signal::Unit;
use crate::source::open::open;
use crate::source::options::{ArrayOptions, Selector};

/// One value a sample, times `scale`, of the `column` of a file that is read as `options` say;
/// missing ones take the one before.
///
/// # Errors
/// If the file cannot be read or has no such column.
pub fn read(
    file: &str,
    options: ArrayOptions,
    column: &Selector,
    scale: f64,
) -> anyhow::Result<Vec<f64>> {
    let options = ArrayOptions {
        columns: vec![column.clone()],
        // Whatever its name says: `scale` makes degrees of it.
        unit: Some(Unit::Counts),
        scales: vec![1.0],
        ..options
    };
    Ok(covariate(&mut *open(file, &options)?, scale)?)
}
