//! How often the whitened record takes which values: normal where the model is the whole truth.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::result::views::Counts;

/// Width of a class, standard deviations: a choice, for the eye.
pub const WIDTH: f64 = 0.25;

/// Classes on either side of zero, 20 standard deviations; the outermost hold all that lies beyond.
const CLASSES: usize = 80;

impl Counts {
    /// Of what is left of an axis, whitened by what its spectrum is. Samples that are missing or
    /// masked do not count.
    pub fn new(axis: &AxisState) -> Self {
        let seen = axis.whitened();
        let rate_hz = axis.rate_hz;
        // Bands that are excluded and what a converter shuts out are no part of it; the rest is scaled
        // back to a deviation of one.
        let kept = |k: usize| k < seen.top && seen.density[k].is_finite();
        let all = seen.density.len();
        let share = (0..all).filter(|&k| kept(k)).count() as f64 / all as f64;
        let response = |k: usize| match kept(k) {
            true => (share * seen.density[k] * rate_hz).sqrt().recip(),
            false => 0.0,
        };
        let white = seen.transform.filtered(|k| response(k).into());
        let mut counts = vec![0; 2 * CLASSES];
        for (index, value) in white.iter().enumerate() {
            if axis.usable(index) {
                let class = (value / WIDTH + CLASSES as f64).clamp(0.0, 2.0 * CLASSES as f64 - 1.0);
                counts[class as usize] += 1;
            }
        }
        Self { counts }
    }

    /// How many samples were counted, in all classes.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// Classes as (lower end in standard deviations, count).
    pub fn classes(&self) -> impl Iterator<Item = (f64, u64)> + '_ {
        let low = |class: usize| (class as f64 - CLASSES as f64) * WIDTH;
        self.counts
            .iter()
            .enumerate()
            .map(move |(class, &count)| (low(class), count))
    }

    /// Standard deviations within which all samples lie, to the end of a class.
    pub fn reach(&self) -> f64 {
        let filled = self.classes().filter(|(_, count)| *count > 0);
        filled.fold(0.0, |reach, (low, _)| {
            reach.max(low.abs()).max((low + WIDTH).abs())
        })
    }
}
