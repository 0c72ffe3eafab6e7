//! What a navigator needs: how the error of the integrated signal grows.
//!
//! An accelerometer's noise becomes velocity and position error, a gyroscope's becomes angle
//! error. Here one axis integrates its own noise, at rest and without any other sensor's help;
//! gravity and rotation, which couple the axes of a real navigator, are left out. The bias is
//! taken to be the mean over an alignment before the start, so the prediction holds for noise
//! whose mean is not defined (flicker, walk) as well.
//!
//! ```text
//! sigma^2(t) = 2 int_0^{rate/2} S(f) |W(f)|^2 df  +  ramp^2,    W: see response
//! ```

pub mod response;

use crate::model::axis::ModelAxis;
use crate::model::effect::Part;
use crate::model::kernel::panels;
use crate::model::law::Law;
use crate::model::{Coefficient, Line, PerCoefficient};
use response::{Integral, Weights, x};

/// Alignment that reports assume, seconds.
pub const ALIGNMENT_S: f64 = 60.0;

/// Oscillations of the weights' transform that are resolved, of the shorter of alignment and
/// integration. The rest is within 1 % of the error.
const CYCLES: f64 = 8.0;

/// Panels an oscillation of the longer.
const PANELS_PER_CYCLE: f64 = 2.0;

/// First panel, as a part of the others; from there they double.
const FIRST_PANEL: f64 = 1e-6;

/// Relative width of a panel where the integrand is smooth, and panels over the rate.
const RELATIVE_PANEL: f64 = 0.2;
const PANELS_PER_RATE: f64 = 200.0;

/// Error of an integral of the signal.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Growth {
    /// Time of integration, seconds.
    pub t_s: f64,
    /// Standard deviation of the error: unit of the signal times seconds for velocity, times
    /// seconds squared for position.
    pub sigma: f64,
    /// Lower end of its 95 % band.
    pub lo: f64,
    /// Upper end of its 95 % band.
    pub hi: f64,
}

/// How a signal is integrated.
#[derive(Debug, Clone, Copy)]
pub struct Integration {
    /// Once or twice.
    pub integral: Integral,
    /// Samples a second.
    pub rate_hz: f64,
    /// The alignment before the start, seconds.
    pub alignment_s: f64,
}

/// Growth of the error of an integral over `times_s`, all above zero.
///
/// `intervals` are the 95 % intervals of the magnitudes of the coefficients; they are taken for
/// independent. The ramp is added in squares, as an error of unknown sign; other drifts of
/// the model are left out.
pub fn growth(
    axis: &ModelAxis,
    intervals: &PerCoefficient<(f64, f64)>,
    integration: Integration,
    times_s: &[f64],
) -> Vec<Growth> {
    let Integration {
        integral, rate_hz, ..
    } = integration;
    // Variances are linear in the squares of the coefficients: one law for each, and the effects.
    let with = |coefficients, effects: &dyn Fn(&Part) -> bool| {
        part_of(axis, coefficients, effects).law(rate_hz)
    };
    let laws = PerCoefficient::from_fn(|coefficient| {
        let unit = PerCoefficient::from_fn(|one| f64::from(u8::from(one == coefficient)));
        with(unit, &|part| !matches!(part, Part::Term(_)))
    });
    let effects = with(PerCoefficient::default(), &|_| true);
    // What distortions put under the rest depends on the rest; it counts once.
    let whole = axis.law(rate_hz);
    let linear = |law: &Law, f_hz: f64| law.density(f_hz) - law.density_added(f_hz);
    let samples = |s: f64| (s * rate_hz).round().max(1.0);
    let at = |&t_s: &f64| {
        let weights = Weights {
            integral,
            c: samples(integration.alignment_s),
            n: samples(t_s),
        };
        let density = |f_hz: f64| linear(&effects, f_hz) + whole.density_added(f_hz);
        let lines = effects.lines();
        let mut variance = noise_variance(density, &lines, weights, rate_hz);
        let (mut below, mut above) = (0.0, 0.0);
        for one in Coefficient::ALL {
            let (lo, hi) = *intervals.get(one);
            let square = axis.coefficients.get(one).powi(2);
            if square == 0.0 && hi == 0.0 {
                continue;
            }
            let unit = match one {
                Coefficient::R => ramp_variance(weights, rate_hz),
                _ => {
                    let law = laws.get(one);
                    noise_variance(|f_hz| linear(law, f_hz), &[], weights, rate_hz)
                }
            };
            variance += unit * square;
            below += (unit * (square - lo * lo)).powi(2);
            above += (unit * (hi * hi - square)).powi(2);
        }
        Growth {
            t_s,
            sigma: variance.sqrt(),
            lo: (variance - below.sqrt()).max(0.0).sqrt(),
            hi: (variance + above.sqrt()).sqrt(),
        }
    };
    times_s.iter().map(at).collect()
}

/// An axis with these coefficients and, of its effects, those for which `keeps` says so.
fn part_of(
    axis: &ModelAxis,
    coefficients: PerCoefficient<f64>,
    keeps: &dyn Fn(&Part) -> bool,
) -> ModelAxis {
    let mut axis = ModelAxis {
        coefficients,
        ..axis.clone()
    };
    axis.effects.retain(|effect| keeps(&effect.part()));
    axis
}

/// Seconds of the signal's integral in one sum of the weights.
fn unit_s(integral: Integral, rate_hz: f64) -> f64 {
    match integral {
        Integral::Velocity => 1.0 / rate_hz,
        Integral::Position => 1.0 / (rate_hz * rate_hz),
    }
}

/// Variance from noise of the two-sided density `density` and from lines.
fn noise_variance(
    density: impl Fn(f64) -> f64,
    lines: &[Line],
    weights: Weights,
    rate_hz: f64,
) -> f64 {
    let nyquist = 0.5 * rate_hz;
    let (longer, shorter) = (weights.n.max(weights.c), weights.n.min(weights.c));
    let resolved = (CYCLES * rate_hz / shorter).min(nyquist);
    let widest = rate_hz / PANELS_PER_RATE;
    let fine = (rate_hz / longer / PANELS_PER_CYCLE).min(widest);
    let near = panels(
        0.0,
        resolved,
        |f| f.max(FIRST_PANEL * fine).min(fine),
        |f| density(f) * weights.power(x(f, rate_hz)),
    );
    let far = panels(
        resolved,
        nyquist,
        |f| (RELATIVE_PANEL * f).min(widest),
        |f| density(f) * weights.mean_power(x(f, rate_hz)),
    );
    let lines: f64 = lines
        .iter()
        .map(|line| line.power * weights.power(x(line.f_hz, rate_hz)))
        .sum();
    (2.0 * (near + far) + lines) * unit_s(weights.integral, rate_hz).powi(2)
}

/// Square of what a ramp of 1 a second does: its mean over the alignment lies half of it back.
fn ramp_variance(weights: Weights, rate_hz: f64) -> f64 {
    let (t_s, alignment_s) = (weights.n / rate_hz, weights.c / rate_hz);
    let error = match weights.integral {
        Integral::Velocity => t_s * (t_s + alignment_s) / 2.0,
        Integral::Position => t_s * t_s * (t_s / 6.0 + alignment_s / 4.0),
    };
    error * error
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::published::PublishedAxis;
    use crate::model::whole::Model;
    use crate::simulate::source::Simulation;

    fn of(integral: Integral, rate_hz: f64, alignment_s: f64) -> Integration {
        Integration {
            integral,
            rate_hz,
            alignment_s,
        }
    }

    fn points(axis: &ModelAxis) -> PerCoefficient<(f64, f64)> {
        PerCoefficient::from_fn(|one| {
            let value = axis.coefficients.get(one).abs();
            (value, value)
        })
    }

    fn axis_with(coefficients: PerCoefficient<f64>) -> ModelAxis {
        let mut model = Model::published(Some(PublishedAxis::X));
        model.axes[0].coefficients = coefficients;
        model.axes.remove(0)
    }

    #[test]
    fn closed_forms_of_white_noise_walk_and_quantisation() {
        type Closed = fn(f64, f64) -> f64;
        let zero = PerCoefficient::default();
        let white = axis_with(PerCoefficient { n: 1.0, ..zero });
        let walk = axis_with(PerCoefficient { k: 1.0, ..zero });
        let quantisation = axis_with(PerCoefficient { q: 1.0, ..zero });
        // Continuous time; t is the integration, c the alignment. A walk's mean over the
        // alignment lies sqrt(c/3) from where it ends.
        let cases: [(&ModelAxis, Integral, Closed); 5] = [
            (&white, Integral::Velocity, |t, c| t + t * t / c),
            (&white, Integral::Position, |t, c| {
                t.powi(3) / 3.0 + t.powi(4) / (4.0 * c)
            }),
            (&walk, Integral::Velocity, |t, c| {
                t.powi(3) / 3.0 + t * t * c / 3.0
            }),
            (&walk, Integral::Position, |t, c| {
                t.powi(5) / 20.0 + t.powi(4) * c / 12.0
            }),
            (&quantisation, Integral::Velocity, |t, c| {
                let ratio = t / c;
                ratio * ratio + (1.0 + ratio).powi(2) + 1.0
            }),
        ];
        let times_s = [0.5, 3.0, 60.0, 1000.0];
        for (axis, integral, closed) in cases {
            let found = growth(axis, &points(axis), of(integral, 200.0, 60.0), &times_s);
            for one in found {
                let expected = closed(one.t_s, 60.0).sqrt();
                let relative = one.sigma / expected - 1.0;
                // Of half a second of 200 samples the steps still show.
                assert!(
                    relative.abs() < 0.01,
                    "{:?} {integral:?} {} s: {relative}",
                    axis.coefficients,
                    one.t_s
                );
            }
        }
    }

    #[test]
    fn prediction_is_what_simulations_do() {
        const RECORDS: u64 = 1500;
        const SEED: u64 = 100;
        let (c, n) = (400, 1000);
        let mut model = Model::published(Some(PublishedAxis::X));
        model.rate_hz = 100.0;
        // Every term matters at these lengths, and the effects and the chain as well.
        model.axes[0] = serde_json::from_str(
            r#"{ "name": "X", "chain": "ads1281:linear+20hz",
                 "coefficients": { "R": 0.02, "K": 0.02, "B": 0.05, "N": 0.1, "Q": 0.1 },
                 "effects": [
                   { "effect": "markov", "parameters": { "amplitude": 0.1, "time_s": 2 } },
                   { "effect": "sinusoid", "parameters": { "f_hz": 0.13, "amplitude": 0.2 } } ] }"#,
        )
        .expect("an axis");
        let axis = &model.axes[0];
        let mut squares = [0.0; 2];
        // One long record in pieces: of what ties neighbours, nothing outlasts the alignment but
        // flicker noise, faintly.
        let mut simulation = Simulation::new(&model, RECORDS * (c + n), SEED).expect("a model");
        for _ in 0..RECORDS {
            let column = simulation.next_columns((c + n) as usize).remove(0);
            let (before, after) = column.split_at(c as usize);
            let bias = before.iter().sum::<f64>() / c as f64;
            let (mut velocity, mut position) = (0.0, 0.0);
            for y in after {
                let step = (y - bias) / model.rate_hz;
                position += (velocity + 0.5 * step) / model.rate_hz;
                velocity += step;
            }
            squares[0] += velocity * velocity / RECORDS as f64;
            squares[1] += position * position / RECORDS as f64;
        }
        for (integral, square) in [Integral::Velocity, Integral::Position]
            .into_iter()
            .zip(squares)
        {
            let predicted = growth(axis, &points(axis), of(integral, 100.0, 4.0), &[10.0])[0];
            // Five sigma of a mean square of independent Gaussian numbers.
            let tolerance = 5.0 * (2.0 / RECORDS as f64).sqrt();
            let ratio = square / predicted.sigma.powi(2);
            assert!(
                (ratio - 1.0).abs() < tolerance,
                "{integral:?}, seed {SEED}: {ratio} of the predicted variance"
            );
        }
    }

    #[test]
    fn bands_come_from_the_intervals() {
        let axis = axis_with(PerCoefficient {
            n: 2.0,
            ..PerCoefficient::default()
        });
        let intervals = PerCoefficient {
            n: (1.0, 3.0),
            ..PerCoefficient::default()
        };
        let one = growth(
            &axis,
            &intervals,
            of(Integral::Velocity, 100.0, 10.0),
            &[10.0],
        )[0];
        assert!((one.lo / one.sigma - 0.5).abs() < 1e-12);
        assert!((one.hi / one.sigma - 1.5).abs() < 1e-12);
    }
}
