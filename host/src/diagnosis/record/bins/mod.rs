//! What the spectra of one axis have in common while its residual shrinks and its model grows:
//! the bins, their degrees of freedom, and the expectation of any law in them.
//!
//! These depend on length, gaps and chain alone, and cost far more than a spectrum or a fit; they
//! are made once.

mod filtered;

use std::ops::Range;
use std::sync::Arc;

use crate::chain::Chain;
use crate::fit::design::Design;
use crate::fit::likelihood::Data;
use crate::fit::likelihood::components::SEEN;
use crate::model::{Frequencies, Term};
use crate::spectrum::estimate::{self, Estimate};
use crate::spectrum::{Cascade, Plan, Settings};
pub use filtered::Filtered;

/// What is left of the weight of a bin that is excluded: no number, but no zero to divide by.
const NOTHING: f64 = 1e-9;

/// Bins an octave: a choice. One is 4.4 % of its frequency wide.
const BINS_PER_OCTAVE: f64 = 16.0;

/// What the spectra of one axis have in common: bins, and what they are expected to be.
#[derive(Clone)]
pub struct SpectralBins {
    settings: Settings,
    estimate: Estimate,
    design: Arc<Design>,
    /// Expectations of the bins for each of [`SEEN`] at coefficient 1; behind a converter also for
    /// white noise that joins after its filter, such as rounding.
    units: Vec<Vec<f64>>,
    /// The nodes of all bins.
    nodes: Arc<Frequencies>,
    /// Power of the signal chain at the nodes.
    chain_power: Vec<f64>,
    /// Densities of each of [`SEEN`] at the nodes, behind the chain.
    densities: Vec<Vec<f64>>,
    data: Data,
    /// Degrees of freedom of the bins, excluded ones included.
    dof: Vec<f64>,
    /// Bands, hertz, that no fit and no test looks at.
    left_out: Vec<Range<f64>>,
    rate_hz: f64,
    band_limited: bool,
    /// Density of white noise that joins behind all filters, zero where none is known, and what the bins expect of it.
    floor: f64,
    of_floor: Vec<f64>,
    plan: Plan,
}

impl SpectralBins {
    /// For records like `values`, with missing samples where these are not finite. `None` where
    /// they are too few for a spectrum, or all the same.
    pub fn new(values: &[f64], rate_hz: f64, chain: Option<&Chain>) -> Option<Self> {
        Self::of_parts([(0, values)], rate_hz, chain)
    }

    /// The same for parts of a record, each with its first index, ascending.
    pub fn of_parts<'a>(
        parts: impl IntoIterator<Item = (usize, &'a [f64])>,
        rate_hz: f64,
        chain: Option<&Chain>,
    ) -> Option<Self> {
        let settings = Settings {
            bins_per_octave: BINS_PER_OCTAVE,
            ..Settings::default()
        };
        let plan = Plan::new();
        let cascade = filled(&plan, parts);
        let estimate = Estimate::new(&cascade, rate_hz, &settings);
        let design = Arc::new(Design::new(rate_hz, chain));
        let nodes = Arc::new(Frequencies::new(estimate.operator.nodes_hz(), rate_hz));
        let chain_power: Vec<f64> = nodes
            .f_hz()
            .iter()
            .map(|&f_hz| design.power(f_hz))
            .collect();
        let densities: Vec<Vec<f64>> = SEEN
            .iter()
            .map(|&one| {
                let pairs = nodes.f_hz().iter().zip(&chain_power);
                pairs
                    .map(|(&f_hz, power)| design.unit_spectrum(one, f_hz) * power)
                    .collect()
            })
            .collect();
        let mut units: Vec<Vec<f64>> = densities
            .iter()
            .map(|densities| estimate.operator.apply(densities))
            .collect();
        let band_limited = chain.is_some_and(|chain| chain.converter.is_some());
        if band_limited {
            units.push(estimate.operator.apply(&vec![1.0; chain_power.len()]));
        }
        let data = Data::new(&estimate, 1.0)?;
        Some(Self {
            settings,
            estimate,
            design,
            units,
            densities,
            nodes,
            chain_power,
            dof: data.dof.clone(),
            left_out: Vec::new(),
            data,
            rate_hz,
            band_limited,
            floor: 0.0,
            of_floor: Vec::new(),
            plan,
        })
    }

    /// Spectrum of the record that the bins was made for, bin by bin.
    pub fn first(&self) -> Data {
        self.data.clone()
    }

    /// Spectrum of a record with the same missing samples, bin by bin.
    pub fn measure(&self, values: &[f64]) -> Data {
        self.measure_parts([(0, values)])
    }

    /// Spectrum of parts with the same places, bin by bin.
    pub fn measure_parts<'a>(&self, parts: impl IntoIterator<Item = (usize, &'a [f64])>) -> Data {
        let cascade = filled(&self.plan, parts);
        let bins = estimate::bins(&cascade, self.rate_hz, &self.settings);
        let psd: Vec<f64> = bins.iter().map(|bin| bin.psd).collect();
        Data {
            dof: self.dof_beside_leaks(&psd),
            ..self.data.with_psd(psd)
        }
    }

    /// Counts a share of the samples as not measured: what fills them agrees with any law that they were drawn
    /// from, and says nothing of it.
    pub fn know_less(&mut self, share: f64) {
        for dof in self.dof.iter_mut().chain(&mut self.data.dof) {
            *dof *= 1.0 - share;
        }
    }

    /// Takes it that white noise of this two-sided density joins behind all filters, as the rounding of numbers does. Behind a
    /// converter's filter it has a component of its own, and without any filter it is a part of the white noise.
    pub fn know_floor(&mut self, density: f64) {
        self.floor = if self.band_limited { 0.0 } else { density };
        let densities = vec![self.floor; self.chain_power.len()];
        self.of_floor = self.estimate.operator.apply(&densities);
    }

    /// Density of the white noise that is [known](Self::know_floor) to join behind all filters; zero where there is none.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// Takes the bins within any of `bands`, hertz, out of what fits and tests look at, with those of whose power most leaks
    /// out of the bands.
    pub fn leave_out(&mut self, bands: &[Range<f64>]) {
        self.left_out = bands.to_vec();
        self.data.dof = self.dof_beside_leaks(&self.data.psd);
    }

    /// Degrees of freedom of the bins, those within any of `bands`, hertz, all but taken out.
    pub fn dof_beside(&self, bands: &[Range<f64>]) -> Vec<f64> {
        let dof_of = |(bin, dof): (usize, &f64)| {
            // With a bin on either side, for what the window lets through.
            let low = self.estimate.bins[bin.saturating_sub(1)].f_hz;
            let high = self.estimate.bins[(bin + 1).min(self.dof.len() - 1)].f_hz;
            let is_apart = bands.iter().any(|band| band.start < high && low < band.end);
            dof * if is_apart { NOTHING } else { 1.0 }
        };
        self.dof.iter().enumerate().map(dof_of).collect()
    }

    /// Degrees of freedom of the bins beside the bands that are left out, those all but taken out too of whose measured `psd`
    /// most leaks into them out of the bands: a strong tone shows, 45 dB below, in all bins that are measured at a lower rate.
    fn dof_beside_leaks(&self, psd: &[f64]) -> Vec<f64> {
        /// Share of what is measured in a bin up to which leaks are noise like any other: a choice.
        const MOST: f64 = 0.5;
        let mut dof = self.dof_beside(&self.left_out);
        // Other bins than these there are where samples were lost on the way.
        if self.left_out.is_empty() || psd.len() != dof.len() {
            return dof;
        }
        let bins = &self.estimate.bins;
        let density = |f_hz: &f64| {
            let bin = bins.partition_point(|bin| bin.f_hz < *f_hz);
            let is_inside = self.left_out.iter().any(|band| band.contains(f_hz));
            if is_inside {
                psd[bin.min(psd.len() - 1)]
            } else {
                0.0
            }
        };
        let densities: Vec<f64> = self.nodes.f_hz().iter().map(density).collect();
        let leaks = self.estimate.operator.apply(&densities);
        for ((dof, leak), psd) in dof.iter_mut().zip(leaks).zip(psd) {
            if leak > MOST * psd {
                *dof *= NOTHING;
            }
        }
        dof
    }

    /// Degrees of freedom of the bins, excluded ones included.
    pub fn dof(&self) -> &[f64] {
        &self.dof
    }

    /// Degrees of freedom of the bins, and their frequencies.
    pub fn all(&self) -> &[estimate::Bin] {
        &self.estimate.bins
    }

    /// Expectations for each of [`SEEN`] at coefficient 1, and behind a converter for white noise of
    /// density 1 that joins after its filter.
    pub fn units(&self) -> &[Vec<f64>] {
        &self.units
    }

    /// Two-sided density of the base components with these squares, chain included.
    pub fn base_density(&self, squared: &[f64], f_hz: f64) -> f64 {
        let terms: f64 = SEEN
            .iter()
            .zip(squared)
            .filter(|(_, squared)| **squared > 0.0)
            .map(|(&one, squared)| squared * self.design.unit_spectrum(one, f_hz))
            .sum();
        let behind = if self.band_limited {
            squared[SEEN.len()]
        } else {
            0.0
        };
        terms * self.design.power(f_hz) + behind
    }

    /// Two-sided density of number `unit` of [`Self::units`], through one more filter of the `power`
    /// at `f_hz` ahead of what joins behind the converter.
    pub fn unit_density(&self, unit: usize, f_hz: f64, power: f64) -> f64 {
        match SEEN.get(unit) {
            Some(&one) => self.design.unit_spectrum(one, f_hz) * self.design.power(f_hz) * power,
            None => 1.0,
        }
    }

    /// Two-sided density of a term ahead of the chain's power.
    pub fn term_density(&self, term: &dyn Term, f_hz: f64) -> f64 {
        if self.band_limited {
            term.spectrum_ahead(f_hz, self.rate_hz)
        } else {
            term.spectrum(f_hz, self.rate_hz)
        }
    }

    /// The same at all nodes, its peaks spread over those beside them.
    fn term_densities(&self, term: &dyn Term) -> Vec<f64> {
        let density = |f_hz| self.term_density(term, f_hz);
        let mut densities = if self.band_limited {
            let each = self.nodes.f_hz().iter();
            each.map(|&f_hz| density(f_hz)).collect()
        } else {
            term.spectra(&self.nodes)
        };
        for peak in term.peaks() {
            let operator = &self.estimate.operator;
            operator.resolve(&mut densities, &peak, density);
        }
        densities
    }

    /// Power of the signal chain at `f_hz`.
    pub fn chain_power(&self, f_hz: f64) -> f64 {
        self.design.power(f_hz)
    }

    /// Samples a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }
}

fn filled<'a>(plan: &Plan, parts: impl IntoIterator<Item = (usize, &'a [f64])>) -> Cascade {
    let mut cascade = Cascade::new(plan);
    for (first, values) in parts {
        cascade
            .push_values(first as u64, values)
            .expect("the parts are in order");
    }
    cascade
}
