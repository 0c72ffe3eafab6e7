//! What is left of an axis that others may share: its noise, where nothing else is.
//!
//! A tone that wanders and that all axes see is no more a common noise than it is a noise, what nobody knows is none either, and what
//! happened came to all of them. Each reaches further than it is told, with what is too weak to be seen in one axis and is seen in two:
//! as far again to either side is left out with it.

use std::ops::Range;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::explanation::{Change, Explanation};
use crate::fft::ring::Series;

/// What is left of an axis, NaN where missing, masked or beside what happened.
pub fn left(axis: AxisState) -> Vec<f32> {
    let passed = passed(&axis);
    let happened: Vec<Range<usize>> = axis.explanations().iter().flat_map(happened).collect();
    let residual = axis.into_residual();
    let left = residual.values();
    let mut left: Vec<f32> = match passed {
        None => left.iter().map(|&value| value as f32).collect(),
        Some(passed) => {
            let pairs = left.iter().zip(passed.iter());
            pairs
                .map(|(left, passed)| (passed + 0.0 * left) as f32)
                .collect()
        }
    };
    for stretch in happened {
        let length = stretch.len();
        let from = stretch.start.saturating_sub(length);
        let to = (stretch.end + length).min(left.len());
        left[from.min(to)..to].fill(f32::NAN);
    }
    left
}

/// Stretches in which something happened.
fn happened(one: &Explanation) -> Vec<Range<usize>> {
    match &one.change {
        Change::Happened { masked, .. } => masked.clone(),
        _ => Vec::new(),
    }
}

/// An axis without the bands that are excluded or have no name, where there are any.
fn passed(axis: &AxisState) -> Option<Series> {
    let unnamed_hz = axis.unnamed_hz();
    if axis.excluded_hz().is_empty() && unnamed_hz.is_empty() {
        return None;
    }
    let mut out_hz = unnamed_hz;
    out_hz.extend(axis.tones_with_skirts_hz());
    let seen = axis.whitened();
    let is_in = |f_hz: f64| !out_hz.iter().any(|band| band.contains(&f_hz));
    let is_kept = |k: usize| seen.density[k].is_finite() && is_in(seen.transform.frequency(k));
    let passed = |k: usize| f64::from(u8::from(is_kept(k))).into();
    Some(seen.transform.filtered(passed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{RATE_HZ, Trial, line, noise};
    use crate::model::{shock, wandering_line};

    #[test]
    fn a_tone_is_left_out_with_its_skirts() {
        let seed = 60;
        let mut values = noise(seed);
        let count = values.len();
        // Lines of 30 in the tone's band, beside it, and beyond what is left out with it.
        for f_hz in [20.0, 21.5, 24.5] {
            crate::diagnosis::detect::trial::add(&mut values, &line(f_hz, 30.0));
        }
        let mut trial = Trial::new(values);
        let change = Change::Tone(vec![19.0..21.0]);
        trial.know(wandering_line::KIND, [20.0, 0.1, 1.0, 30.0], change);
        let left = left(trial.axis);
        let size = |f_hz: f64| {
            let turn = |n: usize| std::f64::consts::TAU * f_hz / RATE_HZ * n as f64;
            let (mut cosine, mut sine) = (0.0, 0.0);
            for (n, value) in left.iter().enumerate() {
                cosine += f64::from(*value) * turn(n).cos();
                sine += f64::from(*value) * turn(n).sin();
            }
            2.0 * f64::hypot(cosine, sine) / count as f64
        };
        // Of noise of deviation 1 a hundredth is in one line.
        for (f_hz, is_left) in [(20.0, 0.0), (21.5, 0.0), (24.5, 30.0)] {
            let size = size(f_hz);
            assert!(
                (size - is_left).abs() < 1.0,
                "seed {seed}: {f_hz} Hz {size}"
            );
        }
    }

    #[test]
    fn what_happened_is_left_out_with_what_is_beside_it() {
        let seed = 61;
        let mut trial = Trial::new(noise(seed));
        let change = Change::Happened {
            masked: vec![5000..5600, 300..900],
            waves: Vec::new(),
        };
        trial.know(shock::KIND, [50.0, 6.0, 0.0, 0.0, 1.0], change);
        let left = left(trial.axis);
        let is_out = |n: usize| left[n].is_nan();
        let out = (0..left.len()).filter(|n| is_out(*n)).count();
        assert_eq!(out, 1500 + 1800, "seed {seed}");
        assert!(is_out(0) && is_out(1499) && !is_out(1500), "seed {seed}");
        assert!(!is_out(4399) && is_out(4400) && is_out(6199), "seed {seed}");
    }
}
