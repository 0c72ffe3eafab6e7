//! Bridging what is missing, and means over blocks.

use std::ops::Range;

/// Bridges what is not finite by straight lines between means on either side, of more samples the
/// longer the bridge: the ends' own noise must not become a slow wave. Returns the ranges bridged.
pub fn bridge(values: &mut [f64]) -> Vec<Range<usize>> {
    /// Samples on either side that a line rests on, at least and at most: choices. Between them
    /// four times as many as are missing.
    const FEWEST_SAMPLES: usize = 16;
    const MOST_SAMPLES: usize = 1 << 16;
    let mut gaps = Vec::new();
    let mut from = 0;
    while let Some(start) = (from..values.len()).find(|&index| !values[index].is_finite()) {
        let end = (start..values.len())
            .find(|&index| values[index].is_finite())
            .unwrap_or(values.len());
        let mean = |part: &[f64]| {
            let good: Vec<f64> = part.iter().copied().filter(|v| v.is_finite()).collect();
            (!good.is_empty()).then(|| good.iter().sum::<f64>() / good.len() as f64)
        };
        let count = (4 * (end - start)).clamp(FEWEST_SAMPLES, MOST_SAMPLES);
        let before = mean(&values[start.saturating_sub(count)..start]);
        let after = mean(&values[end..(end + count).min(values.len())]);
        let (a, b) = match (before, after) {
            (Some(a), Some(b)) => (a, b),
            (Some(a), None) | (None, Some(a)) => (a, a),
            (None, None) => (0.0, 0.0),
        };
        let length = (end - start + 1) as f64;
        for (step, value) in values[start..end].iter_mut().enumerate() {
            *value = a + (b - a) * (step + 1) as f64 / length;
        }
        gaps.push(start..end);
        from = end;
    }
    gaps
}

/// Means over `factor` samples each.
pub fn block_means(values: &[f64], factor: usize) -> Vec<f64> {
    values
        .chunks_exact(factor)
        .map(|block| block.iter().sum::<f64>() / factor as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bridges_are_straight() {
        let mut values = vec![1.0; 40];
        values[10..13].fill(f64::NAN);
        values[13..].fill(5.0);
        assert_eq!(bridge(&mut values), [10..13]);
        assert_eq!(&values[9..14], [1.0, 2.0, 3.0, 4.0, 5.0]);
    }
}
