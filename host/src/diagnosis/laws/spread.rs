//! How well the data determine the values of laws together with the base squares.

use nalgebra::DMatrix;

use crate::diagnosis::laws::{Law, component_of, fit, sized, squared_power};
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::result::value::Value;
use crate::fit::likelihood::{Data, Fit};
use crate::model::effect::Quantity;
use crate::model::unnamed;

/// Uncertainty of a fit with laws: covariance of the logarithms of all shapes, from the curvature of
/// the likelihood with all sizes free, and how the squares move with the shapes.
pub struct Spread<'a> {
    bins: &'a SpectralBins,
    laws: &'a [Law],
    best: &'a Fit,
    /// Law and place of each shape.
    places: Vec<(usize, usize)>,
    /// `None` where the data do not distinguish the shapes.
    covariance: Option<DMatrix<f64>>,
    /// Slope of each square in the logarithm of each shape.
    slopes: Vec<Vec<f64>>,
}

impl<'a> Spread<'a> {
    /// The spread about the fit `best` of the five terms and the `laws`. What has no name keeps its shape.
    pub fn new(bins: &'a SpectralBins, data: &Data, laws: &'a [Law], best: &'a Fit) -> Self {
        let places: Vec<(usize, usize)> = (0..laws.len())
            .filter(|&law| laws[law].effect != unnamed::KIND)
            .flat_map(|law| laws[law].shape().map(move |place| (law, place)))
            .collect();
        let at = |moves: &[(usize, f64)]| {
            let mut trial = laws.to_vec();
            for &(number, step) in moves {
                let (law, place) = places[number];
                trial[law].values[place] *= step.exp();
            }
            fit(bins, data, &trial)
        };
        // The best fit may be that of other bins, those of tones among them.
        let here = at(&[]).map_or(f64::NAN, |fit| fit.log_likelihood);
        let fall =
            |moves: &[(usize, f64)]| at(moves).map_or(f64::NAN, |fit| here - fit.log_likelihood);
        let steps: Vec<f64> = (0..places.len())
            .map(|number| {
                step_of_half_a_nat(|step| {
                    0.5 * (fall(&[(number, step)]) + fall(&[(number, -step)]))
                })
            })
            .collect();
        let curvature = curvature(&steps, fall);
        let moved: Vec<_> = steps
            .iter()
            .enumerate()
            .map(|(number, &step)| (at(&[(number, step)]), at(&[(number, -step)])))
            .collect();
        let slopes = (0..best.squared.len())
            .map(|component| {
                let pairs = moved.iter().zip(&steps);
                pairs
                    .map(|((up, down), step)| match (up, down) {
                        (Some(up), Some(down)) => {
                            (up.squared[component] - down.squared[component]) / (2.0 * step)
                        }
                        _ => f64::NAN,
                    })
                    .collect()
            })
            .collect();
        Self {
            covariance: curvature.try_inverse(),
            bins,
            laws,
            best,
            places,
            slopes,
        }
    }

    /// Standard deviation of the square of a component, the shapes' uncertainty included.
    pub fn square_sd(&self, component: usize) -> f64 {
        let mut variance = self.best.covariance[(component, component)];
        if let Some(covariance) = &self.covariance {
            let slopes = &self.slopes[component];
            for (i, a) in slopes.iter().enumerate() {
                for (j, b) in slopes.iter().enumerate() {
                    variance += a * b * covariance[(i, j)];
                }
            }
        }
        variance.max(0.0).sqrt()
    }

    /// The values of a law with the size that the fit gives it, each with its interval.
    pub fn values(&self, which: usize) -> Vec<Value> {
        let values = sized(self.bins, self.laws, which, self.best);
        let law = &self.laws[which];
        let parameters = law.effect.parameters(&values);
        let all = values
            .iter()
            .zip(self.log_deviations(which))
            .zip(parameters);
        all.map(|((value, sd), parameter)| match parameter.quantity {
            // Another count is another filter.
            Quantity::Count => Value::exact(*value),
            _ => Value::log_normal(*value, sd),
        })
        .collect()
    }

    /// Standard deviations of the logarithms of a law's values. Infinite where the data do not determine one.
    pub fn log_deviations(&self, which: usize) -> Vec<f64> {
        let law = &self.laws[which];
        let own = |place: usize| -> f64 {
            if law.effect.size() == Some(place) {
                let component = component_of(self.bins, self.laws, which);
                // Of the size itself, of which the square is a power.
                self.square_sd(component) / self.best.squared[component] / squared_power(law)
            } else {
                let number = self.places.iter().position(|&one| one == (which, place));
                let covariance = self.covariance.as_ref();
                number
                    .zip(covariance)
                    .map_or(f64::NAN, |(number, covariance)| {
                        covariance[(number, number)].sqrt()
                    })
            }
        };
        (0..law.values.len())
            .map(own)
            .map(|sd| {
                if sd.is_finite() && sd > 0.0 {
                    sd
                } else {
                    f64::INFINITY
                }
            })
            .collect()
    }
}

/// Second differences of the log-likelihood, which falls by `fall` where shapes take these steps.
fn curvature(steps: &[f64], fall: impl Fn(&[(usize, f64)]) -> f64) -> DMatrix<f64> {
    let size = steps.len();
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
    DMatrix::from_fn(size, size, |i, j| curvature[(i.min(j), i.max(j))])
}

/// Step at which the likelihood has lost about half a nat, by its `loss`.
fn step_of_half_a_nat(loss: impl Fn(f64) -> f64) -> f64 {
    let mut step = 0.02_f64;
    for _ in 0..8 {
        let loss = loss(step);
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::{axis, law, long, ringing, take_in};
    use crate::model::resonance;

    #[test]
    fn what_other_bins_add_to_the_best_fit_does_not_matter() {
        for seed in 2..5 {
            let mut rings = ringing(seed, 100.0, 10.0);
            let mut axis = axis(seed, long(seed), |_, noise| noise + rings());
            let bell = law(resonance::KIND, &[100.0, 10.0, 1.0]);
            take_in(&mut axis, resonance::KIND, bell);
            let deviations = |more: f64| {
                let best = Fit {
                    log_likelihood: axis.fit.log_likelihood + more,
                    ..axis.fit.clone()
                };
                let spread = Spread::new(&axis.bins, &axis.data, &axis.laws, &best);
                spread.log_deviations(0)
            };
            let own = deviations(0.0);
            assert!(own.iter().all(|sd| *sd < 0.5), "seed {seed}: {own:?}");
            assert_eq!(deviations(300.0), own, "seed {seed}");
            assert_eq!(deviations(-300.0), own, "seed {seed}");
        }
    }
}
