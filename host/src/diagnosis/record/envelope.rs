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

    /// Mean square at a sample as the ordinates of a band show it at moments of so many `samples` each. What is cut off sharply in
    /// frequency spreads in time as the square of a sine over its argument, whose spectrum is a triangle: of what swings `n` times
    /// in a moment it keeps the part `1 - n`.
    pub fn square_over(&self, sample: f64, samples: f64) -> f64 {
        let phase_rad = TAU * (sample / self.period).fract() + self.phase_rad;
        let kept = |swings: f64| (1.0 - swings * samples / self.period).max(0.0);
        let square = 0.5 * self.depth * self.depth;
        let once = 2.0 * self.depth * kept(1.0) * phase_rad.cos();
        let twice = square * kept(2.0) * (2.0 * phase_rad).cos();
        1.0 + (once + twice) / (1.0 + square)
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
    fn what_a_band_shows_of_the_strength_is_what_it_keeps_of_its_swings() {
        let envelope = Envelope {
            depth: 0.9,
            period: 1000.0,
            phase_rad: 0.7,
        };
        // Moments of 250 samples: weights of the square of a sine over its argument, cut off where a thousandth is left.
        let weight = |x: f64| {
            let turn = std::f64::consts::PI * x / 250.0;
            if turn == 0.0 {
                1.0
            } else {
                (turn.sin() / turn).powi(2)
            }
        };
        const AT: i32 = 400_000;
        for at in [AT, AT + 130, AT + 555] {
            let around = -100_000..=100_000;
            let mean: f64 = around
                .map(|n| weight(f64::from(n)) * envelope.factor((at + n) as usize).powi(2))
                .sum();
            let shown = envelope.square_over(f64::from(at), 250.0);
            assert!((mean / 250.0 - shown).abs() < 2e-3, "{at}: {mean}, {shown}");
        }
        // Of single samples all, of whole periods none.
        let of_sample = envelope.square_over(123.0, 0.0);
        assert!((of_sample - envelope.factor(123).powi(2)).abs() < 1e-12);
        assert_eq!(envelope.square_over(123.0, 1000.0), 1.0);
    }

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
