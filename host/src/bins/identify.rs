//! Which noise rules at an averaging time: by the local slope of the curve.
//!
//! The slope of `log variance` over `log tau` is -2 for quantisation (-3 in the modified
//! variance), -1 for white, 0 for flicker and +1 for walk noise. It is taken by least squares
//! over the points within an octave on either side. A ramp, steeper still, counts as walk noise.
//!
//! Where two types mix, the slope of their sum is the mean of their slopes, weighted by the share
//! of the variance that each makes up. So a slope between two types gives the share of each, and
//! the degrees of freedom follow without a jump from one type to the next.

use inm_allan::Statistic;
use inm_allan::edf::Noise;

/// A type of noise and the next one, as the slope tells them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mixture {
    /// The steeper falling one.
    pub first: Noise,
    /// The one with the next slope.
    pub second: Noise,
    /// What part of the variance is due to the second, 0 to 1.
    pub share: f64,
}

impl Mixture {
    /// One type alone.
    pub fn pure(noise: Noise) -> Self {
        Self {
            first: noise,
            second: noise,
            share: 0.0,
        }
    }

    /// The mixture that gives `slope`; white noise where there is none (NaN).
    fn of(statistic: Statistic, slope: f64) -> Self {
        if slope.is_nan() {
            return Self::pure(Noise::White);
        }
        let slopes = Noise::ALL.map(|noise| (noise, slope_of(statistic, noise)));
        for pair in slopes.windows(2) {
            if let &[(first, from), (second, to)] = pair
                && slope < to
            {
                let share = ((slope - from) / (to - from)).max(0.0);
                return Self {
                    first,
                    second,
                    share,
                };
            }
        }
        Self::pure(Noise::Walk)
    }

    /// Degrees of freedom of an estimate of which `edf` gives those for one type alone.
    ///
    /// The standard deviation of a sum is at most the sum of the standard deviations, and
    /// relative ones are `sqrt(2 / edf)`: the result is never too many.
    pub fn edf(self, edf: impl Fn(Noise) -> f64) -> f64 {
        if self.share == 0.0 || self.first == self.second {
            return edf(self.first);
        }
        let deviation =
            (1.0 - self.share) / edf(self.first).sqrt() + self.share / edf(self.second).sqrt();
        deviation.powi(-2)
    }
}

/// Slope of `log variance` over `log tau` in one type of noise.
fn slope_of(statistic: Statistic, noise: Noise) -> f64 {
    match noise {
        Noise::Quantisation if statistic == Statistic::Modified => -3.0,
        Noise::Quantisation => -2.0,
        Noise::White => -1.0,
        Noise::Flicker => 0.0,
        Noise::Walk => 1.0,
    }
}

/// Noise at each of `points`, given as averaging factor and variance, ascending.
pub fn identify(statistic: Statistic, points: &[(u64, f64)]) -> Vec<Mixture> {
    (0..points.len())
        .map(|at| Mixture::of(statistic, slope(points, at)))
        .collect()
}

/// Local slope of `log variance` over `log m` around point `at`.
fn slope(points: &[(u64, f64)], at: usize) -> f64 {
    let centre = points[at].0 as f64;
    let near = |&&(m, variance): &&(u64, f64)| {
        let ratio = m as f64 / centre;
        (0.499..=2.001).contains(&ratio) && variance > 0.0
    };
    let mut near: Vec<_> = points.iter().filter(near).collect();
    if near.len() < 2 {
        // Coarse averaging times: the neighbours, however far.
        near = points[at.saturating_sub(1)..(at + 2).min(points.len())]
            .iter()
            .filter(|point| point.1 > 0.0)
            .collect();
    }
    let logs = near
        .iter()
        .map(|(m, variance)| ((*m as f64).ln(), variance.ln()));
    let n = near.len() as f64;
    let (sx, sy) = logs
        .clone()
        .fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x, sy + y));
    let (mx, my) = (sx / n, sy / n);
    let (sxx, sxy) = logs.fold((0.0, 0.0), |(sxx, sxy), (x, y)| {
        (sxx + (x - mx) * (x - mx), sxy + (x - mx) * (y - my))
    });
    sxy / sxx
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_is(mixture: Mixture, noise: Noise, context: &str) {
        let Mixture {
            first,
            second,
            share,
        } = mixture;
        let of_noise =
            f64::from(first == noise) * (1.0 - share) + f64::from(second == noise) * share;
        assert!(of_noise > 1.0 - 1e-9, "{context}: {mixture:?}");
    }

    #[test]
    fn slopes_of_the_five_terms() {
        for statistic in [Statistic::Allan, Statistic::Modified, Statistic::Hadamard] {
            let steepest = slope_of(statistic, Noise::Quantisation);
            for (exponent, noise) in [
                (steepest, Noise::Quantisation),
                (-1.0, Noise::White),
                (0.0, Noise::Flicker),
                (1.0, Noise::Walk),
                (2.0, Noise::Walk),
            ] {
                for spacing in [2_u64, 10] {
                    let points: Vec<_> = (0..8)
                        .map(|k| spacing.pow(k))
                        .map(|m| (m, 3.0 * (m as f64).powf(exponent)))
                        .collect();
                    for mixture in identify(statistic, &points) {
                        assert_is(
                            mixture,
                            noise,
                            &format!("slope {exponent}, spacing {spacing}"),
                        );
                    }
                }
            }
            let flat = identify(statistic, &[(1, 0.0), (2, 0.0)]);
            assert_eq!(flat, [Mixture::pure(Noise::White); 2]);
            assert_eq!(
                identify(statistic, &[(1, 2.0)]),
                [Mixture::pure(Noise::White)]
            );
        }
    }

    #[test]
    fn degrees_of_freedom_do_not_jump() {
        let edf = |noise| match noise {
            Noise::Quantisation => 10_000.0,
            Noise::White => 100.0,
            Noise::Flicker => 80.0,
            Noise::Walk => 60.0,
        };
        let at = |slope| Mixture::of(Statistic::Allan, slope).edf(edf);
        for (slope, expected) in [
            (-2.5, 1e4),
            (-2.0, 1e4),
            (-1.0, 100.0),
            (0.0, 80.0),
            (2.0, 60.0),
        ] {
            assert!((at(slope) / expected - 1.0).abs() < 1e-12, "{slope}");
        }
        // Half and half: relative deviations of 1 % and 10 % add up to 5.5 % at most.
        assert!((at(-1.5) / 0.055_f64.powi(-2) - 1.0).abs() < 1e-12);
        let steps = (0..3000).map(|k| -2.5 + f64::from(k) * 1e-3);
        let values: Vec<f64> = steps.map(at).collect();
        assert!(
            values
                .windows(2)
                .all(|pair| (pair[1] / pair[0] - 1.0).abs() < 0.02)
        );
    }
}
