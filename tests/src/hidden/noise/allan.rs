//! The Allan variance to expect: of noise from its density, of a course from its values.

use std::f64::consts::PI;

/// Points of the sum over frequencies: at 2000/s and with all averages below a tenth of a minute
/// a hundred or more to each swing of the kernel.
const POINTS: u32 = 1 << 18;

/// Of sampled noise with the two-sided `density`, per hertz, for averages over each of `ms` samples:
/// `2 int_0^{rate/2} S(f) 2 sin^4(m x) / (m sin x)^2 df` with `x = pi f / rate` (Pavlov and Petrov eq.
/// 7 with a sum over samples for the integral over time).
pub fn of_law(rate_hz: f64, ms: &[u64], density: impl Fn(f64) -> f64) -> Vec<f64> {
    let step_hz = 0.5 * rate_hz / f64::from(POINTS);
    let mut variances = vec![0.0; ms.len()];
    for point in 0..POINTS {
        let f_hz = (f64::from(point) + 0.5) * step_hz;
        let x = PI * f_hz / rate_hz;
        let weight = 4.0 * density(f_hz) * step_hz / x.sin().powi(2);
        for (variance, &m) in variances.iter_mut().zip(ms) {
            let m = m as f64;
            *variance += weight * ((m * x).sin().powi(2) / m).powi(2);
        }
    }
    variances
}

/// Of a course as it is: half the mean square of all differences of neighbouring averages over `m`
/// values. Zero where there is none.
pub fn of_course(values: &[f64], ms: &[u64]) -> Vec<f64> {
    let start = values.first().copied().unwrap_or(0.0);
    let mut sum = 0.0;
    let mut sums = vec![0.0];
    sums.extend(values.iter().map(|value| {
        sum += value - start;
        sum
    }));
    let variance = |&m: &u64| {
        let m = m as usize;
        let differences = sums
            .windows(2 * m + 1)
            .map(|s| s[2 * m] - 2.0 * s[m] + s[0]);
        let count = sums.len().saturating_sub(2 * m).max(1) as f64;
        let squares: f64 = differences.map(|one| one * one).sum();
        squares / (2.0 * count * (m * m) as f64)
    };
    ms.iter().map(variance).collect()
}
