//! A column of an array file that is no axis: the temperature beside a record.

use crate::diagnosis::record::samples::Samples;
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
        unit: Some(Unit::Counts),
        scales: Vec::new(),
        ..options
    };
    let mut source = open(file, &options)?;
    let (mut samples, _) = Samples::read(&mut *source, |_| {})?;
    let (mut values, mean) = samples.axes.swap_remove(0).centred(1.0);
    let mut last = 0.0;
    for value in &mut values {
        if value.is_finite() {
            last = *value;
        } else {
            *value = last;
        }
        *value = scale * (*value + mean);
    }
    Ok(values)
}
