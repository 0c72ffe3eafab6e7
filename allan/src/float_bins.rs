//! Streaming bins over floating-point samples, by way of a fixed grid.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::block::Scratch;
use crate::fixed_point::{CODE_LIMIT, FixedPoint};
use crate::grid::BLOCK;
use crate::kernels::with_vectors;
use crate::{Bins, Estimate, NotAdjacent, Statistic};

/// A sample that has no code on the grid of the bins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffGrid {
    /// Absolute index of the sample.
    pub index: u64,
    /// The sample.
    pub sample: f64,
}

impl fmt::Display for OffGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "sample {} at index {} lies outside the fixed-point grid; \
             choose a grid that covers the whole record",
            self.sample, self.index
        )
    }
}

impl core::error::Error for OffGrid {}

/// Why two states of [`FloatBins`] do not merge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MergeError {
    /// They do not follow each other.
    NotAdjacent(NotAdjacent),
    /// Their samples were rounded to different grids.
    GridsDiffer,
}

impl fmt::Display for MergeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAdjacent(error) => error.fmt(f),
            Self::GridsDiffer => f.write_str("the parts were rounded to different grids"),
        }
    }
}

impl core::error::Error for MergeError {}

/// [`Bins`] for `f64` samples, each rounded once to a [`FixedPoint`] grid; what that costs in
/// accuracy stands [there](crate::fixed_point).
///
/// The grid is chosen beforehand, from the whole record where it is at hand or from its first
/// block with headroom. `LEVELS` is at most 28 (averaging times to 10^10 samples), checked at
/// compile time: codes are wider here than those of a converter.
///
/// ```
/// use inm_allan::{FloatBins, Statistic, fixed_point::FixedPoint};
/// let samples = [9.80665, 9.80667, f64::NAN, 9.80664, 9.80666];
/// let mut bins = FloatBins::<10>::new(FixedPoint::covering(samples, 16.0));
/// bins.push_slice(&samples).unwrap();
/// let allan = bins.points(Statistic::Allan).next().unwrap();
/// assert_eq!(allan.terms, 2); // none spans the NaN
/// assert!((allan.deviation() - 2e-5 / 2_f64.sqrt()).abs() < 1e-14);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FloatBins<const LEVELS: usize> {
    grid: FixedPoint,
    bins: Bins<LEVELS>,
}

impl<const LEVELS: usize> FloatBins<LEVELS> {
    /// Empty, the first sample having index 0.
    #[must_use]
    pub const fn new(grid: FixedPoint) -> Self {
        Self::starting_at(grid, 0)
    }

    /// Empty, the first sample having absolute index `first`.
    #[must_use]
    pub const fn starting_at(grid: FixedPoint, first: u64) -> Self {
        const {
            assert!(
                LEVELS <= 28,
                "an inner sum of 43-bit codes must fit 111 bits"
            );
        };
        Self {
            grid,
            bins: Bins::starting_at(first),
        }
    }

    /// Accepts a run of samples. One that is not finite is missing, as by [`FloatBins::skip`].
    ///
    /// # Errors
    ///
    /// [`OffGrid`] for the first finite sample outside the grid; those before it are accepted, it
    /// and those after it are not.
    pub fn push_slice(&mut self, samples: &[f64]) -> Result<(), OffGrid> {
        let mut scratch = Scratch::EMPTY;
        let mut codes = [0; BLOCK];
        for block in samples.chunks(BLOCK) {
            if self.round_all(block, &mut codes[..block.len()]) {
                self.bins.push_block(
                    &mut scratch,
                    codes[..block.len()].iter().copied(),
                    2 * CODE_LIMIT as u64,
                );
                continue;
            }
            let mut rest = block;
            while let Some(&sample) = rest.first() {
                let mut run = 0;
                for (slot, code) in codes
                    .iter_mut()
                    .zip(rest.iter().map_while(|&sample| self.grid.code(sample)))
                {
                    *slot = code;
                    run += 1;
                }
                if run == 0 {
                    if sample.is_finite() {
                        return Err(OffGrid {
                            index: self.bins.next_index(),
                            sample,
                        });
                    }
                    self.bins.skip(1);
                    run = 1;
                } else {
                    self.bins.push_block(
                        &mut scratch,
                        codes[..run].iter().copied(),
                        2 * CODE_LIMIT as u64,
                    );
                }
                rest = &rest[run..];
            }
        }
        Ok(())
    }

    /// Rounds samples to codes; false if one of them has none.
    fn round_all(&self, samples: &[f64], codes: &mut [i64]) -> bool {
        let grid = self.grid;
        with_vectors(
            #[inline(always)]
            || {
                let mut all_fit = true;
                for (code, &sample) in codes.iter_mut().zip(samples) {
                    let (rounded, fits) = grid.round(sample);
                    *code = rounded;
                    all_fit &= fits;
                }
                all_fit
            },
        )
    }

    /// Passes over `missing` samples: a gap. Zero is no gap.
    pub fn skip(&mut self, missing: u64) {
        self.bins.skip(missing);
    }

    /// Appends the bins of the part of the record that follows; see [`Bins::merge`].
    ///
    /// # Errors
    ///
    /// [`MergeError`], and nothing is changed, when the parts do not follow each other or do not
    /// share their grid.
    pub fn merge(&mut self, right: &Self) -> Result<(), MergeError> {
        if self.grid != right.grid {
            return Err(MergeError::GridsDiffer);
        }
        self.bins
            .merge(&right.bins)
            .map_err(MergeError::NotAdjacent)
    }

    /// The grid that samples are rounded to.
    #[must_use]
    pub fn grid(&self) -> FixedPoint {
        self.grid
    }

    /// Absolute index of the next sample.
    #[must_use]
    pub fn next_index(&self) -> u64 {
        self.bins.next_index()
    }

    /// Samples accepted, without the missing ones.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.bins.samples()
    }

    /// One statistic at every averaging time that has a difference, shortest first, in the square
    /// of the samples' unit.
    pub fn points(&self, statistic: Statistic) -> impl Iterator<Item = Estimate> + '_ {
        self.bins.points(statistic).map(|point| Estimate {
            variance: self.grid.scale_variance(point.variance),
            ..point
        })
    }
}
