//! Several settlings that have a name, measured again: all at once, for what one loses another takes.
//!
//! Their sizes and the logarithms of their time constants, by the steps of C. F. Gauss in noise that is whitened; the inverse of the
//! matrix of these steps is the covariance.

use nalgebra::{DMatrix, DVector};

use super::{Settlings, first_sample};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::slow_change::{LEAST_GAIN, put_back};
use crate::diagnosis::explanation::{Candidate, Change, Explanation};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::matched_filter::{Half, Projection, Transform};
use crate::model::warmup::KIND;

/// Part by which an error is told too small or too large before it is told anew: a choice.
const OTHER_ERROR: f64 = 0.1;

/// Steps at most, and the gain that is worth one, nats: choices. From where they were found two do.
const STEPS: usize = 8;
const WORTH: f64 = 0.01;

/// What is to be done about several settlings where they are known better now, or known to be known otherwise.
pub fn proposals(look: &Look<'_>) -> Vec<Proposal> {
    let axis = look.axis;
    let all = axis.explanations().iter().enumerate();
    let known: Vec<(usize, &Explanation)> = all.filter(|(_, one)| one.kind() == KIND).collect();
    let waves: Vec<&Wave> = known.iter().flat_map(|(_, one)| one.waves()).collect();
    if known.len() < 2 || waves.len() != known.len() {
        return Vec::new();
    }
    let factor = axis.drift_factor();
    let values = put_back(axis, waves.iter().copied());
    let settlings = Settlings::new(axis, &values, factor);
    let first: Vec<Settling> = waves
        .iter()
        .filter_map(|wave| Settling::of(wave, factor))
        .collect();
    let Some(measured) = Measured::new(&settlings, first) else {
        return Vec::new();
    };
    let candidates = known.iter().zip(&measured.settlings).enumerate();
    let candidates = candidates.map(|(number, ((place, known), settling))| {
        let rate_hz = axis.rate_hz;
        let samples = settling.samples * factor as f64;
        let [size_sd, log_sd] = measured.errors(number);
        let first = first_sample(settling.samples, factor);
        let amplitude = first * settling.size;
        let values = [
            Value::normal(amplitude, first * size_sd),
            Value::log_normal(samples / rate_hz, log_sd),
        ];
        let wave = Wave::WarmUp { amplitude, samples };
        Candidate {
            amends: Some(*place),
            held_out_nats: known.held_out_nats,
            ..Candidate::new(
                Estimate::new(KIND, values),
                known.p_value,
                known.freedom,
                Change::Waves(vec![wave]),
            )
        }
    });
    let candidates: Vec<Candidate> = candidates.collect();
    let pairs = known.iter().zip(&candidates);
    let is_known_otherwise = pairs
        .map(|((_, known), now)| (known.effect.values[0], now.effect.values[0]))
        .any(|(before, now)| {
            let [before, now] = [before, now].map(|one| one.map_or(0.0, |one| one.sd()));
            (now / before).ln().abs() > OTHER_ERROR
        });
    if measured.gained_nats < LEAST_GAIN && !is_known_otherwise {
        return Vec::new();
    }
    let boxed = candidates.into_iter().map(Box::new);
    boxed.map(Proposal::Explain).collect()
}

/// A settling on a slow record.
#[derive(Clone)]
struct Settling {
    size: f64,
    /// Time constant, means.
    samples: f64,
}

impl Settling {
    fn of(wave: &Wave, factor: usize) -> Option<Self> {
        let Wave::WarmUp { amplitude, samples } = wave else {
            return None;
        };
        let samples = samples / factor as f64;
        Some(Self {
            size: amplitude / first_sample(samples, factor),
            samples,
        })
    }
}

/// Settlings at the top of their likelihood.
struct Measured {
    settlings: Vec<Settling>,
    /// Of all sizes, then of the logarithms of all time constants.
    covariance: DMatrix<f64>,
    gained_nats: f64,
}

impl Measured {
    fn new(record: &Settlings, first: Vec<Settling>) -> Option<Self> {
        let mut best = Point::new(record, first)?;
        let begun = best.nats;
        for _ in 0..STEPS {
            let next = best.stepped().and_then(|next| Point::new(record, next));
            match next.filter(|next| next.nats > best.nats + WORTH) {
                Some(next) => best = next,
                None => break,
            }
        }
        Some(Self {
            covariance: best.information.clone().cholesky()?.inverse(),
            gained_nats: best.nats - begun,
            settlings: best.settlings,
        })
    }

    /// Standard deviations of a settling's size and of the logarithm of its time constant.
    fn errors(&self, number: usize) -> [f64; 2] {
        let places = [number, self.settlings.len() + number];
        places.map(|place| self.covariance[(place, place)].sqrt())
    }
}

/// Settlings with what the record says of them.
struct Point {
    settlings: Vec<Settling>,
    /// Log-likelihood over that without them.
    nats: f64,
    slopes: DVector<f64>,
    information: DMatrix<f64>,
}

impl Point {
    fn new(record: &Settlings, settlings: Vec<Settling>) -> Option<Self> {
        /// Step of a logarithm from which its slope is taken.
        const STEP: f64 = 1e-3;
        let [shortest, longest] = record.ends();
        let is_held = |one: &Settling| (shortest..=longest).contains(&one.samples);
        if !settlings.iter().all(is_held) {
            return None;
        }
        let mut columns: Vec<Transform> = settlings
            .iter()
            .map(|one| record.wave(one.samples))
            .collect();
        let mut units = vec![1.0; settlings.len()];
        for one in &settlings {
            let [more, less] = [STEP, -STEP].map(|step| record.wave(one.samples * step.exp()));
            let mut slope = more;
            slope.add_scaled(-1.0, &less);
            columns.push(slope);
            units.push(one.size / (2.0 * STEP));
        }
        let product = |a: &Transform, b: &Transform| {
            Projection::new(a, &record.density, b, Half::Both).product
        };
        let count = columns.len();
        let information = DMatrix::from_fn(count, count, |row, column| {
            units[row] * units[column] * product(&columns[row], &columns[column])
        });
        let of_record = columns.iter().zip(&units);
        let of_record = of_record.map(|(column, unit)| unit * product(&record.record, column));
        let of_record = DVector::from_iterator(count, of_record);
        let sizes = settlings.iter().map(|one| one.size);
        let sizes = sizes.chain(settlings.iter().map(|_| 0.0));
        let sizes = DVector::from_iterator(count, sizes);
        let taken = &information * &sizes;
        Some(Self {
            nats: sizes.dot(&of_record) - 0.5 * sizes.dot(&taken),
            slopes: of_record - taken,
            information,
            settlings,
        })
    }

    /// Where its slopes lead.
    fn stepped(&self) -> Option<Vec<Settling>> {
        let steps = self.information.clone().cholesky()?.solve(&self.slopes);
        let count = self.settlings.len();
        let moved = self
            .settlings
            .iter()
            .enumerate()
            .map(|(number, one)| Settling {
                size: one.size + steps[number],
                samples: one.samples * steps[count + number].exp(),
            });
        Some(moved.collect())
    }
}
