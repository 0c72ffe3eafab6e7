//! The strength of the noise over time, where it is known.

use std::f64::consts::TAU;

/// A course of the strength of the noise: a cosine about its mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    /// How far the standard deviation swings about its mean, over that mean; 0 to 1.
    pub depth: f64,
    /// Period, samples; above zero.
    pub period: f64,
    /// Phase at the first sample, radians.
    pub phase_rad: f64,
}

impl Envelope {
    /// Standard deviation over a period of the power of what it multiplies, over its mean.
    pub fn power_sd(&self) -> f64 {
        let square = self.depth * self.depth;
        // That of 2 a cos + a^2 cos(2 w) / 2.
        (2.0 * square + 0.125 * square * square).sqrt() / (1.0 + 0.5 * square)
    }

    /// Factor on the standard deviation at a sample. Its mean square over a period is one, so that what is
    /// multiplied keeps its mean spectrum.
    pub fn factor(&self, index: usize) -> f64 {
        // Whole periods are taken off first, or the cosine of a large angle would be rounded.
        let cycles = (index as f64 / self.period).fract();
        let swing = self.depth * (TAU * cycles + self.phase_rad).cos();
        (1.0 + swing) / (1.0 + 0.5 * self.depth * self.depth).sqrt()
    }
}

/// The mean square of noise of which a `share` has the mean square `square`, and the rest one.
pub fn of_share(share: f64, square: f64) -> f64 {
    1.0 - share + share * square
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_square_over_whole_periods_is_one() {
        for (depth, period, phase_rad) in [(0.0, 100.0, 0.0), (0.4, 12.5, 2.0), (1.0, 1000.0, -1.0)]
        {
            let envelope = Envelope {
                depth,
                period,
                phase_rad,
            };
            // Squares hold twice the frequency at most: sums over whole periods are exact.
            let squares = (0..1000).map(|index| envelope.factor(index).powi(2));
            let mean = squares.sum::<f64>() / 1000.0;
            assert!((mean - 1.0).abs() < 1e-12, "{envelope:?}: {mean}");
            let most = 1.0 + depth;
            assert!((0..1000).all(|index| envelope.factor(index).abs() <= most));
        }
    }
}
