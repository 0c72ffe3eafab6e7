//! The three statistics and the plain result that every estimator of this crate returns.

use crate::wide::Wide;

/// Which variance of the Allan family; the definitions are in the [crate documentation](crate).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Statistic {
    /// Allan variance: second differences of the integral.
    Allan,
    /// Modified Allan variance: second differences averaged over `m` neighbours before squaring,
    /// which tells white from differenced white noise by slope.
    Modified,
    /// Hadamard variance: third differences of the integral, blind to a linear ramp.
    Hadamard,
}

impl Statistic {
    /// Samples that one difference at averaging factor `m` spans at most: `2m` or `3m`.
    #[must_use]
    pub fn span(self, m: u64) -> u64 {
        match self {
            Self::Allan => 2 * m,
            Self::Modified | Self::Hadamard => 3 * m,
        }
    }

    /// The variance, in squared units of a code, from a sum of squared differences.
    ///
    /// Correct to 4 units in the last place: the integer sum is rounded once and divided by
    /// factors that are themselves rounded at most once each.
    pub(crate) fn variance<const LIMBS: usize>(
        self,
        m: u64,
        terms: u64,
        sum_of_squares: &Wide<LIMBS>,
    ) -> f64 {
        let m = m as f64;
        let mean = sum_of_squares.to_f64() / terms as f64;
        match self {
            Self::Allan => mean / (2.0 * m * m),
            Self::Modified => mean / (2.0 * (m * m) * (m * m)),
            Self::Hadamard => mean / (6.0 * m * m),
        }
    }
}

/// One variance at one averaging time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Averaging time in samples.
    pub m: u64,
    /// Variance in the square of the samples' unit (counts squared for integer codes).
    pub variance: f64,
    /// How many squared differences were averaged.
    pub terms: u64,
    /// Distance in samples from one difference to the next; 1 is full overlap, `m` none.
    pub stride: u64,
}

impl Estimate {
    /// The deviation, the square root of the variance, in the samples' unit.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        libm::sqrt(self.variance)
    }
}
