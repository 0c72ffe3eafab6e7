//! What is fitted: the bins of a spectrum, with the weight that each may claim.
//!
//! The likelihood is written as if bins were independent, each with `dof` degrees of freedom. For
//! correlated bins the right number is not that of the bin alone: with `C` the covariance relative
//! to the expectations, `dof = 2 C^-1 1` is the weighting that estimates a common factor best, and
//! its sum is twice the information that the bins hold on one, `1' C^-1 1`. So the likelihood is
//! efficient and calibrated for every model that is smooth over neighbouring bins.

use nalgebra::{DMatrix, DVector};

use crate::spectrum::Estimate;

/// Least share of its own degrees of freedom that a bin keeps, whatever its neighbours say.
const LEAST_SHARE: f64 = 0.05;

/// Bins to fit, by ascending frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Data {
    /// Mean frequency, hertz.
    pub f_hz: Vec<f64>,
    /// Two-sided density, squared units of the signal per hertz; not negative.
    pub psd: Vec<f64>,
    /// Degrees of freedom that each may claim, its neighbours being counted as well.
    pub dof: Vec<f64>,
    /// Covariance relative to the product of the expectations.
    pub covariance: DMatrix<f64>,
    /// Geometric mean of the densities: their unit in logarithms.
    pub unit: f64,
}

impl Data {
    /// The bins of `estimate`, whose samples are in counts of `units_per_count`.
    ///
    /// `None` where there are no bins, or nothing but zeros in them.
    pub fn new(estimate: &Estimate, units_per_count: f64) -> Option<Self> {
        let squared = units_per_count * units_per_count;
        let size = estimate.bins.len();
        Self::from_parts(
            estimate.bins.iter().map(|bin| bin.f_hz).collect(),
            estimate.bins.iter().map(|bin| bin.psd * squared).collect(),
            DMatrix::from_fn(size, size, |one, other| estimate.covariance.at(one, other)),
        )
    }

    /// Densities `psd` at `f_hz` with the relative `covariance`.
    ///
    /// `None` where there are none, a number is not finite, or all densities are zero.
    pub fn from_parts(f_hz: Vec<f64>, psd: Vec<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        let positive: Vec<f64> = psd.iter().copied().filter(|&psd| psd > 0.0).collect();
        let sound = psd.iter().all(|psd| psd.is_finite() && *psd >= 0.0)
            && covariance.diagonal().iter().all(|one| *one > 0.0);
        if positive.is_empty() || !sound {
            return None;
        }
        let mean_log = positive.iter().map(|psd| psd.ln()).sum::<f64>() / positive.len() as f64;
        Some(Self {
            dof: claims(&covariance),
            f_hz,
            psd,
            covariance,
            unit: mean_log.exp(),
        })
    }

    /// Bins that are independent of one another, with their densities and degrees of freedom. There is one at least, and
    /// one of the densities is above zero.
    pub fn independent(f_hz: Vec<f64>, psd: Vec<f64>, dof: &[f64]) -> Option<Self> {
        let variances = DVector::from_iterator(dof.len(), dof.iter().map(|dof| 2.0 / dof));
        Self::from_parts(f_hz, psd, DMatrix::from_diagonal(&variances))
    }

    /// Number of bins.
    pub fn len(&self) -> usize {
        self.psd.len()
    }

    /// Whether there are none; never so for a value that was constructed.
    pub fn is_empty(&self) -> bool {
        self.psd.is_empty()
    }

    /// One more bin, of `dof` degrees of freedom and independent of all others, at the end.
    #[must_use]
    pub fn with_bin(&self, psd: f64, dof: f64) -> Self {
        let mut data = self.clone();
        let size = self.len();
        data.f_hz.push(0.0);
        data.psd.push(psd);
        data.dof.push(dof);
        data.covariance = self.covariance.clone().resize(size + 1, size + 1, 0.0);
        data.covariance[(size, size)] = 2.0 / dof;
        data
    }

    /// The bins with the numbers `kept`, each allowed an error of the model of its own, a fraction
    /// `allowance` of it.
    #[must_use]
    pub fn select(&self, kept: &[usize], allowance: f64) -> Self {
        if kept.len() == self.len() && allowance == 0.0 {
            return self.clone();
        }
        let mut covariance = self.covariance.select_rows(kept).select_columns(kept);
        for i in 0..kept.len() {
            covariance[(i, i)] += allowance * allowance;
        }
        let of = |all: &[f64]| kept.iter().map(|&b| all[b]).collect();
        Self {
            f_hz: of(&self.f_hz),
            psd: of(&self.psd),
            dof: claims(&covariance),
            covariance,
            unit: self.unit,
        }
    }

    /// The same bins with other densities: another draw.
    #[must_use]
    pub fn with_psd(&self, psd: Vec<f64>) -> Self {
        Self {
            psd,
            ..self.clone()
        }
    }
}

/// `2 C^-1 1`, within bounds.
fn claims(covariance: &DMatrix<f64>) -> Vec<f64> {
    // Scaled to correlations: variances span many orders of magnitude.
    let scale = covariance.diagonal().map(f64::sqrt);
    let correlation = DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
        covariance[(i, j)] / (scale[i] * scale[j])
    });
    let ones = DVector::from_fn(scale.len(), |i, _| 1.0 / scale[i]);
    let joint = correlation
        .cholesky()
        .map(|factor| factor.solve(&ones).component_div(&scale));
    (0..scale.len())
        .map(|i| {
            let alone = 2.0 / (scale[i] * scale[i]);
            joint.as_ref().map_or(alone, |joint| {
                (2.0 * joint[i]).clamp(LEAST_SHARE * alone, alone)
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twins_share_what_they_know() {
        // Two bins that are nearly the same, and one of its own.
        let mut covariance = DMatrix::from_diagonal_element(3, 3, 0.1);
        covariance[(0, 1)] = 0.0999;
        covariance[(1, 0)] = 0.0999;
        let data = Data::from_parts(vec![1.0, 2.0, 3.0], vec![1.0; 3], covariance).unwrap();
        assert!((data.dof[2] - 20.0).abs() < 1e-9);
        assert!((data.dof[0] + data.dof[1] - 20.0).abs() < 0.02);
    }

    #[test]
    fn nothing_to_fit() {
        let one = DMatrix::from_element(1, 1, 1.0);
        assert!(Data::from_parts(vec![], vec![], DMatrix::zeros(0, 0)).is_none());
        assert!(Data::from_parts(vec![1.0], vec![0.0], one.clone()).is_none());
        assert!(Data::from_parts(vec![1.0], vec![f64::NAN], one).is_none());
    }
}
