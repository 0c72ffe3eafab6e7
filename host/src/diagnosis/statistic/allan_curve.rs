//! The Allan curve of samples in memory, by the board's integer estimator: a quarter of the price of the
//! one that has all statistics at once, on a grid as fine (10.8 million samples, 0.10 s against 0.39 s).

use inm_allan::fixed_point::FixedPoint;
use inm_allan::{AllanBins, Statistic};

use crate::bins::point::{self, Point};

/// Octaves of averaging times: up to 10^9 samples.
const LEVELS: usize = 25;

/// How much further than the record a [`FixedPoint`] reaches, for codes of 31 binary digits: steps of
/// some billionth of the record's range.
const HEADROOM: f64 = 2048.0;

/// Samples that are rounded at a time: 32 KiB of them.
const BLOCK: usize = 4096;

/// Points of the curve of `values`, in their unit; those that are not finite are missing. A deviation is off
/// by a step of the grid at most ([`inm_allan::fixed_point`]).
pub fn allan(values: &[f64], rate_hz: f64) -> Vec<Point> {
    of_parts([(0, values)], rate_hz)
}

/// The same of parts of a record, each with its first index, ascending.
pub fn of_parts<'a>(
    parts: impl IntoIterator<Item = (usize, &'a [f64]), IntoIter: Clone>,
    rate_hz: f64,
) -> Vec<Point> {
    let parts = parts.into_iter();
    let all = parts.clone().flat_map(|(_, values)| values.iter().copied());
    let grid = FixedPoint::covering(all, HEADROOM);
    let mut bins = AllanBins::<LEVELS>::new();
    let mut codes = Vec::with_capacity(BLOCK);
    for (first, values) in parts {
        bins.skip(first as u64 - bins.next_index());
        for block in values.chunks(BLOCK) {
            let there = |a: &f64, b: &f64| a.is_finite() == b.is_finite();
            for run in block.chunk_by(there) {
                if !run[0].is_finite() {
                    bins.skip(run.len() as u64);
                    continue;
                }
                codes.clear();
                // All of them have a code, of 31 digits at most: the grid covers them.
                codes.extend(run.iter().map(|&one| grid.code(one).unwrap_or(0) as i32));
                bins.push_slice(&codes);
            }
        }
    }
    let estimates: Vec<_> = bins.points().collect();
    point::points(Statistic::Allan, &estimates, rate_hz, grid.resolution())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bins::strided::Strided;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    #[test]
    fn the_curve_is_that_of_the_finer_grid() {
        let mut noise = Gaussian::new(Seed { seed: 1, stream: 0 }, 1.0);
        let mut values: Vec<f64> = (0..50_000).map(|_| 9.8 + noise.draw()).collect();
        // A loud sample takes digits from all others.
        values[777] += 1e4;
        let mut bins = Strided::default();
        bins.push_floats(&values[..2000]);
        bins.skip(7);
        bins.push_floats(&values[2007..20_000]);
        bins.skip(10_000);
        bins.push_floats(&values[30_000..]);
        let estimates = bins.estimates(Statistic::Allan);
        let expected = point::points(Statistic::Allan, &estimates, 10.0, 1.0);
        values[2000..2007].fill(f64::NAN);
        let parts = [(0, &values[..20_000]), (30_000, &values[30_000..])];
        let found = of_parts(parts, 10.0);
        assert_eq!(found.len(), expected.len());
        for (one, other) in found.iter().zip(&expected) {
            assert_eq!((one.m, one.terms), (other.m, other.terms));
            // The step of a record that is 2^14 wide, 2^-16, is the most a deviation can be off by.
            let off = (one.deviation() - other.deviation()).abs();
            assert!(off < 2_f64.powi(-16), "{}: {off:e}, seed 1", one.m);
        }
    }
}
