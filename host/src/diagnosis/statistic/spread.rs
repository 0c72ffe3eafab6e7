//! A spread that few wild values do not decide.

use crate::numeric::order::median;

/// Spread of the middle half of `values`, as a standard deviation of normal numbers.
pub fn middle_spread(values: &[f64]) -> f64 {
    // A sixteenth of a long series determines it well enough.
    let stride = (values.len() / (1 << 16)).max(1);
    let mut sizes: Vec<f64> = values.iter().step_by(stride).map(|v| v.abs()).collect();
    median(&mut sizes).unwrap_or(0.0) / 0.674_489_750_196_081_7
}
