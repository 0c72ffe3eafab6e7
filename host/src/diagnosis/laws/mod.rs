//! Effects that change the spectrum's shape: search of their parameters by likelihood.
//!
//! The sizes of additive laws enter linearly, as the five terms do; shapes (corners, widths,
//! exponents) are moved by turns in their logarithms until nothing gains.

pub mod departure;
pub mod gain;
mod polish;
pub mod rise;
pub mod search;
pub mod spread;
mod starts;

use crate::diagnosis::record::bins::{Filtered, SpectralBins};
use crate::fit::likelihood::scoring::maximise_beside;
use crate::fit::likelihood::{Data, Fit};
use crate::model::Term;
use crate::model::effect::{Distortion, Part, Quantity};
use crate::model::kind::Kind;
use crate::numeric::mixture::add_mixture;

/// An effect with its values; the size, if it has one, is 1 and its square is a component.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// The kind of effect.
    pub effect: Kind,
    /// All its parameters, in the order and the units of the catalogue.
    pub values: Vec<f64>,
}

impl Law {
    /// Places of the parameters that are neither the size nor a count: what is moved in its logarithm.
    pub fn shape(&self) -> impl Iterator<Item = usize> + use<> {
        let size = self.effect.size();
        self.moves().filter(move |&place| Some(place) != size)
    }

    /// Places of the parameters that may be any number: all but counts.
    pub fn moves(&self) -> impl Iterator<Item = usize> + use<> {
        let parameters = self.effect.parameters(&self.values);
        (0..self.values.len()).filter(move |&place| parameters[place].quantity != Quantity::Count)
    }

    /// The counts among its parameters: laws of one kind that differ in them are searched for one after the other.
    pub fn counts(&self) -> Vec<f64> {
        let parameters = self.effect.parameters(&self.values);
        let pairs = self.values.iter().zip(parameters);
        let counts = pairs.filter(|(_, one)| one.quantity == Quantity::Count);
        counts.map(|(value, _)| *value).collect()
    }

    /// Numbers that are fitted.
    pub fn freedom(&self) -> f64 {
        self.moves().count() as f64
    }

    /// Whether it is what its name says, and lies where the bins could show it: frequencies and widths of
    /// what is added between a tenth of the lowest bin and half the rate, since what is narrower than the record
    /// resolves is found to be a line by that. A filter's corner may lie beyond: its flank is seen.
    pub fn is_sound(&self, bins: &SpectralBins) -> bool {
        if !self.effect.is_sound(&self.values) {
            return false;
        }
        let lowest_hz = bins.all().first().map_or(0.0, |bin| bin.f_hz);
        let band_hz = 0.1 * lowest_hz..=0.5 * bins.rate_hz();
        let parameters = self.effect.parameters(&self.values);
        let mut pairs = parameters.iter().zip(&self.values);
        let is_inside = |value| band_hz.contains(value);
        !self.adds()
            || pairs.all(|(one, value)| one.quantity != Quantity::Hertz || is_inside(value))
    }

    /// Whether it adds noise of its own, and filters none.
    pub fn adds(&self) -> bool {
        self.effect.size().is_some()
    }
}

/// Expectations of all components: the five terms' (without the ramp), then one of each law that
/// adds, all of them through the laws that filter.
pub fn components(bins: &SpectralBins, laws: &[Law]) -> Vec<Vec<f64>> {
    components_of(&behind(bins, laws), laws)
}

/// The same where the `bins` are behind the laws that filter.
pub fn components_of(bins: &Filtered<'_>, laws: &[Law]) -> Vec<Vec<f64>> {
    let terms: Vec<Box<dyn Term>> = laws.iter().filter_map(term).collect();
    bins.expect_all(&terms)
}

/// The bins behind those of the laws that filter.
pub fn behind<'a>(bins: &'a SpectralBins, laws: &[Law]) -> Filtered<'a> {
    let filters = filters(laws);
    if filters.is_empty() {
        return bins.unfiltered();
    }
    bins.behind(|f_hz| power_of(&filters, f_hz, bins.rate_hz()))
}

/// Density of the white noise that is known to join behind those of the laws that filter; zero where there are none.
pub fn floor(bins: &SpectralBins, laws: &[Law]) -> f64 {
    if laws.iter().all(Law::adds) {
        0.0
    } else {
        bins.floor()
    }
}

/// What laws of these squares make the bins expect, with what joins behind those that filter.
pub fn expected(bins: &SpectralBins, laws: &[Law], squared: &[f64]) -> Vec<f64> {
    let filtered = behind(bins, laws);
    let mut expected = filtered.fixed();
    add_mixture(&mut expected, &components_of(&filtered, laws), squared);
    expected
}

/// Those of the laws that filter.
pub fn filters(laws: &[Law]) -> Vec<Box<dyn Distortion>> {
    let parts = laws.iter().map(|law| law.effect.part(&law.values));
    let filters = parts.filter_map(|part| match part {
        Part::Distortion(filter) => Some(filter),
        Part::Term(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => None,
    });
    filters.collect()
}

/// Power that all of these filters let through.
pub fn power_of(filters: &[Box<dyn Distortion>], f_hz: f64, rate_hz: f64) -> f64 {
    filters.iter().map(|one| one.power(f_hz, rate_hz)).product()
}

/// The same as a record [shows](Distortion::shown) it.
pub fn shown_of(filters: &[Box<dyn Distortion>], f_hz: f64, rate_hz: f64) -> f64 {
    filters.iter().map(|one| one.shown(f_hz, rate_hz)).product()
}

/// Component of a law in bins behind all filters; `None` for one that filters itself.
fn component(bins: &Filtered<'_>, law: &Law) -> Option<Vec<f64>> {
    Some(bins.expect(&*term(law)?))
}

/// What a law adds; `None` for one that filters.
fn term(law: &Law) -> Option<Box<dyn Term>> {
    match law.effect.part(&law.values) {
        Part::Term(term) => Some(term),
        Part::Distortion(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => None,
    }
}

/// The likeliest sizes of the five terms and of these laws, their shapes as they are.
pub fn fit(bins: &SpectralBins, data: &Data, laws: &[Law]) -> Option<Fit> {
    let filtered = behind(bins, laws);
    maximise_beside(
        data,
        &components_of(&filtered, laws),
        &filtered.fixed(),
        None,
    )
}

/// Place of a law's component in a fit.
pub fn component_of(bins: &SpectralBins, laws: &[Law], which: usize) -> usize {
    bins.units().len() + laws[..which].iter().filter(|law| law.adds()).count()
}

/// Values of a law with the size that a fit gives it.
pub fn sized(bins: &SpectralBins, laws: &[Law], which: usize, fit: &Fit) -> Vec<f64> {
    let law = &laws[which];
    let mut values = law.values.clone();
    if let Some(size) = law.effect.size() {
        let squared = fit.squared[component_of(bins, laws, which)];
        values[size] = squared.powf(1.0 / squared_power(law));
    }
    values
}

/// With which power of its size a law's density grows.
pub fn squared_power(law: &Law) -> f64 {
    let size = law.effect.size().unwrap_or(0);
    match law.effect.parameters(&law.values)[size].quantity {
        Quantity::Density => 1.0,
        _ => 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{RATE_HZ, Trial, noise};
    use crate::model::{resonance, rolloff};

    #[test]
    fn what_is_added_rings_and_lies_where_bins_could_show_it() {
        let axis = Trial::new(noise(1)).axis;
        let is_sound = |effect, values: &[f64]| {
            let values = values.to_vec();
            Law { effect, values }.is_sound(&axis.bins)
        };
        assert!(is_sound(resonance::KIND, &[20.0, 2.0, 1.0]));
        assert!(!is_sound(resonance::KIND, &[20.0, 18.0, 1.0]), "too wide");
        assert!(!is_sound(resonance::KIND, &[0.6 * RATE_HZ, 2.0, 1.0]));
        // Of a filter the flank is seen.
        assert!(is_sound(rolloff::KIND, &[0.6 * RATE_HZ]));
    }
}
