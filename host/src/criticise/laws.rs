//! Effects that change the spectrum's shape: search of their parameters by likelihood.

use super::tail;
use super::whittle::{Fitted, Frame};

/// One more law beside the five terms and the effects accepted so far.
pub struct Law {
    /// Name of the effect.
    pub effect: &'static str,
    /// Shapes from which the search begins.
    pub starts: Vec<Vec<f64>>,
    /// Lowest and highest value of each shape parameter.
    pub bounds: Vec<(f64, f64)>,
    /// How it acts for a shape.
    pub action: Action,
    /// Places of the search that count as independent.
    pub trials: f64,
}

/// Two-sided density or power at a frequency, for a shape.
pub type ShapeFn = Box<dyn Fn(&[f64], f64) -> f64 + Sync>;

/// How a law acts.
pub enum Action {
    /// Adds a process of this density, ahead of the chain, times a squared coefficient.
    Adds(ShapeFn),
    /// Multiplies all that is there by this power.
    Multiplies(ShapeFn),
}

/// A law with the parameters that fit best.
#[derive(Debug, Clone)]
pub struct Best {
    /// Shape parameters.
    pub shape: Vec<f64>,
    /// Standard deviations of their logarithms; infinite where the data do not tell.
    pub log_sd: Vec<f64>,
    /// The fit with it; the law's own squared coefficient last, if it has one.
    pub fitted: Fitted,
    /// Standard deviation of the law's own squared coefficient over itself, shapes free.
    pub squared_log_sd: f64,
    /// Gain in log-likelihood over the fit without.
    pub nats: f64,
    /// Probability of as large a gain where the law is absent.
    pub p_value: f64,
}

/// What is in the model already: additive components, then factors on all of them.
pub struct Present {
    /// Expectations of each additive component at coefficient 1.
    pub components: Vec<Vec<f64>>,
    /// The same for any further factor on the spectrum.
    pub through: Box<dyn Fn(&dyn Fn(f64) -> f64) -> Vec<Vec<f64>>>,
    /// Power of the factors accepted so far.
    pub power: Box<dyn Fn(f64) -> f64>,
}

impl Law {
    fn fit(&self, frame: &Frame, psd: &[f64], present: &Present, shape: &[f64]) -> Option<Fitted> {
        match &self.action {
            Action::Adds(density) => {
                let mut components = present.components.clone();
                components.push(frame.expect(|f_hz| density(shape, f_hz) * (present.power)(f_hz)));
                frame.fit(psd, &components)
            }
            Action::Multiplies(power) => {
                let components = (present.through)(&|f_hz| power(shape, f_hz));
                frame.fit(psd, &components)
            }
        }
    }

    /// The shape that fits best.
    pub fn search(
        &self,
        frame: &Frame,
        psd: &[f64],
        present: &Present,
        base: &Fitted,
    ) -> Option<Best> {
        let value = |shape: &[f64]| self.fit(frame, psd, present, shape);
        let mut best: Option<(Vec<f64>, Fitted)> = None;
        for start in &self.starts {
            let Some(fitted) = value(start) else { continue };
            if best
                .as_ref()
                .is_none_or(|(_, best)| fitted.log_likelihood > best.log_likelihood)
            {
                best = Some((start.clone(), fitted));
            }
        }
        let (mut shape, mut fitted) = best?;
        // By turns along each axis of the logarithms, halving the step when neither way gains.
        let mut step = 0.3;
        while step > 1e-3 {
            let mut gained = false;
            for axis in 0..shape.len() {
                for factor in [f64::exp(step), f64::exp(-step)] {
                    let mut trial = shape.clone();
                    trial[axis] =
                        (trial[axis] * factor).clamp(self.bounds[axis].0, self.bounds[axis].1);
                    let Some(next) = value(&trial) else { continue };
                    if next.log_likelihood > fitted.log_likelihood + 1e-6 {
                        (shape, fitted) = (trial, next);
                        gained = true;
                        break;
                    }
                }
            }
            if !gained {
                step *= 0.5;
            }
        }
        let nats = fitted.log_likelihood - base.log_likelihood;
        let freedom = shape.len() as f64 + if matches!(self.action, Action::Adds(_)) { 1.0 } else { 0.0 };
        let p_value = tail::searched(tail::chi_squared(2.0 * nats, freedom), self.trials);
        let (log_sd, squared_log_sd) = self.uncertainty(frame, psd, present, &shape, &fitted);
        Some(Best {
            shape,
            log_sd,
            fitted,
            squared_log_sd,
            nats,
            p_value,
        })
    }

    /// Standard deviations from the curvature of the likelihood: of the logarithms of the shape
    /// (everything else free), and of the law's own coefficient.
    fn uncertainty(
        &self,
        frame: &Frame,
        psd: &[f64],
        present: &Present,
        shape: &[f64],
        fitted: &Fitted,
    ) -> (Vec<f64>, f64) {
        let moved = |axis: usize, factor: f64| {
            let mut trial = shape.to_vec();
            trial[axis] *= factor;
            trial
        };
        let log_sd: Vec<f64> = (0..shape.len())
            .map(|axis| {
                // The step that loses about half a nat shows the curvature best.
                let mut step = 0.02_f64;
                for _ in 0..12 {
                    let loss: f64 = [step, -step]
                        .into_iter()
                        .filter_map(|step| {
                            value_of(self.fit_near(frame, psd, present, &moved(axis, step.exp()), axis))
                        })
                        .map(|value| fitted.log_likelihood - value)
                        .sum::<f64>()
                        / 2.0;
                    if loss > 0.25 && loss < 1.0 {
                        return step / (2.0 * loss).sqrt();
                    }
                    if !loss.is_finite() || loss <= 0.0 {
                        step *= 2.0;
                    } else {
                        step *= (0.5 / loss).sqrt().clamp(0.1, 4.0);
                    }
                    if step > 3.0 {
                        return f64::INFINITY;
                    }
                }
                step
            })
            .collect();
        let squared = match self.action {
            Action::Adds(_) => fitted.squared.last().copied().unwrap_or(0.0),
            Action::Multiplies(_) => 0.0,
        };
        if squared <= 0.0 {
            return (log_sd, f64::INFINITY);
        }
        // The coefficient held, everything else free.
        let Action::Adds(density) = &self.action else {
            return (log_sd, f64::INFINITY);
        };
        let own = frame.expect(|f_hz| density(shape, f_hz) * (present.power)(f_hz));
        let loss = |factor: f64| {
            let held: Vec<f64> = own.iter().map(|value| value * squared * factor).collect();
            frame
                .fit_above(psd, &present.components, &held)
                .map(|held| fitted.log_likelihood - held.log_likelihood)
        };
        let mut step = 0.05_f64;
        for _ in 0..12 {
            let losses: Vec<f64> = [step, -step]
                .into_iter()
                .filter_map(|step| loss(step.exp()))
                .collect();
            let mean = losses.iter().sum::<f64>() / losses.len().max(1) as f64;
            if mean > 0.25 && mean < 1.0 {
                return (log_sd, step / (2.0 * mean).sqrt());
            }
            step *= if mean > 0.0 {
                (0.5 / mean).sqrt().clamp(0.1, 4.0)
            } else {
                2.0
            };
            if step > 5.0 {
                break;
            }
        }
        (log_sd, f64::INFINITY)
    }

    /// Best fit with one shape parameter held and the others free.
    fn fit_near(
        &self,
        frame: &Frame,
        psd: &[f64],
        present: &Present,
        shape: &[f64],
        held: usize,
    ) -> Option<Fitted> {
        let mut shape = shape.to_vec();
        let mut fitted = self.fit(frame, psd, present, &shape)?;
        let mut step = 0.1;
        while shape.len() > 1 && step > 5e-3 {
            let mut gained = false;
            for axis in (0..shape.len()).filter(|&axis| axis != held) {
                for factor in [f64::exp(step), f64::exp(-step)] {
                    let mut trial = shape.clone();
                    trial[axis] *= factor;
                    let Some(next) = self.fit(frame, psd, present, &trial) else {
                        continue;
                    };
                    if next.log_likelihood > fitted.log_likelihood + 1e-4 {
                        (shape, fitted) = (trial, next);
                        gained = true;
                        break;
                    }
                }
            }
            if !gained {
                step *= 0.5;
            }
        }
        Some(fitted)
    }
}

fn value_of(fitted: Option<Fitted>) -> Option<f64> {
    fitted.map(|fitted| fitted.log_likelihood)
}

/// Where and how far the bins depart from what is expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Band, hertz.
    pub from_hz: f64,
    /// Upper end of it.
    pub to_hz: f64,
    /// Measured over expected power in it.
    pub ratio: f64,
    /// Probability of as large a departure in any band.
    pub p_value: f64,
}

/// The band in which the bins depart most from `expected`, over all bands of 1, 2, 4 ... bins.
pub fn departure(frame: &Frame, psd: &[f64], expected: &[f64]) -> Option<Departure> {
    let bins = frame.bins();
    let kappa = frame.kappa();
    let mut best: Option<Departure> = None;
    let mut trials = 0.0;
    let mut width = 1;
    while width <= bins.len() {
        for start in (0..=bins.len() - width).step_by((width / 2).max(1)) {
            trials += 1.0;
            let band = start..start + width;
            let freedom: f64 = band.clone().map(|b| bins[b].edf).sum();
            let ratio = band
                .clone()
                .map(|b| bins[b].edf * psd[b] / expected[b])
                .sum::<f64>()
                / freedom;
            let p = if width == 1 {
                tail::mean_square(ratio, freedom)
            } else {
                tail::mean_square(ratio, kappa * freedom)
            };
            if best.is_none_or(|best| p < best.p_value) {
                best = Some(Departure {
                    from_hz: bins[band.start].f_hz,
                    to_hz: bins[band.end - 1].f_hz,
                    ratio,
                    p_value: p,
                });
            }
        }
        width *= 2;
    }
    best.map(|best| Departure {
        p_value: tail::searched(best.p_value, trials),
        ..best
    })
}
