//! The bins behind filters that the signal chain does not have.

use std::sync::Arc;

use super::SpectralBins;
use crate::fit::likelihood::components::SEEN;
use crate::model::Term;

impl SpectralBins {
    /// The bins behind nothing but the chain.
    pub fn unfiltered(&self) -> Filtered<'_> {
        Filtered {
            bins: self,
            power: None,
        }
    }

    /// The bins behind one more filter of this `power`, which is asked once at each node.
    pub fn behind(&self, power: impl Fn(f64) -> f64) -> Filtered<'_> {
        let nodes = self.nodes.f_hz().iter();
        Filtered {
            bins: self,
            power: Some(nodes.map(|&f_hz| power(f_hz)).collect()),
        }
    }
}

/// Spectral bins behind a filter: what laws ahead of it are expected to be in them.
#[derive(Clone)]
pub struct Filtered<'a> {
    bins: &'a SpectralBins,
    /// Power of the filter at the nodes, if there is one.
    power: Option<Arc<[f64]>>,
}

impl Filtered<'_> {
    /// Expectations of the bins for a term ahead of filter and chain.
    pub fn expect(&self, term: &dyn Term) -> Vec<f64> {
        self.bins.estimate.operator.apply(&self.densities(term))
    }

    /// [`SpectralBins::units`], the filter ahead of what joins behind the converter, and then the terms', as
    /// [`Self::expect`] has them.
    pub fn expect_all(&self, terms: &[Box<dyn Term>]) -> Vec<Vec<f64>> {
        let bins = self.bins;
        let operator = &bins.estimate.operator;
        let terms = terms.iter().map(|term| self.densities(&**term));
        if self.power.is_none() {
            let terms: Vec<Vec<f64>> = terms.collect();
            return [bins.units.clone(), operator.apply_all(&terms)].concat();
        }
        let units = bins.densities.iter();
        let units = units.map(|densities| self.through(densities.clone()));
        let mut all = operator.apply_all(&units.chain(terms).collect::<Vec<_>>());
        let behind = bins.units[SEEN.len()..].iter().cloned();
        all.splice(SEEN.len()..SEEN.len(), behind);
        all
    }

    /// Power of the filter at the nodes; `None` where there is none.
    pub fn power(&self) -> Option<&Arc<[f64]>> {
        self.power.as_ref()
    }

    /// The same behind one more filter of this `power` at the nodes.
    pub fn and(&self, power: &Arc<[f64]>) -> Self {
        let both = match &self.power {
            Some(own) => own.iter().zip(power.iter()).map(|(a, b)| a * b).collect(),
            None => Arc::clone(power),
        };
        Self {
            bins: self.bins,
            power: Some(both),
        }
    }

    /// The part of the bins' expectation that no fit changes: [what joins behind the filter](SpectralBins::know_floor), if there
    /// is one.
    pub fn fixed(&self) -> Vec<f64> {
        if self.power.is_some() && self.bins.floor > 0.0 {
            self.bins.of_floor.clone()
        } else {
            vec![0.0; self.bins.dof.len()]
        }
    }

    /// Densities of a term at the nodes, behind filter and chain.
    fn densities(&self, term: &dyn Term) -> Vec<f64> {
        let mut behind = self.through(self.bins.term_densities(term));
        let pairs = behind.iter_mut().zip(&self.bins.chain_power);
        pairs.for_each(|(density, power)| *density *= power);
        behind
    }

    /// What the filter lets through of densities at the nodes.
    fn through(&self, mut densities: Vec<f64>) -> Vec<f64> {
        let power = self.power.iter().flat_map(|power| power.iter());
        let pairs = densities.iter_mut().zip(power);
        pairs.for_each(|(density, power)| *density *= power);
        densities
    }
}
