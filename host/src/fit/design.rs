//! What each coefficient contributes to each point of an Allan curve, and to the spectrum, with
//! the signal chain where it is known.
//!
//! With a chain the terms enter ahead of it. The contribution of a term is then the integral of
//! its spectrum times the chain's power over the Allan kernel ([`crate::model::kernel`]);
//! without one it is the closed form of the sampled process. The ramp passes any chain unchanged.

use nalgebra::DMatrix;

use crate::chain::Chain;
use crate::model::{Coefficient, PerCoefficient, kernel};

/// Steps of the table of the chain's power from zero to half the rate.
const STEPS: usize = 8192;

/// The chain's effect on the samples at a rate.
#[derive(Debug, Clone)]
pub struct Design {
    rate_hz: f64,
    /// Power of the chain at equal steps from zero to half the rate; `None` without a chain.
    power: Option<Vec<f64>>,
    /// Whether the converter's filter keeps out what lies above half the rate.
    band_limited: bool,
}

impl Design {
    /// The chain's effect at `rate_hz`.
    pub fn new(rate_hz: f64, chain: Option<&Chain>) -> Self {
        let table = |chain: &Chain| {
            let at = |step| 0.5 * rate_hz * step as f64 / STEPS as f64;
            (0..=STEPS)
                .map(|step| chain.power(at(step), rate_hz))
                .collect()
        };
        Self {
            rate_hz,
            power: chain.map(table),
            band_limited: chain.is_some_and(|chain| chain.converter.is_some()),
        }
    }

    /// Power that the chain lets through at `f_hz`, at most half the rate.
    fn power(&self, f_hz: f64) -> f64 {
        let Some(power) = &self.power else { return 1.0 };
        let place = f_hz / (0.5 * self.rate_hz) * STEPS as f64;
        let step = (place as usize).min(STEPS - 1);
        let part = place - step as f64;
        power[step] + part * (power[step + 1] - power[step])
    }

    /// Two-sided spectral density of the samples for coefficient 1.
    fn unit_spectrum(&self, coefficient: Coefficient, f_hz: f64) -> f64 {
        let term = coefficient.term(1.0);
        let density = if self.band_limited {
            term.spectrum_ahead(f_hz, self.rate_hz)
        } else {
            // Poles alone do not keep out what folds back; the sampled form includes it.
            term.spectrum(f_hz, self.rate_hz)
        };
        density * self.power(f_hz)
    }

    /// Two-sided spectral density of the samples for squared coefficients.
    pub fn spectrum(&self, squares: &PerCoefficient<f64>, f_hz: f64) -> f64 {
        Coefficient::ALL
            .into_iter()
            .filter(|&one| *squares.get(one) > 0.0)
            .map(|one| squares.get(one) * self.unit_spectrum(one, f_hz))
            .sum()
    }

    /// Allan variance at `m` data periods for coefficient 1.
    pub fn unit_allan_variance(&self, coefficient: Coefficient, m: u64) -> f64 {
        if self.power.is_none() || coefficient == Coefficient::R {
            return coefficient.term(1.0).allan_variance(m, self.rate_hz);
        }
        kernel::allan_variance(m, self.rate_hz, |f| self.unit_spectrum(coefficient, f))
    }

    /// The matrix of contributions: a row for each averaging factor, a column for each of
    /// [`Coefficient::ALL`].
    pub fn matrix(&self, factors: &[u64]) -> DMatrix<f64> {
        DMatrix::from_fn(factors.len(), Coefficient::ALL.len(), |row, column| {
            self.unit_allan_variance(Coefficient::ALL[column], factors[row])
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
                let ratio =
                    (design.unit_allan_variance(Coefficient::N, m) * m as f64 / rate_hz).sqrt();
                assert!((ratio - expected).abs() < 6e-4, "{chain} m={m}: {ratio}");
            }
        }
    }

    #[test]
    fn long_averages_do_not_see_the_chain() {
        let chain = "ads1281:linear+400hz".parse::<Chain>().expect("a chain");
        let (with, without) = (Design::new(2000.0, Some(&chain)), Design::new(2000.0, None));
        for coefficient in [
            Coefficient::N,
            Coefficient::B,
            Coefficient::K,
            Coefficient::R,
        ] {
            let ratio = with.unit_allan_variance(coefficient, 1 << 20)
                / without.unit_allan_variance(coefficient, 1 << 20);
            assert!((ratio - 1.0).abs() < 1e-4, "{coefficient:?}: {ratio}");
        }
    }
}
