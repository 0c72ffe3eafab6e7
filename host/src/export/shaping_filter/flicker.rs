//! Flicker noise, which no finite system makes, as a bank of Markov processes.

use nalgebra::{DMatrix, DVector};

use super::exact::markov_block;
use crate::export::state_space::StateSpace;
use crate::model::Term;
use crate::model::flicker::Flicker;
use crate::model::markov::Markov;

/// Ratio of neighbouring correlation times of the flicker bank: 0.5 % of ripple in deviation.
const SPACING: f64 = 6.0;

/// Flicker noise as Markov processes. Their variances are fitted to the spectrum from below
/// `1 / longest_s` to half the rate, by relative least squares with no variance negative.
pub(super) fn flicker(level: f64, rate_hz: f64, longest_s: f64) -> StateSpace {
    let (fastest_s, slowest_s) = (0.2 / rate_hz, 2.0 * longest_s);
    let count = ((slowest_s / fastest_s).ln() / SPACING.ln())
        .ceil()
        .max(1.0) as usize
        + 1;
    let step = (slowest_s / fastest_s).powf(1.0 / (count - 1) as f64);
    let unit = |k: usize| Markov {
        deviation: 1.0,
        time_s: fastest_s * step.powi(k as i32),
    };
    let flicker = Flicker { level };
    let lowest_hz = 0.25 / longest_s;
    let points = 16 * count;
    let f_hz = |point: usize| {
        lowest_hz * (0.5 * rate_hz / lowest_hz).powf((point as f64 + 0.5) / points as f64)
    };
    let ratios = DMatrix::from_fn(points, count, |point, k| {
        unit(k).spectrum(f_hz(point), rate_hz) / flicker.spectrum(f_hz(point), rate_hz)
    });
    let variances = non_negative(&ratios);
    let mut system = StateSpace::empty();
    for (k, variance) in variances.iter().enumerate().filter(|(_, v)| **v > 0.0) {
        let markov = Markov {
            deviation: variance.sqrt(),
            ..unit(k)
        };
        let name = format!("flicker, {:.3e} s", markov.time_s);
        system = system.plus(&markov_block(&name, markov, rate_hz));
    }
    system
}

/// Non-negative `x` with `a x` near 1 in least squares, for `a` without negative elements: the
/// multiplicative iteration of Daube-Witherspoon and Muehllehner (1986), which keeps signs.
fn non_negative(a: &DMatrix<f64>) -> DVector<f64> {
    let target = a.row_sum_tr();
    let normal = a.transpose() * a;
    let mut x = DVector::from_fn(a.ncols(), |k, _| target[k] / normal.row(k).sum());
    // Columns differ by orders of magnitude; the iteration does not mind.
    for _ in 0..5000 {
        let predicted = &normal * &x;
        x = x.zip_zip_map(&target, &predicted, |x, wanted, got| x * wanted / got);
    }
    x
}
