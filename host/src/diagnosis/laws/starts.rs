//! Where a search of laws begins.

use std::sync::Arc;

use rayon::prelude::*;

use crate::diagnosis::laws::rise::Rise;
use crate::diagnosis::laws::{Law, behind, component, components_of};
use crate::diagnosis::record::bins::{Filtered, SpectralBins};
use crate::fit::likelihood::{Data, Fit};
use crate::model::catalogue::CATALOGUE;
use crate::model::effect::Band;
use crate::model::kind::Kind;
use crate::numeric::mixture::add_mixture;

/// Starts that are fitted, of those whose first rise is known: a choice, for each costs a fit.
const TRIED: usize = 16;

/// A spectrum with the laws that were fitted to it.
#[derive(Clone, Copy)]
pub struct Fitted<'a> {
    /// Its bins.
    pub bins: &'a SpectralBins,
    /// What was measured in them.
    pub data: &'a Data,
    /// Laws beyond the five terms.
    pub laws: &'a [Law],
    /// Fit of all.
    pub fit: &'a Fit,
}

impl Fitted<'_> {
    /// Whether no law of it filters.
    pub(super) fn is_unfiltered(&self) -> bool {
        self.laws.iter().all(Law::adds)
    }
}

/// Where searches begin: every law of the catalogue at its starting values. Made once for all bins.
pub struct Starts {
    starts: Vec<Start>,
}

/// One of them.
pub(super) struct Start {
    /// The law with the values that a search begins with, size 1.
    pub(super) law: Law,
    /// Its own component, where it adds one.
    pub(super) component: Option<Vec<f64>>,
    /// Its power at the nodes of the bins, where it filters.
    power: Option<Arc<[f64]>>,
}

impl Start {
    /// The bins behind it and behind what is `present` of these laws already, and all components there.
    pub(super) fn beside<'a>(
        &self,
        present: &Filtered<'a>,
        components: &[Vec<f64>],
        laws: &[Law],
    ) -> (Filtered<'a>, Vec<Vec<f64>>) {
        if let Some(power) = &self.power {
            let filtered = present.and(power);
            let components = components_of(&filtered, laws);
            return (filtered, components);
        }
        let own = match (&self.component, present.power()) {
            (Some(own), None) => Some(own.clone()),
            _ => component(present, &self.law),
        };
        let own = own.into_iter();
        (
            present.clone(),
            components.iter().cloned().chain(own).collect(),
        )
    }
}

impl Starts {
    /// For these bins; `None` if there are none.
    pub fn new(bins: &SpectralBins) -> Option<Self> {
        let all = bins.all();
        let band = Band {
            from_hz: all.first()?.f_hz,
            to_hz: all.last()?.f_hz,
        };
        let laws = CATALOGUE.iter().flat_map(|&effect| {
            let values = effect.starts(&band);
            values.into_iter().map(move |values| Law { effect, values })
        });
        let laws: Vec<Law> = laws.collect();
        let unfiltered = bins.unfiltered();
        let starts = laws
            .into_par_iter()
            .map(|law| Start {
                component: component(&unfiltered, &law),
                power: behind(bins, std::slice::from_ref(&law)).power().cloned(),
                law,
            })
            .collect();
        Some(Self { starts })
    }

    /// The laws that searches for an effect begin with, size 1.
    pub fn laws(&self, effect: Kind) -> impl Iterator<Item = &Law> {
        let laws = self.starts.iter().map(|start| &start.law);
        laws.filter(move |law| law.effect == effect)
    }

    /// Whether these values of an effect lie beyond all that its searches begin with, by a factor of two.
    pub(super) fn are_beyond(&self, effect: Kind, values: &[f64]) -> bool {
        values.iter().enumerate().any(|(place, &value)| {
            let begins = self
                .laws(effect)
                .filter_map(|law| law.values.get(place).copied());
            let (least, most) = begins
                .fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), one| {
                    (least.min(one), most.max(one))
                });
            !(0.5 * least..=2.0 * most).contains(&value)
        })
    }

    /// How many sorts of an effect are searched for, which differ in their counts.
    pub(super) fn sorts(&self, effect: Kind) -> usize {
        let mut sorts: Vec<Vec<f64>> = Vec::new();
        for law in self.laws(effect) {
            let counts = law.counts();
            if !sorts.contains(&counts) {
                sorts.push(counts);
            }
        }
        sorts.len()
    }

    /// What each of the starts of an effect with the counts of `law` changes in the expectation of a fit with `laws`.
    pub(super) fn directions(
        &self,
        bins: &SpectralBins,
        laws: &[Law],
        base: &Fit,
        law: &Law,
    ) -> impl Iterator<Item = Vec<f64>> {
        let present = behind(bins, laws);
        let own = self.starts.iter();
        let (effect, counts) = (law.effect, law.counts());
        own.filter(move |start| start.law.effect == effect && start.law.counts() == counts)
            .map(move |start| match &start.component {
                Some(component) => component.clone(),
                None => {
                    let (filtered, components) = start.beside(&present, &[], laws);
                    let mut change = filtered.fixed();
                    add_mixture(&mut change, &components, &base.squared);
                    let pairs = change.iter_mut().zip(&base.expected);
                    pairs.for_each(|(change, before)| *change -= before);
                    change
                }
            })
    }

    /// Those of an effect from which the likelihood rises most at first, beside what is `present` with these
    /// `components`; all of them where that says little, as behind a filter.
    pub(super) fn promising(
        &self,
        present: Fitted<'_>,
        components: &[Vec<f64>],
        effect: Kind,
    ) -> Vec<&Start> {
        let own = self.starts.iter();
        let mut own: Vec<&Start> = own.filter(|start| start.law.effect == effect).collect();
        // Of a filter no first rise is known.
        let adds = own.iter().all(|start| start.component.is_some());
        if !present.is_unfiltered() || !adds || own.len() <= TRIED {
            return own;
        }
        let Some(rise) = Rise::new(present.data, present.fit, components) else {
            return own;
        };
        let rise = |start: &Start| start.component.as_ref().map_or(0.0, |one| rise.of(one));
        let mut rises: Vec<(f64, &Start)> = own.drain(..).map(|one| (rise(one), one)).collect();
        rises.sort_by(|a, b| b.0.total_cmp(&a.0));
        rises.truncate(TRIED);
        rises.into_iter().map(|(_, one)| one).collect()
    }
}
