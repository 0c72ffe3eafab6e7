//! One point of an Allan curve with its uncertainty.

use inm_allan::edf::{self, Noise};
use inm_allan::{Estimate, Statistic};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::identify::identify;

/// Probability that the interval leaves out on each side.
const TAIL: f64 = 0.025;

/// An estimate of a deviation, in the unit of the signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Averaging time in data periods.
    pub m: u64,
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// The estimated variance, in the square of the signal's unit.
    pub variance: f64,
    /// Squared differences that were averaged.
    pub terms: u64,
    /// Distance between neighbouring differences, data periods.
    pub stride: u64,
    /// Noise type taken for the interval, from the local slope of the curve.
    pub noise: Noise,
    /// Equivalent degrees of freedom for that noise.
    pub edf: f64,
    /// Lower end of the 95 % interval of the deviation.
    pub lo: f64,
    /// Upper end of the 95 % interval of the deviation.
    pub hi: f64,
}

impl Point {
    /// The deviation.
    pub fn deviation(&self) -> f64 {
        self.variance.sqrt()
    }
}

/// Averages in a record below which the slope of the curve is chance.
const FEW_AVERAGES: u64 = 16;

/// Points of a curve from the estimates of `statistic`, ascending in `m`, in counts.
///
/// The interval is that of a chi-squared variable with the equivalent degrees of freedom of
/// the locally identified noise type. Where the record holds only few averages the slope itself
/// is uncertain, and the type found at the last sound point stands. (Greenhall and Riley 2003; NIST SP 1065, section 5.4.)
pub fn points(
    statistic: Statistic,
    estimates: &[Estimate],
    rate_hz: f64,
    scale: f64,
) -> Vec<Point> {
    let curve: Vec<_> = estimates.iter().map(|one| (one.m, one.variance)).collect();
    let mut sound = None;
    let mut point = |(estimate, noise): (&Estimate, Noise)| {
        let &Estimate {
            m,
            terms,
            stride,
            variance,
        } = estimate;
        let few = terms.saturating_mul(stride) / m < FEW_AVERAGES;
        let noise = if few { sound.unwrap_or(noise) } else { noise };
        sound = Some(noise);
        let variance = variance * scale * scale;
        let edf = edf::edf(statistic, noise, m, stride, terms);
        let (lo, hi) = interval(variance, edf);
        Point {
            m,
            tau_s: m as f64 / rate_hz,
            variance,
            terms,
            stride,
            noise,
            edf,
            lo,
            hi,
        }
    };
    estimates
        .iter()
        .zip(identify(&curve))
        .map(&mut point)
        .collect()
}

/// 95 % interval of the deviation whose square was estimated with `edf` degrees of freedom.
fn interval(variance: f64, edf: f64) -> (f64, f64) {
    let Ok(chi) = ChiSquared::new(edf) else {
        return (0.0, f64::INFINITY);
    };
    let end = |probability: f64| (variance * edf / chi.inverse_cdf(probability)).sqrt();
    (end(1.0 - TAIL), end(TAIL))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interval_of_known_degrees_of_freedom() {
        // Chi-squared with 10 degrees of freedom: 3.24697 and 20.48318.
        let (lo, hi) = interval(4.0, 10.0);
        assert!((lo - (40.0_f64 / 20.483_177).sqrt()).abs() < 1e-5, "{lo}");
        assert!((hi - (40.0_f64 / 3.246_973).sqrt()).abs() < 1e-5, "{hi}");
    }
}
