//! The law of a stretch of a real record: its own spectrum, smoothed.

use std::f64::consts::TAU;

use super::cosines::cosines;

/// Ordinates of a point at least: the mean of sixteen logarithms is known to 0.55, 2.4 dB.
const ORDINATES: usize = 16;

/// Points an octave where there are more ordinates than that: bends of an order are met, single lines are not.
const AN_OCTAVE: f64 = 12.0;

/// Mean of the logarithm of chi-squared with one degree of freedom: `-gamma - ln 2`.
const MEAN_LOG: f64 = -1.270_362_845;

/// Share of the rate above which a density counts as that of noise without a memory, where strength is multiplied.
const SHORT: f64 = 0.01;

/// A two-sided density, per hertz, by points; a line in both logarithms between two of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Logarithms of frequency in hertz and density, ascending.
    points: Vec<(f64, f64)>,
    /// Where noise without a memory begins, hertz.
    short_hz: f64,
}

impl Measured {
    /// From the [cosine transform](cosines) of `samples`. Means are over logarithms, which single lines and events
    /// move little. None where a stretch of the spectrum is empty: a constant.
    pub fn of(samples: &[f64], rate_hz: f64) -> Option<Self> {
        let n = samples.len();
        let spacing_hz = rate_hz / (2 * n) as f64;
        let coefficients = cosines(samples);
        let (mut points, mut from) = (Vec::new(), 1);
        while from < n {
            let wide = (from as f64 * (1.0 / AN_OCTAVE).exp2()).ceil() as usize;
            let mut to = wide.max(from + ORDINATES).min(n);
            if n - to < ORDINATES {
                to = n;
            }
            let logs = coefficients[from..to]
                .iter()
                .map(|c| (c * c / rate_hz).ln());
            let mean = logs.sum::<f64>() / (to - from) as f64 - MEAN_LOG;
            if !mean.is_finite() {
                return None;
            }
            let middle_hz = 0.5 * (from + to - 1) as f64 * spacing_hz;
            points.push((middle_hz.ln(), mean));
            from = to;
        }
        Some(Self {
            points,
            short_hz: SHORT * rate_hz,
        })
    }

    /// At `f_hz`; beyond the first and last point on the line through the two next to it.
    pub fn density(&self, f_hz: f64) -> f64 {
        let log = f_hz.ln();
        let above = self.points.partition_point(|(at, _)| *at < log);
        let first = above.clamp(1, self.points.len().max(2) - 1) - 1;
        match self.points.get(first..first + 2) {
            Some(&[(a_hz, a), (b_hz, b)]) => (a + (b - a) * (log - a_hz) / (b_hz - a_hz)).exp(),
            _ => self
                .points
                .first()
                .map_or(0.0, |(_, density)| density.exp()),
        }
    }

    /// Share of the power at `f_hz` that a factor on the strength multiplies: what is faster than a hundred samples.
    pub fn short(&self, f_hz: f64) -> f64 {
        1.0 / (1.0 + (self.short_hz / f_hz).powi(2))
    }

    /// Densities of white noise and of a walk that this law has at its top and at its bottom: N and K.
    pub fn ends(&self) -> (f64, f64) {
        let (bottom, top) = (self.points.first(), self.points.last());
        let white = top.map_or(0.0, |(_, density)| density.exp());
        let walk = bottom.map_or(0.0, |(f, density)| (TAU * f.exp()).powi(2) * density.exp());
        (white.sqrt(), walk.sqrt())
    }
}
