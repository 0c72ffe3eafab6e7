//! A course that goes straight from one end of the record to the other, and its cosine transform.

use std::f64::consts::PI;

use realfft::num_complex::Complex64;

use crate::fft;

/// Straight lines in place of the values that do not count; at the ends, the one next to them.
pub fn bridge(values: &mut [f64], counts: &[bool]) {
    let mut last: Option<usize> = None;
    for n in (0..values.len()).filter(|n| counts[*n]) {
        let (first, from) = last.map_or((0, values[n]), |last| (last + 1, values[last]));
        let step = (values[n] - from) / (n + 1 - first) as f64;
        for (place, value) in values[first..n].iter_mut().enumerate() {
            *value = from + step * (place + 1) as f64;
        }
        last = Some(n);
    }
    if let Some(last) = last {
        let level = values[last];
        values[last + 1..].fill(level);
    }
}

/// Squares of some coefficients without what goes straight from one end of the record to the other, as is likeliest where
/// they are `expected` to have these, and how far that goes.
pub fn without_straight(coefficients: &[f64], expected: &[f64]) -> (Vec<f64>, f64) {
    let count = coefficients.len() + 1;
    let line = (0..count).map(|n| (n as f64 + 0.5) / count as f64 - 0.5);
    let line = cosine_coefficients(line);
    let (mut product, mut square) = (0.0, 0.0);
    for ((one, line), expected) in coefficients.iter().zip(&line).zip(expected) {
        product += one * line / expected;
        square += line * line / expected;
    }
    let far = product / square;
    let pairs = coefficients.iter().zip(&line);
    let left = pairs
        .map(|(one, line)| (one - far * line).powi(2))
        .collect();
    (left, far.abs())
}

/// Coefficients of the cosine transform of values without a mean, but for the first, each over its root mean square for
/// white noise of variance 1.
pub fn cosine_coefficients(values: impl DoubleEndedIterator<Item = f64> + Clone) -> Vec<f64> {
    let mut mirrored: Vec<f64> = values.clone().chain(values.rev()).collect();
    let count = mirrored.len() / 2;
    let plan = fft::real_forward(2 * count);
    let mut ordinates = plan.make_output_vec();
    // The buffers are the plan's own: it cannot fail.
    if plan.process(&mut mirrored, &mut ordinates).is_err() {
        return Vec::new();
    }
    let coefficient = |k: usize| {
        let turn = Complex64::cis(-0.5 * PI * k as f64 / count as f64);
        (turn * ordinates[k]).re / ((2 * count) as f64).sqrt()
    };
    (1..count).map(coefficient).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_count_is_bridged() {
        let mut values = [9.0, 1.0, 9.0, 9.0, 4.0, 9.0];
        let counts = [false, true, false, false, true, false];
        bridge(&mut values, &counts);
        assert_eq!(values, [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
        let mut nothing = [9.0; 3];
        bridge(&mut nothing, &[false; 3]);
        assert_eq!(nothing, [9.0; 3]);
    }

    #[test]
    fn nothing_is_left_of_a_straight_course() {
        let line = (0..40).map(|n| 0.25 * f64::from(n) - 0.25 * 19.5);
        let coefficients = cosine_coefficients(line);
        let (left, far) = without_straight(&coefficients, &[1.0; 39]);
        assert!((far - 10.0).abs() < 1e-9, "{far}");
        assert!(left.iter().all(|one| *one < 1e-18), "{left:?}");
    }
}
