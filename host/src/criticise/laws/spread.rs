//! How well the data tell the values of a law.

use nalgebra::DMatrix;

use super::{Law, component_of, fit, squared_power};
use crate::criticise::frame::Frame;
use crate::fit::likelihood::{Data, Fit};

/// Standard deviations of the logarithms of a law's values, everything else free: from the
/// curvature of the likelihood in all shapes, and the size's own beside it. Infinite where the data
/// do not tell.
pub fn log_deviations(
    frame: &Frame,
    data: &Data,
    laws: &[Law],
    which: usize,
    best: &Fit,
) -> Vec<f64> {
    let places: Vec<(usize, usize)> = (0..laws.len())
        .flat_map(|law| laws[law].shape().map(move |place| (law, place)))
        .collect();
    let at = |moves: &[(usize, f64)]| {
        let mut trial = laws.to_vec();
        for &(number, step) in moves {
            let (law, place) = places[number];
            trial[law].values[place] *= step.exp();
        }
        fit(frame, data, &trial)
    };
    let fall = |moves: &[(usize, f64)]| {
        at(moves).map_or(f64::NAN, |fit| best.log_likelihood - fit.log_likelihood)
    };
    // Steps that lose about half a nat.
    let steps: Vec<f64> = (0..places.len())
        .map(|number| {
            let mut step = 0.02_f64;
            for _ in 0..8 {
                let loss = 0.5 * (fall(&[(number, step)]) + fall(&[(number, -step)]));
                if (0.2..1.5).contains(&loss) {
                    break;
                }
                step *= if loss > 0.0 {
                    (0.5 / loss).sqrt().clamp(0.1, 5.0)
                } else {
                    3.0
                };
                step = step.min(1.0);
            }
            step
        })
        .collect();
    let size = places.len();
    let curvature = DMatrix::from_fn(size, size, |i, j| {
        if i > j {
            return 0.0;
        }
        let (a, b) = (steps[i], steps[j]);
        if i == j {
            (fall(&[(i, a)]) + fall(&[(i, -a)])) / (a * a)
        } else {
            let same = fall(&[(i, a), (j, b)]) + fall(&[(i, -a), (j, -b)]);
            let other = fall(&[(i, a), (j, -b)]) + fall(&[(i, -a), (j, b)]);
            (same - other) / (4.0 * a * b)
        }
    });
    let curvature = DMatrix::from_fn(size, size, |i, j| curvature[(i.min(j), i.max(j))]);
    let covariance = curvature.try_inverse();
    let variance = |number: usize| {
        covariance
            .as_ref()
            .map_or(f64::NAN, |covariance| covariance[(number, number)])
    };
    let own = |law: &Law, place: usize| -> f64 {
        if law.effect.size() != Some(place) {
            let number = places.iter().position(|&one| one == (which, place));
            return number.map_or(f64::NAN, variance);
        }
        let component = component_of(frame, laws, which);
        let squared = best.squared[component];
        let mut total = best.covariance[(component, component)] / (squared * squared);
        // What the shapes' own uncertainty adds.
        if let Some(covariance) = &covariance {
            let slopes: Vec<f64> = (0..size)
                .map(|number| {
                    let log = |step: f64| {
                        at(&[(number, step)])
                            .map_or(0.0, |fit| fit.squared[component].max(1e-300).ln())
                    };
                    (log(steps[number]) - log(-steps[number])) / (2.0 * steps[number])
                })
                .collect();
            for (i, a) in slopes.iter().enumerate() {
                for (j, b) in slopes.iter().enumerate() {
                    total += a * b * covariance[(i, j)];
                }
            }
        }
        // Of the size itself where that is the root of the component.
        total / squared_power(law).powi(2)
    };
    let law = &laws[which];
    (0..law.values.len())
        .map(|place| {
            let variance = own(law, place);
            if variance.is_finite() && variance > 0.0 {
                variance.sqrt()
            } else {
                f64::INFINITY
            }
        })
        .collect()
}
