//! The spectral density: measured, expected before and after, simulated.

use std::ops::Range;

use crate::bins::point;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws;
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::record::in_record::InRecord;
use crate::diagnosis::result::views::SpectrumPoint;
use crate::diagnosis::views::passing::Passing;
use crate::fit::likelihood::Fit;
use crate::numeric::mixture::add_mixture;
use crate::spectrum::pool;

/// Degrees of freedom of a point, at least: bins with less are taken together. The density is then
/// known to 50 %.
const LEAST_EDF: f64 = 8.0;

/// Standard deviations by which a density differs: of hundreds of points none does by chance.
const DIFFERS: f64 = 4.0;

impl SpectrumPoint {
    /// Whether the five terms alone are further off than chance explains.
    pub fn differs_before(&self) -> bool {
        (self.psd / self.before).ln().abs() > DIFFERS * (2.0 / self.edf).sqrt()
    }
}

/// The points of an axis, with the bins that they are made of.
pub(crate) struct Pooled<'a> {
    /// Points of the density, by ascending frequency.
    pub points: Vec<SpectrumPoint>,
    runs: Vec<(Range<usize>, f64)>,
    /// Degrees of freedom of the bins.
    edf: Vec<f64>,
    bins: Held<'a>,
}

/// Bins for the record as measured: those of the axis, unless parts of it are left out by now.
enum Held<'a> {
    Own(Box<SpectralBins>),
    Axis(&'a SpectralBins),
}

impl<'a> Held<'a> {
    /// For the record of an axis as it was `measured`, with its spectrum. Where the bins of the axis leave out what a converter
    /// makes of a jump, all of the record may have one bin more.
    fn of(axis: &'a AxisState, measured: &[f64]) -> (Self, Vec<f64>) {
        let own = || SpectralBins::new(measured, axis.rate_hz, axis.chain.as_ref());
        let shared = || axis.bins.measure(measured).psd;
        let fits = |psd: &Vec<f64>| psd.len() == axis.bins.all().len();
        let psd = (!axis.residual.is_masked()).then(shared).filter(fits);
        if let Some(psd) = psd {
            return (Self::Axis(&axis.bins), psd);
        }
        match own() {
            Some(mut bins) => {
                bins.know_floor(axis.bins.floor());
                let psd = bins.first().psd;
                (Self::Own(Box::new(bins)), psd)
            }
            None => (Self::Axis(&axis.bins), shared()),
        }
    }

    fn get(&self) -> &SpectralBins {
        match self {
            Self::Own(bins) => bins,
            Self::Axis(bins) => bins,
        }
    }
}

impl<'a> Pooled<'a> {
    /// Of an axis whose five terms alone were fitted as `before`, with what the model has of its `own`;
    /// the simulated densities are not yet among them.
    pub fn new(axis: &'a AxisState, before: &Fit, own: &InRecord, passing: &Passing) -> Self {
        let measured = axis.residual.whole();
        let (held, psd) = Held::of(axis, measured);
        let bins = held.get();
        let mut after = laws::expected(bins, &axis.laws, &axis.fit.squared);
        for (after, bin) in after.iter_mut().zip(bins.all()) {
            *after += passing.adds(bin.f_hz, *after);
        }
        let added = own.adds(|values| bins.measure(values).psd);
        for (sum, added) in after.iter_mut().zip(added) {
            *sum = (*sum + added).max(0.0);
        }
        let before = sum(bins.units(), &before.squared);
        let f_hz: Vec<f64> = bins.all().iter().map(|bin| bin.f_hz).collect();
        let edf: Vec<f64> = bins.all().iter().map(|bin| bin.edf).collect();
        let runs = pool::runs(edf.iter().copied(), LEAST_EDF);
        let points = runs
            .iter()
            .map(|(run, own)| {
                let psd = mean(&psd, &edf, run);
                let (lo, hi) = point::interval(psd, *own);
                SpectrumPoint {
                    f_hz: mean(&f_hz, &edf, run),
                    psd,
                    lo: lo * lo,
                    hi: hi * hi,
                    edf: *own,
                    before: mean(&before, &edf, run),
                    after: mean(&after, &edf, run),
                    simulated: None,
                }
            })
            .collect();
        Self {
            points,
            runs,
            edf,
            bins: held,
        }
    }

    /// Adds the densities of a simulated record.
    pub fn add_simulated(&mut self, simulated: &[f64]) {
        let psd = self.bins.get().measure(simulated).psd;
        if psd.len() != self.edf.len() {
            return;
        }
        for (point, (run, _)) in self.points.iter_mut().zip(&self.runs) {
            point.simulated = Some(mean(&psd, &self.edf, run));
        }
    }
}

/// Mean over a run of bins, weighed by their degrees of freedom.
fn mean(values: &[f64], edf: &[f64], run: &Range<usize>) -> f64 {
    let weight: f64 = edf[run.clone()].iter().sum();
    let sum: f64 = run.clone().map(|bin| values[bin] * edf[bin]).sum();
    sum / weight
}

/// Expectation of the bins for components with these squares.
fn sum(components: &[Vec<f64>], squared: &[f64]) -> Vec<f64> {
    let bins = components.first().map_or(0, Vec::len);
    let mut total = vec![0.0; bins];
    add_mixture(&mut total, components, squared);
    total
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::diagnosis::explanation::Change;
    use crate::diagnosis::trial::{jump, numbers, take_in};
    use crate::diagnosis::views::in_record;
    use crate::model::steps;

    #[test]
    fn all_of_a_record_has_its_own_bins_where_a_jump_is_left_out() {
        const RATE_HZ: f64 = 250.0;
        let chain = "ads1281:linear+400hz".parse().expect("a chain");
        let differs = |length: &usize| {
            let mut noise = numbers(1, 0);
            let values: Vec<f64> = (0..*length).map(|_| noise.draw()).collect();
            let axis = AxisState::new(Arc::new(values), RATE_HZ, Some(&chain));
            let mut axis = axis.expect("a spectrum");
            let before = axis.fit.clone();
            let change = Change::Waves(vec![jump(length / 3, 1.0)]);
            take_in(&mut axis, steps::KIND, change);
            let passing = Passing::new(&axis, &[]);
            let view = Pooled::new(&axis, &before, &in_record(&axis), &passing);
            assert!(view.points.iter().all(|one| one.psd > 0.0), "{length}");
            view.edf.len() != axis.bins.all().len()
        };
        let lengths: Vec<usize> = (8192..12_000).step_by(27).collect();
        assert!(lengths.iter().any(differs), "seed 1: the same everywhere");
    }
}
