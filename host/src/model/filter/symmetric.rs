//! A filter that changes the strength of frequencies and not their phase.

use std::f64::consts::PI;

/// Samples on either side of the middle one that a filter reaches: a response is met where it bends over no less than a
/// hundredth of the rate, and the kink at half the rate that its mirror image makes of it fades as the square of this.
pub const REACH: usize = 128;

/// A symmetric filter over windows of a stream; what does not change has gain one.
pub struct SymmetricFilter {
    taps: Vec<f64>,
    /// Samples that windows to come begin with.
    past: Vec<f64>,
}

impl SymmetricFilter {
    /// With the amplitude response `gain` at a share, 0 to 1, of half the rate, over that at zero.
    pub fn new(gain: impl Fn(f64) -> f64) -> Self {
        // Response at equal steps to half the rate, back to time, and a taper over its ends.
        const STEPS: usize = 8 * REACH;
        let gains: Vec<f64> = (0..=STEPS)
            .map(|step| gain(step as f64 / STEPS as f64))
            .collect();
        let tap = |lag: usize| {
            let sum: f64 = (0..=STEPS)
                .map(|step| {
                    let share = if step == 0 || step == STEPS { 0.5 } else { 1.0 };
                    share * gains[step] * (PI * (lag * step) as f64 / STEPS as f64).cos()
                })
                .sum();
            let taper = 0.5 + 0.5 * (PI * lag as f64 / (REACH + 1) as f64).cos();
            sum / STEPS as f64 * taper
        };
        let half: Vec<f64> = (0..=REACH).map(tap).collect();
        let taps: Vec<f64> = (1..=REACH)
            .rev()
            .map(|lag| half[lag])
            .chain(half.iter().copied())
            .collect();
        let total: f64 = taps.iter().sum();
        Self {
            taps: taps.iter().map(|tap| tap / total).collect(),
            past: Vec::new(),
        }
    }

    /// What comes of further samples, each in the middle of its window: the last [`REACH`] wait, and before as many have
    /// come on either side nothing comes out.
    pub fn pass(&mut self, samples: &[f64]) -> Vec<f64> {
        self.past.extend_from_slice(samples);
        let windows = self.past.windows(self.taps.len());
        let sums = windows.map(|window| {
            let products = window.iter().zip(&self.taps);
            products.map(|(value, tap)| value * tap).sum::<f64>()
        });
        let out = sums.collect();
        let rest = self.past.len().saturating_sub(2 * REACH);
        self.past.drain(..rest);
        out
    }

    /// Power response at an angular frequency, radians a sample.
    #[cfg(test)]
    pub fn power(&self, radians: f64) -> f64 {
        let lags = (0..self.taps.len()).map(|tap| tap as f64 - REACH as f64);
        let terms = lags.zip(&self.taps);
        terms
            .map(|(lag, tap)| tap * (lag * radians).cos())
            .sum::<f64>()
            .powi(2)
    }
}
