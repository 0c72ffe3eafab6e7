//! What each coefficient contributes to each point of a curve, and to the spectrum, with the
//! signal chain where it is known.
//!
//! With a chain the terms enter ahead of it. The contribution of a term is then the integral of
//! its spectrum times the chain's power over the kernel of the variance ([`crate::model::kernel`]);
//! without one it is that of the sampled process. The ramp passes any chain unchanged.

use nalgebra::DMatrix;

use crate::chain::Chain;
use crate::model::kernel::{self, Kernel};
use crate::model::{Coefficient, PerCoefficient, Term};

/// Steps of the table of the chain's power from zero to half the rate.
const STEPS: usize = 8192;

/// The five terms with coefficient 1, seen through a chain at a rate.
pub struct Design {
    rate_hz: f64,
    terms: PerCoefficient<Box<dyn Term>>,
    /// Power of the chain at equal steps from zero to half the rate; `None` without a chain.
    power: Option<Vec<f64>>,
    /// Whether the converter's filter keeps out what lies above half the rate.
    band_limited: bool,
}

impl Design {
    /// The terms through `chain` at `rate_hz`.
    pub fn new(rate_hz: f64, chain: Option<&Chain>) -> Self {
        let table = |chain: &Chain| {
            let at = |step| 0.5 * rate_hz * step as f64 / STEPS as f64;
            (0..=STEPS)
                .map(|step| chain.power(at(step), rate_hz))
                .collect()
        };
        Self {
            rate_hz,
            terms: PerCoefficient::from_fn(|coefficient| coefficient.term(1.0)),
            power: chain.map(table),
            band_limited: chain.is_some_and(|chain| chain.converter.is_some()),
        }
    }

    /// Samples a second.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Power that the chain lets through at `f_hz`, at most half the rate.
    pub fn power(&self, f_hz: f64) -> f64 {
        let Some(power) = &self.power else { return 1.0 };
        let place = f_hz / (0.5 * self.rate_hz) * STEPS as f64;
        let step = (place as usize).min(STEPS - 1);
        let part = place - step as f64;
        power[step] + part * (power[step + 1] - power[step])
    }

    /// Two-sided spectral density for coefficient 1 ahead of the chain's power.
    pub fn unit_spectrum(&self, coefficient: Coefficient, f_hz: f64) -> f64 {
        let term = self.terms.get(coefficient);
        if self.band_limited {
            term.spectrum_ahead(f_hz, self.rate_hz)
        } else {
            // Poles alone do not keep out what folds back; the sampled form includes it.
            term.spectrum(f_hz, self.rate_hz)
        }
    }

    /// Two-sided spectral density of the samples for squared coefficients.
    pub fn spectrum(&self, squares: &PerCoefficient<f64>, f_hz: f64) -> f64 {
        let sum: f64 = Coefficient::ALL
            .into_iter()
            .filter(|&one| *squares.get(one) > 0.0)
            .map(|one| squares.get(one) * self.unit_spectrum(one, f_hz))
            .sum();
        sum * self.power(f_hz)
    }

    /// Variance at `m` data periods for coefficient 1.
    pub fn unit_variance(&self, kernel: Kernel, coefficient: Coefficient, m: u64) -> f64 {
        // A ramp has the same variance in both families, with or without a chain.
        let closed =
            coefficient == Coefficient::R || (self.power.is_none() && kernel == Kernel::Allan);
        if closed {
            return self.terms.get(coefficient).allan_variance(m, self.rate_hz);
        }
        kernel::variance(kernel, m, self.rate_hz, |f| {
            self.unit_spectrum(coefficient, f) * self.power(f)
        })
    }

    /// The matrix of contributions: a row for each averaging factor, a column for each of
    /// [`Coefficient::ALL`].
    pub fn matrix(&self, kernel: Kernel, factors: &[u64]) -> DMatrix<f64> {
        DMatrix::from_fn(factors.len(), Coefficient::ALL.len(), |row, column| {
            self.unit_variance(kernel, Coefficient::ALL[column], factors[row])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise through converter and sensor pole, against the ideal line: ratios of
    /// deviations from an independent integration over the same filter.
    #[test]
    fn white_noise_through_the_chain() {
        for (chain, rate_hz, expected) in [
            ("ads1281:linear", 1000.0, [0.813, 0.998, 0.960, 0.992]),
            ("ads1281:linear+400hz", 2000.0, [0.476, 0.720, 0.799, 0.855]),
            ("ads1281:linear+300hz", 2000.0, [0.397, 0.630, 0.729, 0.797]),
            (
                "ads1281:linear+400hz+1507hz",
                4000.0,
                [0.250, 0.457, 0.584, 0.672],
            ),
        ] {
            let parsed = chain.parse::<Chain>().expect(chain);
            let design = Design::new(rate_hz, Some(&parsed));
            for (m, expected) in (1..).zip(expected) {
                let ratio = (design.unit_variance(Kernel::Allan, Coefficient::N, m) * m as f64
                    / rate_hz)
                    .sqrt();
                assert!((ratio - expected).abs() < 6e-4, "{chain} m={m}: {ratio}");
            }
        }
    }

    #[test]
    fn long_averages_do_not_see_the_chain() {
        let chain = "ads1281:linear+400hz".parse::<Chain>().expect("a chain");
        let (with, without) = (Design::new(2000.0, Some(&chain)), Design::new(2000.0, None));
        let terms = [
            Coefficient::N,
            Coefficient::B,
            Coefficient::K,
            Coefficient::R,
        ];
        let both = |kernel| terms.map(|coefficient| (kernel, coefficient));
        for (kernel, coefficient) in [Kernel::Allan, Kernel::Modified].into_iter().flat_map(both) {
            let ratio = with.unit_variance(kernel, coefficient, 1 << 20)
                / without.unit_variance(kernel, coefficient, 1 << 20);
            assert!(
                (ratio - 1.0).abs() < 1e-4,
                "{kernel:?} {coefficient:?}: {ratio}"
            );
        }
    }
}
