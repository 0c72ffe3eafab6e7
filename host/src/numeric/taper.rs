//! Ends that rise smoothly, so that a part of a record does not leak.

use std::f64::consts::TAU;

/// Hann's taper at `place` of a stretch of `length`, in the same unit: zero at both ends, one in the
/// middle.
pub fn hann(place: f64, length: f64) -> f64 {
    0.5 - 0.5 * (TAU * place / length).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rises_from_nothing_to_one_with_three_eighths_of_the_power() {
        assert_eq!(hann(0.0, 8.0), 0.0);
        assert_eq!(hann(4.0, 8.0), 1.0);
        let squares = (0..64).map(|n| hann(f64::from(n) + 0.5, 64.0).powi(2));
        assert!((squares.sum::<f64>() / 64.0 - 0.375).abs() < 1e-14);
    }
}
