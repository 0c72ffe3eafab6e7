//! A discrete linear system driven by white noise, put together from blocks.
//!
//! ```text
//! x[k+1] = F x[k] + G w[k],    y[k] = H x[k],    w[k] ~ N(0, Q), independent
//! ```

use nalgebra::{DMatrix, DVector};

/// A system with one output.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// Transition of the states.
    pub f: DMatrix<f64>,
    /// From the white inputs to the states.
    pub g: DMatrix<f64>,
    /// From the states to the output, in the unit of the signal.
    pub h: DVector<f64>,
    /// Variances of the white inputs, the diagonal of Q.
    pub q: DVector<f64>,
    /// States at the first sample: mean.
    pub x0: DVector<f64>,
    /// States at the first sample: covariance. That of a long past where there is one.
    pub p0: DMatrix<f64>,
    /// What each state belongs to.
    pub names: Vec<String>,
}

impl StateSpace {
    /// Nothing at all.
    pub fn empty() -> Self {
        Self {
            f: DMatrix::zeros(0, 0),
            g: DMatrix::zeros(0, 0),
            h: DVector::zeros(0),
            q: DVector::zeros(0),
            x0: DVector::zeros(0),
            p0: DMatrix::zeros(0, 0),
            names: Vec::new(),
        }
    }

    /// One state `x[k+1] = keep x[k] + w[k]` with inputs of variance `q`, starting at variance
    /// `p0`; the output is the state.
    pub fn first_order(name: impl Into<String>, keep: f64, q: f64, p0: f64) -> Self {
        Self {
            f: DMatrix::from_element(1, 1, keep),
            g: DMatrix::from_element(1, 1, 1.0),
            h: DVector::from_element(1, 1.0),
            q: DVector::from_element(1, q),
            x0: DVector::zeros(1),
            p0: DMatrix::from_element(1, 1, p0),
            names: vec![name.into()],
        }
    }

    /// Number of states.
    pub fn order(&self) -> usize {
        self.h.len()
    }

    /// Both, independent of one another, their outputs added.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            f: diagonal(&self.f, &other.f),
            g: diagonal(&self.g, &other.g),
            h: stack(&self.h, &other.h),
            q: stack(&self.q, &other.q),
            x0: stack(&self.x0, &other.x0),
            p0: diagonal(&self.p0, &other.p0),
            names: [&self.names[..], &other.names[..]].concat(),
        }
    }

    /// This with its output through low-pass sections `s[k+1] = (1 - c) s[k] + c y[k]`, one after
    /// the other; their states start at zero.
    #[must_use]
    pub fn cascade(&self, sections: &[f64]) -> Self {
        let mut system = self.clone();
        for c in sections {
            let n = system.order();
            system.f = system.f.resize(n + 1, n + 1, 0.0);
            for k in 0..n {
                system.f[(n, k)] = c * system.h[k];
            }
            system.f[(n, n)] = 1.0 - c;
            system.g = system.g.resize_vertically(n + 1, 0.0);
            system.h = DVector::zeros(n + 1);
            system.h[n] = 1.0;
            system.x0 = system.x0.resize_vertically(n + 1, 0.0);
            system.p0 = system.p0.resize(n + 1, n + 1, 0.0);
            system.names.push("low-pass of the chain".to_owned());
        }
        system
    }

    /// This, starting after a long past; for stable systems.
    #[must_use]
    pub fn settled(self) -> Self {
        Self {
            p0: self.stationary(),
            ..self
        }
    }

    /// Covariance of the states after a past that is long against every time constant; for
    /// stable systems.
    fn stationary(&self) -> DMatrix<f64> {
        let (mut power, mut covariance) = (self.f.clone(), self.noise());
        // 2^40 samples are past every time constant that matters; a stable system is there
        // sooner.
        for _ in 0..40 {
            let next = &covariance + &power * &covariance * power.transpose();
            if next == covariance {
                break;
            }
            covariance = next;
            power = &power * &power;
        }
        covariance
    }

    /// `G Q G'`.
    fn noise(&self) -> DMatrix<f64> {
        &self.g * DMatrix::from_diagonal(&self.q) * self.g.transpose()
    }

    /// Allan variance of the output at `m` samples, by exact recursion of covariances.
    ///
    /// To the states is added the sum of the output with one sign for `m` samples and the other
    /// for the next `m`; runs of equal signs are doubled, not stepped.
    pub fn allan_variance(&self, m: u64) -> f64 {
        let n = self.order();
        let step = |sign: f64| {
            let mut matrix = self.f.clone().resize(n + 1, n + 1, 0.0);
            matrix[(n, n)] = 1.0;
            for k in 0..n {
                matrix[(n, k)] = sign * self.h[k];
            }
            Run {
                transition: matrix,
                covariance: self.noise().resize(n + 1, n + 1, 0.0),
            }
        };
        let run = step(-1.0).times(m).then(&step(1.0).times(m));
        let mean = (&run.transition * self.x0.clone().resize_vertically(n + 1, 0.0))[n];
        let start = self.p0.clone().resize(n + 1, n + 1, 0.0);
        let end = &run.transition * start * run.transition.transpose() + &run.covariance;
        0.5 * (end[(n, n)] + mean * mean) / (m as f64).powi(2)
    }
}

/// Some steps of a linear system: how states pass them, and what noise comes in.
#[derive(Clone)]
struct Run {
    transition: DMatrix<f64>,
    covariance: DMatrix<f64>,
}

impl Run {
    /// This run and `next` after it.
    fn then(&self, next: &Self) -> Self {
        Self {
            transition: &next.transition * &self.transition,
            covariance: &next.transition * &self.covariance * next.transition.transpose()
                + &next.covariance,
        }
    }

    /// This run `count` times, at least once.
    fn times(&self, count: u64) -> Self {
        let (mut whole, mut doubled, mut left) = (None::<Self>, self.clone(), count);
        loop {
            if left & 1 == 1 {
                whole = Some(whole.map_or_else(|| doubled.clone(), |run| run.then(&doubled)));
            }
            left >>= 1;
            if left == 0 {
                return whole.unwrap_or(doubled);
            }
            doubled = doubled.then(&doubled);
        }
    }
}

fn diagonal(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(a.nrows() + b.nrows(), a.ncols() + b.ncols());
    matrix.view_mut((0, 0), a.shape()).copy_from(a);
    matrix.view_mut(a.shape(), b.shape()).copy_from(b);
    matrix
}

fn stack(a: &DVector<f64>, b: &DVector<f64>) -> DVector<f64> {
    DVector::from_iterator(a.len() + b.len(), a.iter().chain(b).copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Term;
    use crate::model::markov::Markov;
    use crate::model::walk::Walk;

    #[test]
    fn allan_variance_is_that_of_the_closed_forms() {
        let rate_hz: f64 = 50.0;
        let (walk, markov) = (
            Walk { per_root_s: 3.0 },
            Markov {
                deviation: 2.0,
                time_s: 0.7,
            },
        );
        let keep = (-1.0 / (0.7 * rate_hz)).exp();
        let system = StateSpace::first_order("walk", 1.0, 9.0 / rate_hz, 0.0).plus(
            &StateSpace::first_order("markov", keep, 4.0 * (1.0 - keep * keep), 4.0),
        );
        for m in [1, 2, 3, 17, 64, 1001] {
            let expected = walk.allan_variance(m, rate_hz) + markov.allan_variance(m, rate_hz);
            let relative = system.allan_variance(m) / expected - 1.0;
            assert!(relative.abs() < 1e-9, "m = {m}: {relative:e}");
        }
        assert!((system.stationary()[(1, 1)] / 4.0 - 1.0).abs() < 1e-12);
    }
}
