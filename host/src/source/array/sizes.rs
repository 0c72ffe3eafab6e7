//! How large the numbers of each axis are: what is too small to be squared is refused.

use std::ops::Range;

use super::super::{SourceError, Values};
use crate::signal::{SMALLEST, Signal};

/// The largest number of each axis so far, without its sign; 0 where there was none.
#[derive(Debug, Default)]
pub(super) struct Sizes(Vec<f64>);

impl Sizes {
    /// Looks at these rows.
    pub fn take(&mut self, columns: &[Values], rows: &Range<usize>) {
        self.0.resize(columns.len(), 0.0);
        for (largest, values) in self.0.iter_mut().zip(columns) {
            if let Values::Floats(floats) = values {
                let sizes = floats[rows.clone()].iter().map(|value| value.abs());
                *largest = sizes
                    .filter(|size| size.is_finite())
                    .fold(*largest, f64::max);
            }
        }
    }

    /// At the end: refuses an axis that has numbers, and none whose square is one that can be told
    /// from zero.
    pub fn check(&self, signal: &Signal) -> Result<(), SourceError> {
        let mut sizes = signal.axes.iter().zip(&self.0);
        let too_small = |size: f64| size > 0.0 && size < SMALLEST;
        match sizes.find(|(_, size)| too_small(**size)) {
            None => Ok(()),
            Some((axis, size)) => Err(SourceError {
                place: signal.name.clone(),
                message: format!(
                    "no number of column {} is larger than {size:e}; expected some of {SMALLEST:e} \
                     or more",
                    axis.name
                ),
                remedy: "write the numbers in a smaller unit".into(),
            }),
        }
    }
}
