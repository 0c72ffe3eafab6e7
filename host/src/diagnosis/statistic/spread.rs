//! A spread that few wild values do not decide.

/// Spread of the middle half of `values`, as a standard deviation of normal numbers.
pub fn middle_spread(values: &[f64]) -> f64 {
    // A sixteenth of a long series determines it well enough.
    let stride = (values.len() / (1 << 16)).max(1);
    let mut sizes: Vec<f64> = values.iter().step_by(stride).map(|v| v.abs()).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    *median / 0.674_489_750_196_081_7
}
