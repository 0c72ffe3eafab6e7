//! A record as a slice, its Allan deviation at octaves with 95 % intervals: all in one call.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::identify::identify;
use crate::{Estimate, Statistic, edf, full};

/// Probability that an interval leaves out on each side.
const TAIL: f64 = 0.025;

/// Octaves that a slice can have: its length fits 64 bits.
const MOST: usize = 64;

/// The deviation at one averaging time, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Octave {
    /// Averaging time in samples: a power of two.
    pub m: u64,
    /// Overlapping Allan deviation, in the samples' unit.
    pub deviation: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval; infinite where nothing bounds it.
    pub hi: f64,
    /// Equivalent degrees of freedom for the noise that the slope of the curve shows.
    pub edf: f64,
}

/// The overlapping Allan deviation of `samples` at m = 1, 2, 4, ... samples, as far as one difference
/// fits, with 95 % intervals.
///
/// The interval is that of a chi-squared variable with the equivalent degrees of freedom of the
/// noise that the local slope of the curve shows (C. A. Greenhall and W. J. Riley, PTTI 2003). Samples that are
/// not finite are gaps. Takes O(samples) an octave and no memory.
///
/// ```
/// // 1000 numbers that are as good as white noise: their deviation falls as the root of m.
/// let mut state = 1_u64;
/// let samples = core::array::from_fn::<f64, 1000, _>(|_| {
///     state = state * 16_807 % 2_147_483_647;
///     state as f64 / 2_147_483_647.0
/// });
/// let octaves: Vec<_> = inm_allan::octaves(&samples).collect();
/// assert_eq!(octaves.len(), 9); // 1 to 256 samples
/// for octave in octaves {
///     let expected = (1.0 / 12.0 / octave.m as f64).sqrt();
///     assert!(octave.lo < expected && expected < octave.hi);
/// }
/// ```
pub fn octaves(samples: &[f64]) -> impl Iterator<Item = Octave> {
    let mut estimates = [None::<Estimate>; MOST];
    let mut len = 0;
    for (power, place) in estimates.iter_mut().enumerate() {
        *place = full::floats(Statistic::Allan, &[samples], 1 << power);
        if place.is_none() {
            break;
        }
        len += 1;
    }
    let empty = Estimate {
        m: 0,
        variance: 0.0,
        terms: 0,
        stride: 1,
    };
    let estimates = estimates.map(|one| one.unwrap_or(empty));
    (0..len).map(move |at| {
        let Estimate {
            m,
            variance,
            terms,
            stride,
        } = estimates[at];
        let mixture = identify(Statistic::Allan, &estimates[..len], at);
        let edf = mixture.edf(|noise| edf::edf(Statistic::Allan, noise, m, stride, terms));
        let (lo, hi) = interval(variance, edf);
        Octave {
            m,
            deviation: libm::sqrt(variance),
            lo,
            hi,
            edf,
        }
    })
}

/// 95 % interval of the deviation whose square was estimated with `edf` degrees of freedom, from 0 to
/// infinity where `edf` is no positive number.
#[must_use]
pub fn interval(variance: f64, edf: f64) -> (f64, f64) {
    let Ok(chi) = ChiSquared::new(edf) else {
        return (0.0, f64::INFINITY);
    };
    let end = |probability: f64| libm::sqrt(variance * edf / chi.inverse_cdf(probability));
    (end(1.0 - TAIL), end(TAIL))
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    #[test]
    fn interval_of_known_degrees_of_freedom() {
        // Chi-squared with 10 degrees of freedom: 3.24697 and 20.48318.
        let (lo, hi) = interval(4.0, 10.0);
        assert!((lo - libm::sqrt(40.0 / 20.483_177)).abs() < 1e-5, "{lo}");
        assert!((hi - libm::sqrt(40.0 / 3.246_973)).abs() < 1e-5, "{hi}");
    }

    #[test]
    fn a_slice_without_a_difference_has_no_octave() {
        assert_eq!(octaves(&[]).count(), 0);
        assert_eq!(octaves(&[1.0]).count(), 0);
        assert_eq!(octaves(&[1.0, f64::NAN, 2.0]).count(), 0);
        let two: Vec<_> = octaves(&[1.0, 3.0]).collect();
        assert_eq!(two.len(), 1);
        // One difference of 2: its square over 2 is the variance.
        assert!((two[0].deviation - libm::sqrt(2.0)).abs() < 1e-9);
        assert!(two[0].lo > 0.0 && two[0].hi > 10.0 * two[0].deviation);
    }

    #[test]
    fn every_octave_that_fits_is_there() {
        let samples: Vec<f64> = (0..1023).map(|i| f64::from(i % 7)).collect();
        let factors: Vec<u64> = octaves(&samples).map(|octave| octave.m).collect();
        assert_eq!(factors, [1, 2, 4, 8, 16, 32, 64, 128, 256]);
        let samples = [&samples[..], &[0.0]].concat();
        assert_eq!(octaves(&samples).last().map(|octave| octave.m), Some(512));
    }
}
