//! How much the likelihood gains at first from one more component.

use nalgebra::{DMatrix, DVector};

use crate::fit::likelihood::{Data, Fit};
use crate::numeric::product::dot;

/// The score test (C. R. Rao 1948) of components added to a fit: with `u` the slope of the
/// log-likelihood at size zero and `I` the information on the size that the present components
/// leave, the gain is `u^2 / 2 I` where `u` is positive, for as long as it is small.
pub struct Rise<'a> {
    /// `dof / 2 E`, and how far the measured density lies above `E`, as a share.
    weights: Vec<f64>,
    excess: Vec<f64>,
    expected: &'a [f64],
    /// Present components that are not at their bound, over `E`.
    active: Vec<Vec<f64>>,
    inverse: DMatrix<f64>,
}

impl<'a> Rise<'a> {
    /// Together with `present`, whose fit is `base`; `None` if the data cannot distinguish these.
    pub fn new(data: &Data, base: &'a Fit, present: &[Vec<f64>]) -> Option<Self> {
        Self::beside_squares(data, &base.expected, present, &base.squared)
    }

    /// Together with `present`, whose `squared` sizes make the expectation `expected`.
    pub fn beside_squares(
        data: &Data,
        expected: &'a [f64],
        present: &[Vec<f64>],
        squared: &[f64],
    ) -> Option<Self> {
        let active: Vec<Vec<f64>> = present
            .iter()
            .zip(squared)
            .filter(|(_, squared)| **squared > 0.0)
            .map(|(one, squared)| {
                one.iter()
                    .zip(expected)
                    .map(|(c, e)| squared * c / e)
                    .collect()
            })
            .collect();
        let weights: Vec<f64> = data.dof.iter().map(|dof| 0.5 * dof).collect();
        let product = |a: &[f64], b: &[f64]| -> f64 {
            a.iter()
                .zip(b)
                .zip(&weights)
                .map(|((a, b), w)| w * a * b)
                .sum()
        };
        let information = DMatrix::from_fn(active.len(), active.len(), |i, j| {
            product(&active[i], &active[j])
        });
        Some(Self {
            inverse: information.try_inverse()?,
            excess: data
                .psd
                .iter()
                .zip(expected)
                .map(|(y, e)| y / e - 1.0)
                .collect(),
            weights,
            expected,
            active,
        })
    }

    /// Length of the path through `directions` (changes of the expectation) as the data see them,
    /// radians: each less its part along the present components, of length one, and the arcs from one to the
    /// next. How many independent searches a search of all of them is (R. B. Davies, Biometrika 74
    /// (1987), eq. 3.1).
    pub fn path(&self, directions: impl Iterator<Item = Vec<f64>>) -> f64 {
        let mut length = 0.0;
        let mut last: Option<Vec<f64>> = None;
        for direction in directions {
            let Some(next) = self.beside(&direction) else {
                continue;
            };
            if let Some(last) = &last {
                length += self.product(last, &next).clamp(-1.0, 1.0).acos();
            }
            last = Some(next);
        }
        length
    }

    /// What of a component the present ones do not make, over `E`, of length one; `None` if nothing.
    fn beside(&self, component: &[f64]) -> Option<Vec<f64>> {
        let mut share: Vec<f64> = component
            .iter()
            .zip(self.expected)
            .map(|(c, e)| c / e)
            .collect();
        let weighted = self.weighted(&share);
        let own = dot(&weighted, &share);
        let products = DVector::from_iterator(
            self.active.len(),
            self.active.iter().map(|one| dot(&weighted, one)),
        );
        for (active, size) in self.active.iter().zip((&self.inverse * products).iter()) {
            for (share, active) in share.iter_mut().zip(active) {
                *share -= size * active;
            }
        }
        let left = self.product(&share, &share);
        (left > 1e-9 * own).then(|| {
            let norm = left.sqrt().recip();
            share.iter_mut().for_each(|one| *one *= norm);
            share
        })
    }

    /// A change of the expectation, each bin by its weight: products with it are sums over this.
    fn weighted(&self, share: &[f64]) -> Vec<f64> {
        let pairs = share.iter().zip(&self.weights);
        pairs.map(|(one, weight)| one * weight).collect()
    }

    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        dot(&self.weighted(a), b)
    }

    /// Gain in log-likelihood from `component`, nats; zero where less of it would fit better.
    pub fn of(&self, component: &[f64]) -> f64 {
        let share: Vec<f64> = component
            .iter()
            .zip(self.expected)
            .map(|(c, e)| c / e)
            .collect();
        let weighted = self.weighted(&share);
        let slope = dot(&weighted, &self.excess);
        let beside = DVector::from_iterator(
            self.active.len(),
            self.active.iter().map(|one| dot(&weighted, one)),
        );
        let own = dot(&weighted, &share);
        let left = own - beside.dot(&(&self.inverse * &beside));
        if slope > 0.0 && left > 1e-9 * own {
            slope * slope / (2.0 * left)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, Gamma};

    use super::*;
    use crate::fit::likelihood::maximise;

    /// Independent bins of white noise and a walk.
    fn data(seed: u64) -> (Data, Vec<Vec<f64>>) {
        let mut random = rand_pcg::Pcg64::new(u128::from(seed), 9);
        let f_hz: Vec<f64> = (0..160)
            .map(|k| 1e-2 * (f64::from(k) / 16.0).exp2())
            .collect();
        let law = Gamma::new(100.0, 0.01).expect("positive");
        let psd = f_hz
            .iter()
            .map(|f| (1.0 + 1e-3 / (f * f)) * law.sample(&mut random))
            .collect();
        let variances = DVector::from_element(f_hz.len(), 0.01);
        let components = vec![
            vec![1.0; f_hz.len()],
            f_hz.iter().map(|f| 1.0 / (f * f)).collect(),
        ];
        let data = Data::from_parts(f_hz, psd, DMatrix::from_diagonal(&variances));
        (data.expect("positive densities"), components)
    }

    fn peak(data: &Data, f_hz: f64) -> Vec<f64> {
        let near = |f: &f64| 1.0 / (1.0 + ((f - f_hz) / (0.3 * f_hz)).powi(2));
        data.f_hz.iter().map(near).collect()
    }

    #[test]
    fn foretells_the_gain_of_a_fit() {
        let mut seen = 0;
        for seed in 0..40 {
            let (data, mut components) = data(seed);
            let base = maximise(&data, &components).expect("a fit");
            let rise = Rise::new(&data, &base, &components).expect("told apart");
            let peak = peak(&data, 1.0);
            let foretold = rise.of(&peak);
            components.push(peak);
            let gain =
                maximise(&data, &components).expect("a fit").log_likelihood - base.log_likelihood;
            // To the third order in the size, which is a few percent of the noise.
            assert!(
                (foretold - gain).abs() < 0.1 + 0.1 * gain,
                "seed {seed}: {foretold} {gain}"
            );
            seen += u32::from(gain > 0.5);
        }
        assert!(seen > 5, "none of the records rose");
    }

    #[test]
    fn paths_grow_with_their_steps_and_close_at_a_right_angle() {
        let (data, components) = data(50);
        let base = maximise(&data, &components).expect("a fit");
        let rise = Rise::new(&data, &base, &components).expect("told apart");
        let near = rise.path([1.0, 1.01].into_iter().map(|f_hz| peak(&data, f_hz)));
        let far = rise.path([0.1, 20.0].into_iter().map(|f_hz| peak(&data, f_hz)));
        assert!(near < 0.1, "seed 50: {near}");
        assert!(
            (far - std::f64::consts::FRAC_PI_2).abs() < 0.3,
            "seed 50: {far}"
        );
        // What is there already has no direction.
        assert_eq!(rise.path(components.iter().cloned()), 0.0);
    }
}
