//! A kind of effect that a record can hold beyond the five terms.
//!
//! One file and one line in the [catalogue](super::catalogue) make an effect: from there on a
//! model file can name it, the simulator makes it and a diagnosis can propose it. Its parameters
//! are a list of numbers with names; those that come in rows (the harmonics of a hum, the steps of
//! a record) are numbered from 1.

use std::collections::BTreeMap;

use super::follows::Follows;
use super::marks::Mark;
pub use super::parameter::{Parameter, Quantity};
use super::{Line, Seed, Term};

/// A kind of effect.
pub trait Effect: Send + Sync {
    /// What it is called in model files, such as `markov`.
    fn name(&self) -> &'static str;

    /// What it is physically, in a sentence.
    fn meaning(&self) -> &'static str;

    /// Its parameters, in the order of `values`. Only an effect with a row of parameters looks at
    /// `values`, and only at their number.
    fn parameters(&self, values: &[f64]) -> Vec<Parameter>;

    /// What to look at on the bench to make sure, in a sentence.
    fn check(&self, values: &[f64]) -> String;

    /// Where it shows in pictures. Only an effect that shows at places of its own has any.
    fn marks(&self, _values: &[f64]) -> Vec<Mark> {
        Vec::new()
    }

    /// Which parameter is the effect's size: all the effect does is proportional to it, or to its
    /// square if it is in the unit of the signal. `None` for effects that have no such parameter.
    fn size(&self) -> Option<usize> {
        None
    }

    /// Whether values make sense together; beyond, another effect is meant.
    fn is_sound(&self, _values: &[f64]) -> bool {
        true
    }

    /// Values, with size 1, from which a search for this effect in the spectrum's shape should
    /// begin; none for an effect that does not show there.
    fn starts(&self, _band: &Band) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// Values beside these that are meant where they are as likely, such as whole numbers of samples; `None` where none are.
    fn meant(&self, _values: &[f64], _rate_hz: f64) -> Option<Vec<f64>> {
        None
    }

    /// Nats that these values cost where another effect does the same: what hardly anybody builds is
    /// the less likely name. `rate_hz` is the number of samples a second.
    fn surprise_nats(&self, _values: &[f64], _rate_hz: f64) -> f64 {
        0.0
    }

    /// The effect with these values, which are as many as [`Effect::parameters`] says and in
    /// range.
    fn part(&self, values: &[f64]) -> Part;
}

/// The frequencies that a spectrum covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lowest frequency of the band, hertz.
    pub from_hz: f64,
    /// Highest frequency of the band, hertz.
    pub to_hz: f64,
}

impl Band {
    /// Frequencies from the lowest to the highest, `per_octave` an octave.
    pub fn steps(&self, per_octave: f64) -> impl Iterator<Item = f64> {
        let (from_hz, to_hz) = (self.from_hz, self.to_hz);
        let count = ((to_hz / from_hz).log2() * per_octave).max(0.0) as usize;
        (0..=count).map(move |step| from_hz * (step as f64 / per_octave).exp2())
    }
}

/// What an effect adds to a model.
pub enum Part {
    /// A process that is added to the others, ahead of the signal chain.
    Term(Box<dyn Term>),
    /// Something that happens to the samples of everything else, behind the signal chain.
    Distortion(Box<dyn Distortion>),
    /// The samples are taken this many times as fast as the nominal rate says; all the rest of
    /// the axis keeps true time.
    Clock(f64),
    /// There are so many values a second, hertz, and each is written until there is the next; all the rest of the axis is
    /// theirs.
    Hold(f64),
    /// Something that follows a series which is not in the model.
    Follows(Follows),
}

/// Acts on the samples of everything else.
pub trait Distortion: Send + Sync {
    /// Where it acts: a diagnosis writes distortions in this order, which is that in which a simulation applies them.
    fn stage(&self) -> Stage;

    /// Factor on the two-sided density of everything else; 1 unless it is a filter.
    fn power(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        1.0
    }

    /// The same as a record shows it that has a beginning and an end: not all of what is shut out is gone from it.
    fn shown(&self, f_hz: f64, rate_hz: f64) -> f64 {
        self.power(f_hz, rate_hz)
    }

    /// Autocovariances of the noise that it adds to what its [power](Distortion::power) leaves, from lag zero on: one of white
    /// noise, none where it adds nothing.
    fn adds(&self, _incoming: &Incoming<'_>) -> Vec<f64> {
        Vec::new()
    }

    /// Does to data what the law says; the same `seed` does the same.
    fn distorter(&self, rate_hz: f64, seed: Seed) -> Box<dyn Distorter>;
}

/// Where a distortion acts on the way from the sensor to the reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Keeps what is slow out of the noise. The level is that of what comes behind, an amplifier or a converter.
    Coupling,
    /// On the noise as it arises.
    Noise,
    /// A filter on all of it.
    Filter,
    /// Joins behind all filters.
    Sample,
    /// At the ends of a range.
    Range,
    /// As numbers are made of it.
    Number,
    /// As these are read.
    Reading,
}

/// What a distortion acts on.
pub struct Incoming<'a> {
    /// Samples a second.
    pub rate_hz: f64,
    /// Two-sided density as a function of frequency in hertz, from above zero to half the rate.
    pub density: &'a dyn Fn(f64) -> f64,
    /// Power at single frequencies.
    pub lines: &'a [Line],
}

/// Alters one axis of a record, block after block.
pub trait Distorter: Send {
    /// Alters the next samples; it may leave some out or add some.
    fn apply(&mut self, samples: &mut Vec<f64>);
}

/// Puts named values into the order of an effect's parameters.
///
/// # Errors
/// In words, if a parameter is missing, unknown or out of its range.
pub fn in_order(effect: &dyn Effect, named: &BTreeMap<String, f64>) -> Result<Vec<f64>, String> {
    let is_named = |one: &Parameter| named.contains_key(one.name.as_ref());
    let mut parameters = effect.parameters(&vec![0.0; named.len()]);
    loop {
        let left_out = parameters
            .iter()
            .filter(|one| one.optional && !is_named(one));
        let all = effect.parameters(&vec![0.0; named.len() + left_out.count()]);
        if all.len() <= parameters.len() {
            break;
        }
        // Where something is left out of every row, there may be more rows than as many values make.
        parameters = all;
    }
    let expected = || {
        let names: Vec<&str> = parameters.iter().map(|one| one.name.as_ref()).collect();
        names.join(", ")
    };
    if let Some(unknown) = named
        .keys()
        .find(|&name| parameters.iter().all(|one| one.name != name.as_str()))
    {
        return Err(format!(
            "{}: no parameter `{unknown}`; expected {}",
            effect.name(),
            expected()
        ));
    }
    let value = |parameter: &Parameter| {
        let name = parameter.name.as_ref();
        let none = parameter.optional.then_some(&0.0);
        let value = *named.get(name).or(none).ok_or_else(|| {
            format!(
                "{}: parameter `{name}` ({}) is missing; expected {}",
                effect.name(),
                parameter.meaning,
                expected()
            )
        })?;
        if !parameter.quantity.admits(value) {
            return Err(format!(
                "{}: parameter `{name}` ({}) is {value}; expected {}",
                effect.name(),
                parameter.meaning,
                parameter.quantity.range()
            ));
        }
        Ok(value)
    };
    parameters.iter().map(value).collect()
}
