//! What data of one axis of a model should look like: spectral density, lines, Allan variance.
//!
//! The terms enter ahead of the signal chain, distortions act behind it. Behind a converter the
//! density is that of the continuous process times the chain's power, since the converter's
//! filter keeps out what lies above half the rate; without a converter it is that of the sampled
//! process, which includes what folds back.

use std::f64::consts::PI;

use super::Line;
use super::Term;
use super::effect::{Distortion, Part};
use super::kernel::{self, Kernel};
use super::whole::ModelAxis;
use crate::chain::Chain;

/// Steps of the table of the chain's power from zero to half the rate. Interpolation errs by less
/// than 1e-5 of the pass band's power.
const STEPS: usize = 8192;

/// The law of one axis.
pub struct Law {
    rate_hz: f64,
    terms: Vec<Box<dyn Term>>,
    distortions: Vec<Box<dyn Distortion>>,
    chain: Option<Chain>,
    /// Power of the chain at equal steps from zero to half the rate; empty without a chain.
    power: Vec<f64>,
}

impl Law {
    /// The law of `axis` at `rate_hz` samples a second.
    pub fn new(axis: &ModelAxis, rate_hz: f64) -> Self {
        let mut terms = axis.coefficients.terms();
        let mut distortions = Vec::new();
        for effect in &axis.effects {
            match effect.part() {
                Part::Term(term) => terms.push(term),
                Part::Distortion(distortion) => distortions.push(distortion),
            }
        }
        let table = |chain: &Chain| {
            let at = |step| 0.5 * rate_hz * step as f64 / STEPS as f64;
            (0..=STEPS)
                .map(|step| chain.power(at(step), rate_hz))
                .collect()
        };
        Self {
            rate_hz,
            terms,
            distortions,
            power: axis.chain.as_ref().map(table).unwrap_or_default(),
            chain: axis.chain.clone(),
        }
    }

    /// Samples a second.
    pub const fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The terms, those of effects included.
    pub fn terms(&self) -> &[Box<dyn Term>] {
        &self.terms
    }

    /// Factor that chain and distortions put on a density at `f_hz`, up to half the rate.
    pub fn power(&self, f_hz: f64) -> f64 {
        let distorted: f64 = self
            .distortions
            .iter()
            .map(|one| one.power(f_hz, self.rate_hz))
            .product();
        if self.power.is_empty() {
            return distorted;
        }
        let place = f_hz / (0.5 * self.rate_hz) * STEPS as f64;
        let step = (place as usize).min(STEPS - 1);
        let part = place - step as f64;
        let chain = self.power[step] + part * (self.power[step + 1] - self.power[step]);
        distorted * chain
    }

    /// Two-sided spectral density of `term` ahead of [`Law::power`], at `f_hz` between zero and
    /// half the rate.
    pub fn density_ahead(&self, term: &dyn Term, f_hz: f64) -> f64 {
        let band_limited = self
            .chain
            .as_ref()
            .is_some_and(|chain| chain.converter.is_some());
        if band_limited {
            term.spectrum_ahead(f_hz, self.rate_hz)
        } else {
            term.spectrum(f_hz, self.rate_hz)
        }
    }

    /// Two-sided spectral density of the samples at `f_hz`, between zero and half the rate,
    /// without the [lines](Law::lines).
    pub fn density(&self, f_hz: f64) -> f64 {
        let sum: f64 = self
            .terms
            .iter()
            .map(|term| self.density_ahead(&**term, f_hz))
            .sum();
        sum * self.power(f_hz)
    }

    /// Power of the samples at single frequencies.
    pub fn lines(&self) -> Vec<Line> {
        let passed = |line: Line| Line {
            power: line.power * self.power(line.f_hz),
            ..line
        };
        self.terms
            .iter()
            .flat_map(|term| term.lines())
            .map(passed)
            .collect()
    }

    /// Expected Allan variance at `m` data periods.
    ///
    /// Exact where nothing filters; else the integral of the density ([`kernel::variance`]).
    pub fn allan_variance(&self, m: u64) -> f64 {
        let direct = |term: &dyn Term| term.allan_variance(m, self.rate_hz);
        if self.power.is_empty() && self.distortions.is_empty() {
            return self.terms.iter().map(|term| direct(&**term)).sum();
        }
        let drift: f64 = self
            .terms
            .iter()
            .filter(|term| term.is_drift())
            .map(|term| direct(&**term))
            .sum();
        let lines: f64 = self
            .lines()
            .into_iter()
            .map(|line| line.power * Kernel::Allan.at(m, PI * line.f_hz / self.rate_hz))
            .sum();
        let noise = kernel::variance(Kernel::Allan, m, self.rate_hz, |f| self.density(f));
        drift + lines + noise
    }
}
