//! One axis on its way: its explanations, and what follows from them: residual, spectrum, laws, and what
//! whitens the record.

mod density;
pub mod depth;
mod excluded;
mod explain;
mod fill;
mod filling;
mod made;
mod moments;
pub mod profile;
pub mod ramp;
mod whitening;
mod withdraw;

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use self::made::Made;
use crate::chain::Chain;
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::laws::{self, Law, search};
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::record::powers::Powers;
use crate::diagnosis::record::residual::Residual;
use crate::diagnosis::record::short_gaps::ShortGaps;
use crate::diagnosis::statistic::matched_filter::{Transform, Transformer};
use crate::fit::likelihood::{Data, Fit};
use crate::spectrum::Line;

pub use excluded::Excluded;
pub use explain::SPREAD;
pub use made::SHUT_OUT;

/// No mix of the five terms and the laws fits a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoFit;

/// One axis with what is known about it so far.
#[derive(Clone)]
pub struct AxisState {
    /// Samples a second.
    pub rate_hz: f64,
    /// Declared signal chain.
    pub chain: Option<Chain>,
    /// What its model holds beyond the five terms, in the order in which it was found.
    explanations: Vec<Explanation>,
    /// Bands that are excluded.
    excluded: Vec<Excluded>,
    /// Gaps of the record that are filled, where there are any.
    short_gaps: Option<Arc<ShortGaps>>,
    /// What is left of the record.
    pub residual: Residual,
    /// Bins and expectations.
    pub bins: SpectralBins,
    /// The laws among the explanations.
    pub laws: Vec<Law>,
    /// Spectrum of the residual.
    pub data: Data,
    /// Fit of the five terms and the laws.
    pub fit: Fit,
    /// The residual, bridged.
    pub filled: Arc<Vec<f64>>,
    /// What is missing of the residual and was filled, ascending.
    bridged: Vec<Range<usize>>,
    /// Bands of the tones that were known when that was filled, hertz.
    filled_with_hz: Vec<Range<f64>>,
    /// Ranges excluded from tests of single moments, ascending and disjoint.
    unusable: Vec<Range<usize>>,
    /// What the bins are made for: ranges that are excluded from the record.
    left_out: Vec<Range<usize>>,
    fast: Arc<Transformer>,
    seen: Made<Arc<Whitened>>,
    powers: OnceLock<Arc<Powers>>,
    starts: OnceLock<Option<Arc<search::Starts>>>,
    lines: OnceLock<Vec<Line>>,
}

/// The residual's transform, closed into a ring, and the densities that whiten it.
pub struct Whitened {
    /// Transform of the residual.
    pub transform: Transform,
    /// Density at every ordinate.
    pub density: Vec<f64>,
    /// Ordinates below what the converter's filter shuts out.
    pub top: usize,
}

impl AxisState {
    /// An axis with nothing known. `None` where the record is too short, or all the same.
    pub fn new(measured: Arc<Vec<f64>>, rate_hz: f64, chain: Option<&Chain>) -> Option<Self> {
        let short_gaps = ShortGaps::of(&measured, &[]);
        let mut whole = Arc::clone(&measured);
        if let Some(gaps) = &short_gaps {
            gaps.bridge(Arc::make_mut(&mut whole).as_mut_slice());
        }
        let mut bins = SpectralBins::new(&whole, rate_hz, chain)?;
        bins.know_less(short_gaps.as_ref().map_or(0.0, ShortGaps::share));
        let fast = Transformer::new(measured.len());
        let data = bins.first();
        let fit = laws::fit(&bins, &data, &[])?;
        let mut state = Self {
            rate_hz,
            chain: chain.cloned(),
            explanations: Vec::new(),
            excluded: Vec::new(),
            short_gaps: short_gaps.map(Arc::new),
            residual: Residual::new(measured, Arc::clone(&whole)),
            bins,
            laws: Vec::new(),
            data,
            fit,
            filled: Arc::default(),
            bridged: Vec::new(),
            filled_with_hz: Vec::new(),
            unusable: Vec::new(),
            left_out: Vec::new(),
            fast: Arc::new(fast),
            seen: Made::default(),
            powers: OnceLock::new(),
            starts: OnceLock::new(),
            lines: OnceLock::new(),
        };
        state.settle(whole);
        state.fill(fill::AT_FIRST).ok()?;
        Some(state)
    }

    /// Its spectrum with the laws that were fitted to it.
    pub fn fitted(&self) -> search::Fitted<'_> {
        search::Fitted {
            bins: &self.bins,
            data: &self.data,
            laws: &self.laws,
            fit: &self.fit,
        }
    }

    /// What is left of the record, all else given up.
    pub fn into_residual(self) -> Residual {
        self.residual
    }

    /// Whether a converter's filter stands before the samples.
    pub fn is_filtered(&self) -> bool {
        let chain = self.chain.as_ref();
        chain.is_some_and(|chain| chain.converter.is_some())
    }
}

#[cfg(test)]
mod tests;
