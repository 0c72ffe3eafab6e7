//! The transform of the whole record at the points of a grid.

use std::ops::Range;

use rustfft::num_complex::Complex64;

use super::replay::Replay;
use super::survey::Survey;
use crate::fft::phasor::Phasor;
use crate::spectrum::fold::Folded;

/// Points of one short transform, at most.
const POINTS: usize = 1 << 18;

/// Residues that one replay serves: each needs an accumulator of [`POINTS`], and two replays run next to
/// one another.
const RESIDUES: usize = 8;

/// Grid points for each `1 / T`, at least.
const PADDING: f64 = 1.5;

/// A grid of frequencies: this many short transforms of so many points.
#[derive(Clone, Copy)]
struct Grid {
    points: usize,
    folds: usize,
}

impl Survey {
    /// Local peaks of the grid above `ratio`: frequency in cycles per sample and ratio.
    pub(super) fn grid<R: Replay + ?Sized>(
        &self,
        record: &R,
        ratio: f64,
    ) -> Result<Vec<(f64, f64)>, R::Error> {
        let wanted = (PADDING * self.len as f64) as usize;
        let points = POINTS.min(wanted.next_power_of_two());
        let folds = wanted.div_ceil(points);
        let total = (points * folds) as f64;
        let grid = Grid { points, folds };
        // Two at a time, whatever the number of processors: each needs its accumulators.
        let (low, high) = (0..folds / 4 + 1, folds / 4 + 1..folds / 2 + 1);
        let part = |residues| self.residues(record, grid, residues, ratio);
        let (low, high) = rayon::join(|| part(low), || part(high));
        let mut high = [low?, high?].concat();
        high.sort_by_key(|point| point.0);
        high.dedup_by_key(|point| point.0);
        let peak = |index: usize| {
            let (k, seen) = high[index];
            let beaten = |other: Option<&(usize, f64)>| {
                other.is_some_and(|&(l, value)| k.abs_diff(l) <= 2 && value > seen)
            };
            !beaten(index.checked_sub(1).and_then(|before| high.get(before)))
                && !beaten(high.get(index + 1))
        };
        Ok((0..high.len())
            .filter(|&index| peak(index))
            .map(|index| (high[index].0 as f64 / total, high[index].1))
            .collect())
    }

    /// Points of the grid above `ratio` whose numbers leave one of the `residues` over its folds.
    fn residues<R: Replay + ?Sized>(
        &self,
        record: &R,
        grid: Grid,
        residues: Range<usize>,
        ratio: f64,
    ) -> Result<Vec<(usize, f64)>, R::Error> {
        let Grid { points, folds } = grid;
        let total = (points * folds) as f64;
        let fft = crate::fft::forward(points);
        let mut scratch = vec![Complex64::default(); fft.get_inplace_scratch_len()];
        let mut folded = Folded::new(points, folds, RESIDUES.min(residues.len()));
        let mut high = Vec::new();
        let lowest = self.lowest_hz() / self.rate_hz;
        let Range { start, end } = residues;
        for first in (start..end).step_by(RESIDUES) {
            folded.begin(first);
            self.tapered(record, |at, values| folded.push(at, values))?;
            for (sums, r) in folded.residues().zip(first..end) {
                let phasor = Phasor::new(-(r as f64) / total);
                phasor.zip(0, sums.iter_mut(), 1.0.into(), |z, turn| *z *= turn);
                fft.process_with_scratch(sums, &mut scratch);
                for (q, z) in sums.iter().enumerate() {
                    let k = folds * q + r;
                    let mirrored = k.min(points * folds - k);
                    let cycles = mirrored as f64 / total;
                    if cycles < lowest {
                        continue;
                    }
                    let seen = self.ratio(z.norm_sqr(), cycles * self.rate_hz);
                    if seen > ratio {
                        high.push((mirrored, seen));
                    }
                }
            }
        }
        Ok(high)
    }
}
