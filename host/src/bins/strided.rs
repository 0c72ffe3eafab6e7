//! Streaming bins of one axis, over codes or floating-point samples.
//!
//! Floating-point samples are rounded to a grid that the first block fixes. Should a later sample
//! lie outside of it, a second set of bins with a wider grid goes on from there: the
//! differences across that place are lost, nothing else, and the estimates are pooled.

use inm_allan::fixed_point::FixedPoint;
use inm_allan::{Estimate, FloatBins, HostBins, Statistic};

/// How much further than the first block the grid reaches. Leaves 2^-32 of the first block's
/// range as the step, far below any noise in it.
const HEADROOM: f64 = 4096.0;

/// Octaves of averaging times of the floating-point bins: up to 10^9 samples.
const FLOAT_LEVELS: usize = 25;

/// Bins of one axis.
#[derive(Debug, Clone, Default)]
pub struct Strided {
    parts: Vec<Part>,
}

/// Bins over a part of the record.
#[derive(Debug, Clone)]
enum Part {
    Codes(Box<HostBins>),
    Floats(Box<FloatBins<FLOAT_LEVELS>>),
}

impl Strided {
    /// Passes over missing samples.
    pub fn skip(&mut self, missing: u64) {
        match self.parts.last_mut() {
            Some(Part::Codes(bins)) => bins.skip(missing),
            Some(Part::Floats(bins)) => bins.skip(missing),
            None => {}
        }
    }

    /// Adds integer samples.
    pub fn push_codes(&mut self, run: &[i32]) {
        match self.parts.last_mut() {
            Some(Part::Codes(bins)) => bins.push_slice(run),
            Some(Part::Floats(_)) => {
                self.push_floats(&run.iter().copied().map(f64::from).collect::<Vec<_>>());
            }
            None => {
                let mut bins = HostBins::new();
                bins.push_slice(run);
                self.parts.push(Part::Codes(Box::new(bins)));
            }
        }
    }

    /// Adds floating-point samples, all of them finite.
    pub fn push_floats(&mut self, run: &[f64]) {
        let mut left = run;
        // Each further grid covers all that is left, so this ends after one.
        while !left.is_empty() {
            if let Some(Part::Floats(bins)) = self.parts.last_mut() {
                let before = bins.next_index();
                match bins.push_slice(left) {
                    Ok(()) => return,
                    Err(off_grid) => left = &left[(off_grid.index - before) as usize..],
                }
            }
            let grid = FixedPoint::covering(left.iter().copied(), HEADROOM);
            self.parts
                .push(Part::Floats(Box::new(FloatBins::new(grid))));
        }
    }

    /// One statistic at every averaging time that has a difference, ascending, in squared counts.
    pub fn estimates(&self, statistic: Statistic) -> Vec<Estimate> {
        let mut pooled: Vec<Estimate> = Vec::new();
        for part in &self.parts {
            let points: Vec<Estimate> = match part {
                Part::Codes(bins) => bins.points(statistic).collect(),
                Part::Floats(bins) => bins.points(statistic).collect(),
            };
            for point in points {
                match pooled.binary_search_by_key(&point.m, |one| one.m) {
                    Ok(at) => {
                        let one = &mut pooled[at];
                        let terms = one.terms + point.terms;
                        one.variance = (one.variance * one.terms as f64
                            + point.variance * point.terms as f64)
                            / terms as f64;
                        one.terms = terms;
                    }
                    Err(at) => pooled.insert(at, point),
                }
            }
        }
        pooled
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_off_the_grid_costs_one_break() {
        let mut bins = Strided::default();
        bins.push_floats(&[0.0, 0.0, 0.0]);
        bins.push_floats(&[0.0, 1e6, 1e6, 3e6, 2e6]);
        let one = bins.estimates(Statistic::Allan)[0];
        // Three differences of zero, then 0, 2e6 and -1e6; none into the new grid.
        assert_eq!(one.terms, 6);
        assert!(
            (one.variance / (5e12 / 12.0) - 1.0).abs() < 1e-9,
            "{}",
            one.variance
        );
    }
}
