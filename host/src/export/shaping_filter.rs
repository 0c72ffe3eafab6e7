//! The shaping filter of a model: the linear system that makes its noise from white noise.
//!
//! Without a signal chain white, quantisation, walk and Markov noise, ramp and sinusoid are
//! exact. Flicker noise is a bank of first-order Markov processes with correlation times a factor
//! six apart. With a chain, white and quantisation noise and Markov noise of a few samples
//! go together through a low-order filter with the chain's spectrum; what is slow passes its poles
//! alone. How good all this is is computed, not assumed: [`ShapingFilter::accuracy`]
//! compares the Allan deviation of the very matrices with the model's.

mod accuracy;
mod chained;
mod exact;
mod flicker;

use std::f64::consts::TAU;

use super::state_space::StateSpace;
use crate::model::axis::{ModelAxis, ModelEffect};
use crate::model::effect::Part;
use crate::model::markov::Markov;
use crate::model::quantisation::Quantisation;
use crate::model::white::White;
use crate::model::{Line, Term};
use accuracy::accuracy;
use chained::chained;
use exact::{markov_block, quantisation_block, ramp, sinusoid, walk, white_block};
use flicker::flicker;

pub use accuracy::Accuracy;

/// Markov noise with a correlation time below this many samples goes through the chain's filter.
const FAST_SAMPLES: f64 = 200.0;

/// A shaping filter and how good it is.
pub struct ShapingFilter {
    /// The system; its output is the signal less its mean.
    pub system: StateSpace,
    /// How good it is.
    pub accuracy: Accuracy,
    /// Effects of the model that are not in it.
    pub left_out: Vec<&'static str>,
}

impl ShapingFilter {
    /// The filter of `axis` at `rate_hz`, for averaging times up to `longest_s`.
    pub fn new(axis: &ModelAxis, rate_hz: f64, longest_s: f64) -> Self {
        let known = Known::new(axis);
        let coefficients = &axis.coefficients;
        let sections = sections(axis, rate_hz);
        let (mut stable, fast) = known.parted(axis, rate_hz);
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

    /// White, quantisation and Markov noise: what is made as it is, and what goes through the chain's filter.
    fn parted(&self, axis: &ModelAxis, rate_hz: f64) -> (StateSpace, Vec<Box<dyn Term>>) {
        let coefficients = &axis.coefficients;
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
        for markov in &self.markov {
            if axis.chain.is_some() && markov.time_s * rate_hz < FAST_SAMPLES {
                fast.push(Box::new(*markov));
            } else {
                let name = format!("markov, {:.3e} s", markov.time_s);
                stable = stable.plus(&markov_block(&name, *markov, rate_hz));
            }
        }
        (stable, fast)
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
