//! One point of an Allan curve with its uncertainty.

use inm_allan::edf::Noise;
use inm_allan::identify::{Mixture, identify};
use inm_allan::{BlockEstimate, Estimate, Statistic, edf};

pub use inm_allan::interval;

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
    /// Equivalent degrees of freedom for the noise that the local slope of the curve shows.
    pub edf: f64,
    /// Lower end of the 95 % interval of the deviation.
    pub lo: f64,
    /// Upper end of the 95 % interval of the deviation.
    pub hi: f64,
    /// Whether it is made from block means across gaps, for want of whole differences.
    pub bridged: bool,
    /// How many times too large the variance comes out for white noise; 1 unless bridged.
    pub white_bias: f64,
}

impl Point {
    /// The deviation.
    pub fn deviation(&self) -> f64 {
        self.variance.sqrt()
    }
}

/// Points of a curve from the estimates of `statistic`, ascending in `m`, in counts.
///
/// The interval is that of a chi-squared variable with the equivalent degrees of freedom of the
/// locally identified noise. (Greenhall and Riley 2003; NIST SP 1065, section 5.4.)
pub fn points(
    statistic: Statistic,
    estimates: &[Estimate],
    rate_hz: f64,
    scale: f64,
) -> Vec<Point> {
    let whole = |(&estimate, noise)| {
        let one = BlockEstimate {
            estimate,
            white_bias: 1.0,
        };
        point(statistic, &one, noise, rate_hz, scale)
    };
    let noise = (0..estimates.len()).map(|at| identify(statistic, estimates, at));
    estimates.iter().zip(noise).map(whole).collect()
}

/// Points of an Allan curve whose averaging times from `bridged` on are block means.
///
/// Block means are left out where quantisation noise rules before them: it no longer cancels at
/// the edges of gaps, and they would be too large by an unknown factor.
pub fn allan_points(
    estimates: &[Estimate],
    bridged: &[BlockEstimate],
    rate_hz: f64,
    scale: f64,
) -> Vec<Point> {
    let mut points = points(Statistic::Allan, estimates, rate_hz, scale);
    let cancels = |noise: &Mixture| noise.first == Noise::Quantisation && noise.share < 0.5;
    let last = estimates.len().checked_sub(1);
    let last = last.map(|at| identify(Statistic::Allan, estimates, at));
    if last.as_ref().is_some_and(cancels) {
        return points;
    }
    let means: Vec<Estimate> = bridged.iter().map(|one| one.estimate).collect();
    let noise = (0..means.len()).map(|at| identify(Statistic::Allan, &means, at));
    let bridged = bridged.iter().zip(noise).map(|(one, noise)| Point {
        bridged: true,
        ..point(Statistic::Allan, one, noise, rate_hz, scale)
    });
    points.extend(bridged);
    points
}

fn point(
    statistic: Statistic,
    &BlockEstimate {
        estimate,
        white_bias,
    }: &BlockEstimate,
    noise: Mixture,
    rate_hz: f64,
    scale: f64,
) -> Point {
    let Estimate {
        m,
        terms,
        stride,
        variance,
    } = estimate;
    let variance = variance * scale * scale;
    let edf = noise.edf(|noise| edf::edf(statistic, noise, m, stride, terms));
    let (lo, hi) = interval(variance, edf);
    Point {
        m,
        tau_s: m as f64 / rate_hz,
        variance,
        terms,
        stride,
        edf,
        // What the bias may have added, the interval takes back.
        lo: lo / white_bias.sqrt(),
        hi,
        bridged: false,
        white_bias,
    }
}
