//! What was recorded together with the axes, such as a temperature.

use crate::diagnosis::record::samples::Samples;
use crate::source::{Source, SourceError};

/// One value a sample from the first axis of `source`, times `scale`, in the unit of its scaled data;
/// missing ones take the one before, and zero stands for those ahead of the first.
///
/// # Errors
/// Whatever ends the source early.
pub fn covariate(source: &mut dyn Source, scale: f64) -> Result<Vec<f64>, SourceError> {
    let (mut samples, _) = Samples::read(source, |_| {})?;
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
