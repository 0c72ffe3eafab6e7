//! Effects that change the spectrum's shape: search of their parameters by likelihood.
//!
//! The sizes of additive laws enter linearly, beside the five terms; shapes (corners, widths,
//! exponents) are moved by turns in their logarithms until nothing gains.

use nalgebra::DMatrix;

use super::frame::Frame;
use super::tail;
use crate::fit::likelihood::{Data, Fit, maximise};
use crate::model::effect::{Band, Effect, Part};

/// Smallest step in the logarithm of a shape.
const FINEST: f64 = 2e-3;

/// Gain in log-likelihood that is worth a move.
const WORTH: f64 = 1e-3;

/// Searches of shape that are as good as independent, an octave of the band.
const TRIALS_PER_OCTAVE: f64 = 2.0;

/// An effect with its values; the size, if it has one, is 1 and its square is a component.
#[derive(Clone)]
pub struct Law {
    /// The kind of effect.
    pub effect: &'static dyn Effect,
    /// All its parameters.
    pub values: Vec<f64>,
}

impl Law {
    /// Places of the parameters that are not the size.
    pub fn shape(&self) -> impl Iterator<Item = usize> + use<> {
        let size = self.effect.size();
        (0..self.values.len()).filter(move |&place| Some(place) != size)
    }

    fn adds(&self) -> bool {
        self.effect.size().is_some()
    }
}

/// Expectations of all components: the five terms' (without the ramp), then one of each law that
/// adds, all of them through the laws that filter.
pub fn components(frame: &Frame, laws: &[Law]) -> Vec<Vec<f64>> {
    let parts: Vec<Part> = laws
        .iter()
        .map(|law| law.effect.part(&law.values))
        .collect();
    let filters: Vec<_> = parts
        .iter()
        .filter_map(|part| match part {
            Part::Distortion(filter) => Some(filter),
            Part::Term(_) | Part::Clock(_) | Part::Follows(_) => None,
        })
        .collect();
    let power = |f_hz: f64| -> f64 {
        let powers = filters.iter().map(|one| one.power(f_hz, frame.rate_hz()));
        powers.product()
    };
    let mut all = if filters.is_empty() {
        frame.units().to_vec()
    } else {
        frame.units_through(power)
    };
    for part in &parts {
        if let Part::Term(term) = part {
            all.push(frame.expect(|f_hz| frame.term_density(&**term, f_hz) * power(f_hz)));
        }
    }
    all
}

/// Likelihood with these laws.
pub fn fit(frame: &Frame, data: &Data, laws: &[Law]) -> Option<Fit> {
    maximise(data, &components(frame, laws))
}

/// Moves the shapes of the laws from number `from` on until the likelihood gains no more.
pub fn polish(
    frame: &Frame,
    data: &Data,
    laws: &mut [Law],
    from: usize,
    first_step: f64,
) -> Option<Fit> {
    let mut best = fit(frame, data, laws)?;
    let places: Vec<(usize, usize)> = (from..laws.len())
        .flat_map(|law| laws[law].shape().map(move |place| (law, place)))
        .collect();
    let mut step = first_step;
    while step > FINEST && !places.is_empty() {
        let mut gained = false;
        for &(law, place) in &places {
            for factor in [f64::exp(step), f64::exp(-step)] {
                let before = laws[law].values[place];
                laws[law].values[place] = before * factor;
                let sound = laws[law].effect.is_sound(&laws[law].values);
                let next = sound.then(|| fit(frame, data, laws)).flatten();
                match next {
                    Some(next) if next.log_likelihood > best.log_likelihood + WORTH => {
                        best = next;
                        gained = true;
                        break;
                    }
                    _ => laws[law].values[place] = before,
                }
            }
        }
        if !gained {
            step *= 0.5;
        }
    }
    Some(best)
}

/// A law that was found, beside others.
pub struct Found {
    /// The law with the values that fit best, size 1.
    pub law: Law,
    /// Fit of everything.
    pub fit: Fit,
    /// Gain in log-likelihood over the fit without it.
    pub nats: f64,
    /// Probability of as large a gain where it is absent.
    pub p_value: f64,
}

/// The best values of `effect` beside the `laws` that are there, whose fit is `base`.
pub fn search(
    frame: &Frame,
    data: &Data,
    laws: &[Law],
    base: &Fit,
    effect: &'static dyn Effect,
) -> Option<Found> {
    let bins = frame.bins();
    let band = Band {
        from_hz: bins.first()?.f_hz,
        to_hz: bins.last()?.f_hz,
    };
    let present = components(frame, laws);
    let mut best: Option<(f64, Vec<f64>)> = None;
    for values in effect.starts(&band) {
        let law = Law {
            effect,
            values: values.clone(),
        };
        let found = if law.adds() && !laws.iter().any(|law| !law.adds()) {
            let mut all = present.clone();
            if let Part::Term(term) = effect.part(&values) {
                all.push(frame.expect(|f_hz| frame.term_density(&*term, f_hz)));
            }
            maximise(data, &all)
        } else {
            let mut all = laws.to_vec();
            all.push(law);
            fit(frame, data, &all)
        };
        let Some(found) = found else { continue };
        if best
            .as_ref()
            .is_none_or(|(value, _)| found.log_likelihood > *value)
        {
            best = Some((found.log_likelihood, values));
        }
    }
    let (value, values) = best?;
    let mut all = laws.to_vec();
    all.push(Law { effect, values });
    let trials = TRIALS_PER_OCTAVE * (band.to_hz / band.from_hz).log2();
    let freedom = all[laws.len()].values.len() as f64;
    let judge = |nats: f64| tail::searched(tail::chi_squared(2.0 * nats, freedom), trials);
    // What is nowhere near significant need not be polished.
    let nats = value - base.log_likelihood;
    if nats < 2.0 {
        return None;
    }
    let fit = polish(frame, data, &mut all, laws.len(), 0.3)?;
    let nats = fit.log_likelihood - base.log_likelihood;
    Some(Found {
        law: all.pop()?,
        fit,
        nats,
        p_value: judge(nats),
    })
}

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

/// Place of a law's component in a fit.
pub fn component_of(frame: &Frame, laws: &[Law], which: usize) -> usize {
    frame.units().len() + laws[..which].iter().filter(|law| law.adds()).count()
}

/// Values of a law with the size that a fit gives it.
pub fn sized(frame: &Frame, laws: &[Law], which: usize, fit: &Fit) -> Vec<f64> {
    let law = &laws[which];
    let mut values = law.values.clone();
    if let Some(size) = law.effect.size() {
        let squared = fit.squared[component_of(frame, laws, which)];
        values[size] = squared.powf(1.0 / squared_power(law));
    }
    values
}

/// With which power of its size a law's density grows.
pub fn squared_power(law: &Law) -> f64 {
    use crate::model::effect::Quantity;
    let size = law.effect.size().unwrap_or(0);
    match law.effect.parameters(&law.values)[size].quantity {
        Quantity::Density => 1.0,
        _ => 2.0,
    }
}

/// Where and how far the bins depart from what is expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Lower end of the band, hertz.
    pub from_hz: f64,
    /// Upper end of it, hertz.
    pub to_hz: f64,
    /// Measured over expected power in it.
    pub ratio: f64,
    /// Probability of as large a departure in any band.
    pub p_value: f64,
}

/// The band in which the bins depart most from `expected`, over all bands of 1, 2, 4 ... bins.
pub fn departure(data: &Data, expected: &[f64]) -> Option<Departure> {
    let bins = data.len();
    let mut best: Option<Departure> = None;
    let mut trials = 0.0;
    let mut width = 1;
    while width <= bins {
        for start in (0..=bins - width).step_by((width / 2).max(1)) {
            trials += 1.0;
            let band = start..start + width;
            let freedom: f64 = data.dof[band.clone()].iter().sum();
            let ratio = band
                .clone()
                .map(|b| data.dof[b] * data.psd[b] / expected[b])
                .sum::<f64>()
                / freedom;
            let p = tail::mean_square(ratio, freedom);
            if best.is_none_or(|best| p < best.p_value) {
                best = Some(Departure {
                    from_hz: data.f_hz[band.start],
                    to_hz: data.f_hz[band.end - 1],
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
