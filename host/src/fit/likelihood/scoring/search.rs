//! The search itself: from where it starts, step by step, to the top.

use std::ops::Range as Bins;

use nalgebra::{DMatrix, DVector};

use super::{Range, log_likelihood};
use crate::fit::likelihood::data::Data;
use crate::fit::likelihood::non_negative;
use crate::numeric::mixture::add_mixture;
use crate::numeric::product::dot;

/// Most steps; a dozen are usual.
const STEPS: usize = 200;

/// Most halvings of a step.
const HALVINGS: usize = 40;

/// Gain in log-likelihood below which the search has arrived.
const ARRIVED: f64 = 1e-10;

/// Components that a search starts from by themselves, at most: as many as the noise of a sensor has. Of many bands, which would
/// make it slow, none alone is the whole spectrum.
const ALONE: usize = 4;

/// Bins on either side that the first guess of a bin's expectation averages.
const NEIGHBOURS: usize = 4;

pub(super) struct Search<'a> {
    pub(super) data: &'a Data,
    pub(super) fixed: &'a [f64],
    /// Each component over what it may reach at most, so that unknowns are of order one.
    pub(super) components: Vec<Vec<f64>>,
    /// Bins outside of which each component is zero: a band of many is, nearly everywhere.
    reaches: Vec<Bins<usize>>,
    pub(super) scale: Vec<f64>,
    pub(super) range: Range,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        data: &'a Data,
        components: &[Vec<f64>],
        fixed: &'a [f64],
        range: Range,
    ) -> Self {
        let level = smooth(data);
        let scale: Vec<f64> = components
            .iter()
            .map(|component| {
                let reach = component.iter().zip(&level);
                let most = reach.map(|(one, y)| one / y).fold(0.0, f64::max);
                if most > 0.0 { most } else { 1.0 }
            })
            .collect();
        let components: Vec<Vec<f64>> = components
            .iter()
            .zip(&scale)
            .map(|(component, scale)| component.iter().map(|one| one / scale).collect())
            .collect();
        Self {
            reaches: components.iter().map(|one| reach(one)).collect(),
            data,
            fixed,
            components,
            scale,
            range,
        }
    }

    /// The best scaled squares and their log-likelihood.
    pub(super) fn best(&self, start: Option<&[f64]>) -> Option<(DVector<f64>, f64)> {
        if let Some(start) = start {
            return self.run(self.scaled(start));
        }
        // The likelihood is not concave, least of all where lines stand in a spectrum: starts far apart, the best end.
        let nothing = DVector::zeros(self.components.len());
        let guess = self.step(&smooth(self.data), &nothing);
        let even = DVector::from_element(self.components.len(), 1.0);
        [guess, even]
            .into_iter()
            .chain(self.likeliest_alone())
            .filter_map(|start| self.run(start))
            .max_by(|one, other| one.1.total_cmp(&other.1))
    }

    /// The components that are likeliest by themselves, each as large as suits all bins, of those that reach every bin.
    fn likeliest_alone(&self) -> impl Iterator<Item = DVector<f64>> {
        let alone = |which: usize| {
            let component = &self.components[which];
            let ratios = self.data.psd.iter().zip(component);
            let ratios = ratios.zip(&self.data.dof);
            let ratios = ratios.map(|((psd, e), dof)| dof * psd / e);
            let size = ratios.sum::<f64>() / self.data.dof.iter().sum::<f64>();
            let x = DVector::from_fn(
                self.components.len(),
                |i, _| {
                    if i == which { size } else { 0.0 }
                },
            );
            let value = log_likelihood(self.data, &self.expected(&x));
            value.is_finite().then_some((x, value))
        };
        let mut all: Vec<_> = (0..self.components.len()).filter_map(alone).collect();
        all.sort_by(|one, other| other.1.total_cmp(&one.1));
        all.into_iter().take(ALONE).map(|(x, _)| x)
    }

    fn scaled(&self, squared: &[f64]) -> DVector<f64> {
        DVector::from_fn(self.scale.len(), |i, _| squared[i] * self.scale[i])
    }

    pub(super) fn expected(&self, x: &DVector<f64>) -> Vec<f64> {
        let mut expected = self.fixed.to_vec();
        add_mixture(&mut expected, &self.components, x.as_slice());
        expected
    }

    /// Weighted least squares with the weights of `expected`, looked for from the squares `near`.
    fn step(&self, expected: &[f64], near: &DVector<f64>) -> DVector<f64> {
        let size = self.components.len();
        let (mut gram, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let weights = &self.data.dof;
        // Relative to the expectation, so that nothing over- or underflows.
        let over = |values: &[f64], from: usize| -> Vec<f64> {
            let pairs = values.iter().zip(&expected[from..]);
            pairs.map(|(one, e)| one / e).collect()
        };
        let relative: Vec<Vec<f64>> = self
            .components
            .iter()
            .zip(&self.reaches)
            .map(|(component, reach)| over(&component[reach.clone()], reach.start))
            .collect();
        let rest: Vec<f64> = (0..expected.len())
            .map(|b| weights[b] * (self.data.psd[b] - self.fixed[b]) / expected[b])
            .collect();
        for (i, own) in relative.iter().enumerate() {
            let from = &self.reaches[i];
            let weighted: Vec<f64> = own
                .iter()
                .zip(&weights[from.clone()])
                .map(|(one, weight)| one * weight)
                .collect();
            for (j, other) in relative.iter().enumerate().skip(i) {
                let to = &self.reaches[j];
                let (start, end) = (from.start.max(to.start), from.end.min(to.end));
                if start < end {
                    let both = dot(
                        &weighted[start - from.start..end - from.start],
                        &other[start - to.start..end - to.start],
                    );
                    gram[(i, j)] = both;
                    gram[(j, i)] = both;
                }
            }
            right[i] = dot(own, &rest[from.clone()]);
        }
        match self.range {
            Range::NonNegative => non_negative::solve_from(&gram, &right, near),
            Range::Any => non_negative::solve_any(&gram, &right),
        }
    }

    fn run(&self, start: DVector<f64>) -> Option<(DVector<f64>, f64)> {
        let mut x = start;
        let mut expected = self.expected(&x);
        let mut value = log_likelihood(self.data, &expected);
        if value == f64::NEG_INFINITY {
            // Some bins are left to the components that were put at zero.
            x.iter_mut().for_each(|x| *x = x.max(1e-3));
            expected = self.expected(&x);
            value = log_likelihood(self.data, &expected);
        }
        if !value.is_finite() {
            return None;
        }
        for _ in 0..STEPS {
            let direction = self.step(&expected, &x) - &x;
            let mut share = 1.0;
            let mut better = None;
            for _ in 0..HALVINGS {
                let candidate = &x + share * &direction;
                let expected = self.expected(&candidate);
                let value_there = log_likelihood(self.data, &expected);
                if value_there > value {
                    better = Some((candidate, expected, value_there));
                    break;
                }
                share *= 0.5;
            }
            let Some((candidate, expected_there, value_there)) = better else {
                break;
            };
            let gain = value_there - value;
            (x, expected, value) = (candidate, expected_there, value_there);
            if gain < ARRIVED {
                break;
            }
        }
        Some((x, value))
    }
}

/// From the first bin that a component reaches to the last.
fn reach(component: &[f64]) -> Bins<usize> {
    let is_there = |one: &f64| *one != 0.0;
    let first = component.iter().position(is_there).unwrap_or(0);
    let end = component
        .iter()
        .rposition(is_there)
        .map_or(0, |last| last + 1);
    first..end
}

/// Densities averaged over neighbours, weighted by their degrees of freedom; positive.
fn smooth(data: &Data) -> Vec<f64> {
    let size = data.len();
    (0..size)
        .map(|b| {
            let near = b.saturating_sub(NEIGHBOURS)..(b + NEIGHBOURS + 1).min(size);
            let dof: f64 = data.dof[near.clone()].iter().sum();
            let sum: f64 = near.map(|b| data.dof[b] * data.psd[b]).sum();
            (sum / dof).max(1e-6 * data.unit)
        })
        .collect()
}
