//! The shaping filter of a model: the linear system that makes its noise from white noise.
//!
//! Without a signal chain white, quantisation, walk and Markov noise, ramp and sinusoid are
//! exact. Flicker noise is a bank of first-order Markov processes with correlation times a factor
//! six apart. With a chain, white and quantisation noise and Markov noise of a few samples
//! go together through a low-order filter with the chain's spectrum; what is slow passes its poles
//! alone. How good all this is is computed, not assumed: [`ShapingFilter::accuracy`]
//! compares the Allan deviation of the very matrices with the model's.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::factor::Factor;
use super::state_space::StateSpace;
use crate::model::axis::{ModelAxis, ModelEffect};
use crate::model::effect::Part;
use crate::model::flicker::Flicker;
use crate::model::kernel::{self, Kernel};
use crate::model::law::Law;
use crate::model::markov::Markov;
use crate::model::quantisation::Quantisation;
use crate::model::white::White;
use crate::model::{Line, Term};

/// Ratio of neighbouring correlation times of the flicker bank: 0.5 % of ripple in deviation.
const SPACING: f64 = 6.0;

/// Markov noise with a correlation time below this many samples goes through the chain's filter.
const FAST_SAMPLES: f64 = 200.0;

/// Error of the Allan deviation that the order of the chain's filter is chosen for, as a part.
const AIM: f64 = 0.005;

/// Averaging times an octave at which deviations are compared.
const PER_OCTAVE: f64 = 2.0;

/// Allan variance that is nothing, as a part of the largest of the curve.
const NOTHING: f64 = 1e-9;

/// A shaping filter and how good it is.
pub struct ShapingFilter {
    /// The system; its output is the signal less its mean.
    pub system: StateSpace,
    /// How good it is.
    pub accuracy: Accuracy,
    /// Effects of the model that are not in it.
    pub left_out: Vec<&'static str>,
}

/// Agreement of the filter's Allan deviation with the model's.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Accuracy {
    /// Shortest averaging time compared, seconds.
    pub from_s: f64,
    /// Longest averaging time compared, seconds.
    pub to_s: f64,
    /// Largest difference of the deviations between them, percent of the model's.
    pub allan_deviation_percent: f64,
}

impl ShapingFilter {
    /// The filter of `axis` at `rate_hz`, for averaging times up to `longest_s`.
    pub fn new(axis: &ModelAxis, rate_hz: f64, longest_s: f64) -> Self {
        let known = Known::new(axis);
        let coefficients = &axis.coefficients;
        let sections = sections(axis, rate_hz);
        let (mut stable, mut fast) = (StateSpace::empty(), Vec::<Box<dyn Term>>::new());
        let white = White {
            root_density: coefficients.n,
        };
        let quantisation = Quantisation {
            step: coefficients.q,
        };
        if axis.chain.is_some() {
            if coefficients.n != 0.0 {
                fast.push(Box::new(white));
            }
            if coefficients.q != 0.0 {
                fast.push(Box::new(quantisation));
            }
        } else {
            if coefficients.n != 0.0 {
                stable = stable.plus(&white_block(white, rate_hz));
            }
            if coefficients.q != 0.0 {
                stable = stable.plus(&quantisation_block(quantisation, rate_hz));
            }
        }
        for markov in &known.markov {
            if axis.chain.is_some() && markov.time_s * rate_hz < FAST_SAMPLES {
                fast.push(Box::new(*markov));
            } else {
                let name = format!("markov, {:.3e} s", markov.time_s);
                stable = stable.plus(&markov_block(&name, *markov, rate_hz));
            }
        }
        if !fast.is_empty() {
            stable = stable.plus(&chained(axis, &fast, &sections, rate_hz));
        }
        if coefficients.b != 0.0 {
            stable = stable.plus(&flicker(coefficients.b, rate_hz, longest_s));
        }
        let mut system = stable;
        if !sections.is_empty() && system.order() > 0 {
            system = system.cascade(&sections).settled();
        }
        if coefficients.k != 0.0 {
            system = system.plus(&walk(coefficients.k.powi(2) / rate_hz, &sections));
        }
        if coefficients.r != 0.0 {
            system = system.plus(&ramp(coefficients.r / rate_hz));
        }
        for line in &known.lines {
            let passed = axis
                .chain
                .as_ref()
                .map_or(1.0, |chain| chain.power(line.f_hz, rate_hz));
            system = system.plus(&sinusoid(*line, passed, rate_hz));
        }
        let accuracy = accuracy(&system, axis, &known, rate_hz, longest_s);
        Self {
            system,
            accuracy,
            left_out: known.left_out,
        }
    }
}

/// The effects that a linear system can hold, and the names of the others.
struct Known {
    markov: Vec<Markov>,
    lines: Vec<Line>,
    effects: Vec<ModelEffect>,
    left_out: Vec<&'static str>,
}

impl Known {
    fn new(axis: &ModelAxis) -> Self {
        let mut known = Self {
            markov: Vec::new(),
            lines: Vec::new(),
            effects: Vec::new(),
            left_out: Vec::new(),
        };
        for effect in &axis.effects {
            match (effect.kind().name(), effect.values(), effect.part()) {
                ("markov", &[deviation, time_s], _) => {
                    known.markov.push(Markov { deviation, time_s });
                }
                // A sinusoid, or the harmonics of a hum.
                (_, _, Part::Term(term)) if !term.lines().is_empty() => {
                    known.lines.extend(term.lines());
                }
                (name, ..) => {
                    known.left_out.push(name);
                    continue;
                }
            }
            known.effects.push(effect.clone());
        }
        known
    }
}

/// `1 - a` of the sections `(1 - a) / (1 - a/z)` that stand for the poles of the chain.
fn sections(axis: &ModelAxis, rate_hz: f64) -> Vec<f64> {
    let poles_hz = axis.chain.as_ref().map_or(&[][..], |chain| &chain.poles_hz);
    poles_hz
        .iter()
        .map(|pole_hz| -(-TAU * pole_hz / rate_hz).exp_m1())
        .collect()
}

fn white_block(white: White, rate_hz: f64) -> StateSpace {
    let variance = white.root_density.powi(2) * rate_hz;
    StateSpace::first_order("white", 0.0, variance, variance)
}

/// Differenced white noise: the last two of a white sequence are the states.
fn quantisation_block(quantisation: Quantisation, rate_hz: f64) -> StateSpace {
    let variance = (quantisation.step * rate_hz).powi(2);
    StateSpace {
        f: DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 1.0, 0.0]),
        g: DMatrix::from_row_slice(2, 1, &[1.0, 0.0]),
        h: DVector::from_row_slice(&[1.0, -1.0]),
        q: DVector::from_element(1, variance),
        x0: DVector::zeros(2),
        p0: DMatrix::from_diagonal_element(2, 2, variance),
        names: vec![
            "quantisation".to_owned(),
            "quantisation, one sample before".to_owned(),
        ],
    }
}

/// A walk from zero with steps of variance `q`. How far the sections lag behind it is stationary,
/// though the walk is not.
fn walk(q: f64, sections: &[f64]) -> StateSpace {
    let mut system = StateSpace::first_order("walk", 1.0, q, 0.0).cascade(sections);
    let n = sections.len();
    if n == 0 {
        return system;
    }
    // In the lags s - x, which the walk x drives by its steps alone, the sections are stable.
    let mut to_lags = DMatrix::identity(n + 1, n + 1);
    let mut from_lags = to_lags.clone();
    for k in 1..=n {
        to_lags[(k, 0)] = -1.0;
        from_lags[(k, 0)] = 1.0;
    }
    let (f, g) = (&to_lags * &system.f * from_lags, &to_lags * &system.g);
    let lags = StateSpace {
        f: f.view((1, 1), (n, n)).into_owned(),
        g: g.rows(1, n).into_owned(),
        h: DVector::zeros(n),
        q: system.q.clone(),
        x0: DVector::zeros(n),
        p0: DMatrix::zeros(n, n),
        names: Vec::new(),
    };
    system
        .p0
        .view_mut((1, 1), (n, n))
        .copy_from(&lags.settled().p0);
    system
}

fn markov_block(name: &str, markov: Markov, rate_hz: f64) -> StateSpace {
    let decay = 1.0 / (markov.time_s * rate_hz);
    let variance = markov.deviation.powi(2);
    let innovation = -variance * (-2.0 * decay).exp_m1();
    StateSpace::first_order(name, (-decay).exp(), innovation, variance)
}

/// A level that grows by a constant each sample.
fn ramp(slope_per_sample: f64) -> StateSpace {
    StateSpace {
        f: DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.0, 1.0]),
        g: DMatrix::zeros(2, 0),
        h: DVector::from_row_slice(&[1.0, 0.0]),
        q: DVector::zeros(0),
        x0: DVector::from_row_slice(&[0.0, slope_per_sample]),
        p0: DMatrix::zeros(2, 2),
        names: vec!["ramp".to_owned(), "ramp, change a sample".to_owned()],
    }
}

/// A rotation that nothing drives; its phase is any.
fn sinusoid(line: Line, passed: f64, rate_hz: f64) -> StateSpace {
    let (sine, cosine) = (TAU * line.f_hz / rate_hz).sin_cos();
    let name = format!("sinusoid of {} Hz", line.f_hz);
    StateSpace {
        f: DMatrix::from_row_slice(2, 2, &[cosine, -sine, sine, cosine]),
        g: DMatrix::zeros(2, 0),
        h: DVector::from_row_slice(&[1.0, 0.0]),
        q: DVector::zeros(0),
        x0: DVector::zeros(2),
        p0: DMatrix::from_diagonal_element(2, 2, line.power * passed),
        names: vec![name.clone(), format!("{name}, a quarter period before")],
    }
}

/// Flicker noise as Markov processes. Their variances are fitted to the spectrum from below
/// `1 / longest_s` to half the rate, by relative least squares with no variance negative.
fn flicker(level: f64, rate_hz: f64, longest_s: f64) -> StateSpace {
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

/// Fast noises behind the chain, up to its low-pass `sections`, by a filter of the lowest order
/// that is good enough.
fn chained(
    axis: &ModelAxis,
    terms: &[Box<dyn Term>],
    sections: &[f64],
    rate_hz: f64,
) -> StateSpace {
    let law = Law::new(
        &ModelAxis {
            effects: Vec::new(),
            ..axis.clone()
        },
        rate_hz,
    );
    let density = |f_hz: f64| {
        let ahead: f64 = terms
            .iter()
            .map(|term| law.density_ahead(&**term, f_hz))
            .sum();
        ahead * law.power(f_hz)
    };
    let factor = Factor::new(density, sections, rate_hz);
    // Longer than any memory of the chain's; beyond, the density at zero alone counts.
    let taus: Vec<u64> = (0..18).map(|k| 1 << k).collect();
    let wanted: Vec<f64> = taus
        .iter()
        .map(|&m| kernel::variance(Kernel::Allan, m, rate_hz, density))
        .collect();
    let error = |system: &StateSpace| {
        let system = system.cascade(sections).settled();
        taus.iter()
            .zip(&wanted)
            .map(|(&m, wanted)| ((system.allan_variance(m) / wanted).sqrt() - 1.0).abs())
            .fold(0.0, f64::max)
    };
    let mut best = (f64::INFINITY, StateSpace::empty());
    for order in 1..=Factor::MOST {
        let Some(system) = factor.truncated(order, "band-limited noise") else {
            continue;
        };
        let error = error(&system);
        if error < best.0 {
            best = (error, system);
        }
        if error < AIM {
            break;
        }
    }
    best.1
}

/// Largest difference to the model without what is left out.
fn accuracy(
    system: &StateSpace,
    axis: &ModelAxis,
    known: &Known,
    rate_hz: f64,
    longest_s: f64,
) -> Accuracy {
    let law = Law::new(
        &ModelAxis {
            effects: known.effects.clone(),
            ..axis.clone()
        },
        rate_hz,
    );
    let longest = (longest_s * rate_hz).max(1.0);
    let steps = (longest.log2() * PER_OCTAVE).floor() as u32;
    let factors: std::collections::BTreeSet<u64> = (0..=steps)
        .map(|step| (f64::from(step) / PER_OCTAVE).exp2().round() as u64)
        .collect();
    let wanted: Vec<f64> = factors.iter().map(|&m| law.allan_variance(m)).collect();
    // A sinusoid alone has no variance at all at multiples of its period.
    let floor = NOTHING * wanted.iter().copied().fold(0.0, f64::max);
    let worst = factors
        .iter()
        .zip(&wanted)
        .filter(|(_, wanted)| **wanted > floor)
        .map(|(&m, wanted)| ((system.allan_variance(m) / wanted).sqrt() - 1.0).abs())
        .fold(0.0, f64::max);
    let last = factors.last().copied().unwrap_or(1);
    Accuracy {
        from_s: 1.0 / rate_hz,
        to_s: last as f64 / rate_hz,
        allan_deviation_percent: 100.0 * worst,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::PerCoefficient;
    use crate::model::published::PublishedAxis;
    use crate::model::whole::Model;

    fn percent(change: impl FnOnce(&mut ModelAxis)) -> (f64, usize) {
        let mut model = Model::published(Some(PublishedAxis::X));
        change(&mut model.axes[0]);
        let filter = ShapingFilter::new(&model.axes[0], model.rate_hz, 2000.0);
        (
            filter.accuracy.allan_deviation_percent,
            filter.system.order(),
        )
    }

    #[test]
    fn filters_are_within_two_percent_of_the_model() {
        let chain = |text: &str| Some(text.parse().expect("a chain"));
        let cases = [
            ("published", percent(|_| ())),
            (
                "flicker alone",
                percent(|axis| {
                    axis.coefficients = PerCoefficient {
                        b: 1.0,
                        ..PerCoefficient::default()
                    }
                }),
            ),
            (
                "converter and pole",
                percent(|axis| axis.chain = chain("ads1281:linear+400hz")),
            ),
            (
                "slow pole",
                percent(|axis| axis.chain = chain("ads1281:minimum+10hz")),
            ),
            (
                "walk behind poles",
                percent(|axis| {
                    axis.coefficients = PerCoefficient {
                        k: 1.0,
                        ..PerCoefficient::default()
                    };
                    axis.chain = chain("50hz+100hz");
                }),
            ),
            ("pole alone", percent(|axis| axis.chain = chain("400hz"))),
            (
                "white through the converter",
                percent(|axis| {
                    axis.coefficients.q = 0.0;
                    axis.chain = chain("ads1281:linear");
                }),
            ),
        ];
        for (name, (percent, order)) in cases {
            println!("{name}: {percent} % with {order} states");
            assert!(percent < 2.0, "{name}: {percent} % with {order} states");
        }
    }
}
