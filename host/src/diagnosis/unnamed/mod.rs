//! What has no name is in the model all the same.
//!
//! Once every detector and every doubt is heard, the spectrum of what is left is compared with the model once
//! more, excluded bands included. Where it departs, bands of noise without a name are added until nothing
//! significant is left, and the sizes of everything are fitted anew together with them: a name explains a part of a
//! model that is right already, and what a name does not explain is not missing from the model.

mod bands;
mod dictionary;
pub mod long_times;
mod sizes;
#[cfg(test)]
mod tests;
mod with_bands;

use rayon::prelude::*;

use self::dictionary::Band;
use self::with_bands::{ANOTHER, WithBands};
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::doubt::unbounded;
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::laws;
use crate::diagnosis::laws::departure::departure;
use crate::fit::likelihood::Data;
use crate::model::effect::Part;
use crate::numeric::mixture::add_mixture;

/// What became of a model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Completed {
    /// Probability of what was missing, in data of the model without it; `None` where nothing was.
    pub p_value: Option<f64>,
    /// Numbers of the explanations that were taken back, one after the other.
    pub withdrawn: Vec<usize>,
}

/// Adds to an axis's model what none of its explanations speaks for, where anything is missing at a `level`. A tone whose
/// law does not hold beside that is taken back, and so is a law without which as much is explained, and what is [known too
/// little](unbounded) beside it: they are left to the noise without a name.
pub fn complete(axis: &mut AxisState, level: f64) -> Completed {
    let mut withdrawn = Vec::new();
    loop {
        let absorbed_hz = axis.absorbed_hz();
        let of_noise = axis.bins.dof_beside(absorbed_hz.as_slice());
        let (tones, dof) = Tone::all(axis, &of_noise);
        let found = lacking(axis, dof, &tones, level).map(|found| found.with_tones(axis, &tones));
        let Some(found) = found else {
            let p_value = None;
            return Completed { p_value, withdrawn };
        };
        let place = match found.bands.another() {
            Some(number) => axis.withdraw_tone(number),
            None => {
                let number = replaced(axis, &found).or_else(|| needless(axis, &found, &tones));
                number.and_then(|number| axis.withdraw_law(number))
            }
        };
        if let Some(place) = place {
            withdrawn.push(place);
            if axis.refresh().is_ok() {
                continue;
            }
            // What is left cannot be fitted: the model stays as it was.
            let p_value = None;
            return Completed { p_value, withdrawn };
        }
        // The fit is that of the noise: where tones are, it says nothing by itself. Their sizes stay as they were measured, which is
        // better than a law of how they wander can tell.
        let mut fitted_beside = axis.tones_hz();
        fitted_beside.extend(absorbed_hz);
        let data = Data {
            dof: axis.bins.dof_beside(&fitted_beside),
            ..axis.data.clone()
        };
        axis.complete(found.bands.laws, found.bands.fit, data);
        let unsure = unbounded::least_sure(axis);
        let p_value = Some(found.p_value);
        let Some((place, _)) = unsure else {
            return Completed { p_value, withdrawn };
        };
        axis.withdraw_one(place);
        withdrawn.push(place);
        if axis.refresh().is_err() {
            return Completed { p_value, withdrawn };
        }
    }
}

/// What a model lacks.
struct Lacking {
    /// Probability of as much by chance.
    p_value: f64,
    /// The spectrum that lacks it.
    data: Data,
    /// The model with what it lacks.
    bands: WithBands,
    /// How that was fitted.
    fitted: Fitted,
}

/// A model with bands beside these tones.
type Fitted = fn(&AxisState, &Data, &[Vec<f64>], &[Band]) -> Option<WithBands>;

impl Lacking {
    /// With all tones of an axis as they were measured, where the spectrum is as likely then: by what a law costs, at most. Where a
    /// band stands upon a tone, it does not say whose the power is.
    fn with_tones(self, axis: &AxisState, tones: &[Vec<f64>]) -> Self {
        if self.bands.another().is_none() {
            return self;
        }
        let fitted: Fitted = bands::beside;
        let least = self.bands.worth_nats() - self.bands.cost_nats;
        let bands = fitted(axis, &self.data, tones, &[]);
        match bands.filter(|bands| bands.worth_nats() > least) {
            Some(bands) => Self {
                bands,
                fitted,
                ..self
            },
            None => self,
        }
    }

    /// What an axis lacks without the law of this number. The search begins with the bands `known`.
    fn without(&self, axis: &AxisState, number: usize, known: &[Band]) -> Option<WithBands> {
        let mut other = axis.clone();
        other.withdraw_law(number)?;
        other.refresh().ok()?;
        let (tones, _) = Tone::all(&other, &self.data.dof);
        (self.fitted)(&other, &self.data, &tones, known)
    }
}

/// What a model lacks where its bins have these degrees of freedom; `None` where chance makes as much at that `level`.
fn lacking(axis: &AxisState, dof: Vec<f64>, tones: &[Vec<f64>], level: f64) -> Option<Lacking> {
    let data = Data {
        dof,
        ..axis.data.clone()
    };
    let mut expected = axis.fit.expected.clone();
    add_mixture(&mut expected, tones, &vec![1.0; tones.len()]);
    let p_value = departure(&data, &expected)?.p_value;
    let fitted: Fitted = bands::fitted;
    let bands = (p_value < level).then(|| fitted(axis, &data, tones, &[]))??;
    Some(Lacking {
        p_value,
        data,
        bands,
        fitted,
    })
}

/// Number of the law of which bands have the largest part, if that is most of it.
fn replaced(axis: &AxisState, found: &Lacking) -> Option<usize> {
    let adding = (0..axis.laws.len()).filter(|number| axis.laws[*number].effect.size().is_some());
    let left = adding.map(|number| {
        let component = laws::component_of(&axis.bins, &axis.laws, number);
        let [before, beside_bands] =
            [&axis.fit, &found.bands.fit].map(|fit| fit.squared[component]);
        (number, beside_bands / before)
    });
    let least = left.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (least.1 < ANOTHER.recip()).then_some(least.0)
}

/// Number of the law that is needed least beside noise without a name, if the spectrum is [better](WithBands::is_better_than)
/// without it: where bands are needed anyway, a name has to explain what they do not. A search ends now at one set of bands, now
/// at another: each of both models is also asked what it is worth with the bands of the other.
fn needless(axis: &AxisState, found: &Lacking, tones: &[Vec<f64>]) -> Option<usize> {
    let with = &found.bands;
    let numbers = (0..axis.laws.len()).into_par_iter();
    let models = numbers.filter_map(|number| Some((number, found.without(axis, number, &[])?)));
    let worth = |one: &(usize, WithBands)| one.1.worth_nats();
    let (number, mut least) = models.max_by(|a, b| worth(a).total_cmp(&worth(b)))?;
    if let Some(again) = found.without(axis, number, &with.bands())
        && again.worth_nats() > least.worth_nats()
    {
        least = again;
    }
    let again = || (found.fitted)(axis, &found.data, tones, &least.bands());
    let is_needless = |with: &WithBands| least.is_better_than(with);
    (is_needless(with) && again().is_none_or(|with| is_needless(&with))).then_some(number)
}

/// A tone that has a name and is no part of any fit.
struct Tone {
    /// What the bins are expected to be of it.
    expected: Vec<f64>,
    /// How many independent values give its spectrum its shape.
    shaped_by: f64,
}

impl Tone {
    /// All tones of an axis, bin by bin, and the degrees of freedom of the bins with them, `of_noise` without.
    fn all(axis: &AxisState, of_noise: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let named = axis.explanations().iter();
        let tones: Vec<Self> = named
            .filter(|one| one.is_tone())
            .map(|one| Self::new(axis, one))
            .collect();
        let dof = freedom(&axis.fit.expected, of_noise, &tones);
        (tones.into_iter().map(|one| one.expected).collect(), dof)
    }

    fn new(axis: &AxisState, one: &Explanation) -> Self {
        let Part::Term(term) = one.kind().part(&one.effect.plain()) else {
            return Self {
                expected: vec![0.0; axis.data.len()],
                shaped_by: f64::INFINITY,
            };
        };
        Self {
            // As it was measured: behind all filters.
            expected: laws::behind(&axis.bins, &[]).expect(&*term),
            shaped_by: term.shaped_by(axis.residual.len() as f64 / axis.rate_hz),
        }
    }
}

/// Degrees of freedom of bins that are as many `own` for noise, where `noise` is expected and `tones` beside it. How long
/// a frequency that wanders was in a bin is known as well as its share of a few independent values is: with a share `s`
/// of `n` of them the power has the relative variance `1 / (n s)`, beside `2 / dof`.
fn freedom(noise: &[f64], own: &[f64], tones: &[Tone]) -> Vec<f64> {
    let mut sum = noise.to_vec();
    for tone in tones {
        add_mixture(&mut sum, std::slice::from_ref(&tone.expected), &[1.0]);
    }
    let mut inverse: Vec<f64> = own.iter().map(|dof| dof.recip()).collect();
    for tone in tones.iter().filter(|one| one.shaped_by.is_finite()) {
        let powers = tone.expected.iter().zip(own).map(|(one, dof)| one * dof);
        let powers: Vec<f64> = powers.collect();
        let all: f64 = powers.iter().sum();
        for (bin, power) in powers.iter().enumerate().filter(|(_, power)| **power > 0.0) {
            let values = tone.shaped_by * power / all;
            inverse[bin] += 0.5 * (tone.expected[bin] / sum[bin]).powi(2) / values;
        }
    }
    inverse.iter().map(|one| one.recip()).collect()
}
