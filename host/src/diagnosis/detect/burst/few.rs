//! Whether a stretch is louder by a few of its samples alone.

use std::ops::Range;

use realfft::num_complex::Complex64;

use super::Burst;
use crate::diagnosis::axis::AxisState;
use crate::numeric::order::quantile;

/// Share of the largest samples of a stretch that are its few: a choice. Of single samples that come now and then no
/// stretch holds more, and most of what rings or swells is above the rest anywhere else.
const FEW: f64 = 0.25;

/// Part of the logarithm of a stretch's power that must be left without its few: a choice. Of normal noise all is left,
/// of single samples in noise like that outside nothing.
const LEFT: f64 = 0.25;

/// Whether a `burst` is as loud as the rest of an axis but for a few large samples: then they are what is there.
///
/// The quantiles of the absolute whitened samples at `1 - FEW` are compared, within and outside; of noise of one law their
/// ratio is that of the deviations, however large the samples beyond them are.
pub fn carry(axis: &AxisState, burst: &Burst) -> bool {
    if burst.factor <= 1.0 {
        return false;
    }
    let seen = axis.whitened();
    let white = seen
        .transform
        .filtered(|k| Complex64::new(seen.density[k].sqrt().recip(), 0.0));
    let range = burst.range.start..burst.range.end.min(white.len());
    let beyond = |range: Range<usize>| {
        let there = range.filter(|n| axis.usable(*n));
        let mut sizes: Vec<f64> = there.map(|n| white[n].abs() / axis.envelope(n)).collect();
        quantile(&mut sizes, 1.0 - FEW)
    };
    let (before, after) = (0..range.start, range.end..white.len());
    let outside = if before.len() > after.len() {
        before
    } else {
        after
    };
    match (beyond(range), beyond(outside)) {
        (Some(inside), Some(outside)) => inside / outside < burst.factor.powf(LEFT),
        _ => false,
    }
}
