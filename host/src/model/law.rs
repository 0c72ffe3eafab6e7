//! What data of one axis of a model should look like: spectral density, lines, Allan variance.
//!
//! The terms enter ahead of the signal chain, distortions act behind it. Behind a converter the
//! density is that of the continuous process times the chain's power, since the converter's
//! filter keeps out what lies above half the rate; without a converter it is that of the sampled
//! process, which includes what folds back.
//!
//! Where the time base is off, all of that happens at the true rate; frequencies and densities are
//! given as they look by the nominal one.

use std::f64::consts::{PI, TAU};

use super::axis::ModelAxis;
use super::effect::{Distortion, Incoming, Part};
use super::kernel::{self, Kernel};
use super::{Line, Term};
use crate::chain::Chain;

/// Steps of the table of the chain's power from zero to half the rate. Interpolation errs by less
/// than 1e-5 of the pass band's power.
const STEPS: usize = 8192;

impl ModelAxis {
    /// What data of this axis should look like.
    pub fn law(&self, rate_hz: f64) -> Law {
        Law::new(self, rate_hz)
    }
}

/// The law of one axis.
pub struct Law {
    rate_hz: f64,
    /// True rate over the nominal one.
    clock: f64,
    terms: Vec<Box<dyn Term>>,
    distortions: Vec<Box<dyn Distortion>>,
    /// Autocovariances of the noise that each distortion adds.
    added: Vec<Vec<f64>>,
    chain: Option<Chain>,
    /// Power of the chain at equal steps from zero to half the rate; empty without a chain.
    power: Vec<f64>,
}

impl Law {
    /// The law of `axis` at a nominal `rate_hz` samples a second.
    pub fn new(axis: &ModelAxis, rate_hz: f64) -> Self {
        let clock = axis.clock();
        let mut terms = axis.coefficients.terms();
        let mut distortions = Vec::new();
        for effect in &axis.effects {
            match effect.part() {
                Part::Term(term) => terms.push(term),
                Part::Distortion(distortion) => distortions.push(distortion),
                // The clock is known already; a leader's law is not in the model.
                Part::Clock(_) | Part::Follows(_) => {}
            }
        }
        let table = |chain: &Chain| {
            let true_hz = clock * rate_hz;
            let at = |step| 0.5 * true_hz * step as f64 / STEPS as f64;
            (0..=STEPS)
                .map(|step| chain.power(at(step), true_hz))
                .collect()
        };
        let mut law = Self {
            rate_hz,
            clock,
            terms,
            distortions: Vec::new(),
            added: Vec::new(),
            power: axis.chain.as_ref().map(table).unwrap_or_default(),
            chain: axis.chain.clone(),
        };
        for distortion in distortions {
            let added = law.added_by(&*distortion);
            law.distortions.push(distortion);
            law.added.push(added);
        }
        law
    }

    /// Autocovariances of the noise that a further distortion would add to what the law is so far.
    fn added_by(&self, distortion: &dyn Distortion) -> Vec<f64> {
        let density = |f_hz: f64| self.density(f_hz / self.clock) / self.clock;
        let mut lines = self.lines();
        for line in &mut lines {
            line.f_hz *= self.clock;
        }
        distortion.adds(&Incoming {
            rate_hz: self.true_rate_hz(),
            density: &density,
            lines: &lines,
        })
    }

    /// Samples a second, nominal.
    pub const fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    fn true_rate_hz(&self) -> f64 {
        self.clock * self.rate_hz
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
            .map(|one| one.power(self.clock * f_hz, self.true_rate_hz()))
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
        let (true_hz, rate_hz) = (self.clock * f_hz, self.true_rate_hz());
        let density = if band_limited {
            term.spectrum_ahead(true_hz, rate_hz)
        } else {
            term.spectrum(true_hz, rate_hz)
        };
        self.clock * density
    }

    /// Two-sided spectral density that the distortions add at `f_hz`, between zero and half the
    /// rate; nothing acts on it any more.
    pub fn density_added(&self, f_hz: f64) -> f64 {
        let (true_hz, rate_hz) = (self.clock * f_hz, self.true_rate_hz());
        let added = self
            .distortions
            .iter()
            .zip(&self.added)
            .fold(0.0, |below, (one, own)| {
                below * one.power(true_hz, rate_hz) + density_of(own, true_hz, rate_hz)
            });
        self.clock * added
    }

    /// Two-sided spectral density of the samples at `f_hz`, between zero and half the rate,
    /// without the [lines](Law::lines).
    pub fn density(&self, f_hz: f64) -> f64 {
        let sum: f64 = self
            .terms
            .iter()
            .map(|term| self.density_ahead(&**term, f_hz))
            .sum();
        sum * self.power(f_hz) + self.density_added(f_hz)
    }

    /// Power of the samples at single frequencies.
    pub fn lines(&self) -> Vec<Line> {
        let passed = |line: Line| {
            let f_hz = line.f_hz / self.clock;
            Line {
                f_hz,
                power: line.power * self.power(f_hz),
            }
        };
        self.terms
            .iter()
            .flat_map(|term| term.lines())
            .map(passed)
            .collect()
    }

    /// Expected Allan variance at `m` data periods.
    ///
    /// Exact where nothing filters; else the integral of the density ([`kernel::variance`]), which would step over a
    /// narrow peak: of that the filters let through what they let through in its middle.
    pub fn allan_variance(&self, m: u64) -> f64 {
        let direct = |term: &dyn Term| term.allan_variance(m, self.true_rate_hz());
        if self.power.is_empty() && self.distortions.is_empty() {
            return self.terms.iter().map(|term| direct(&**term)).sum();
        }
        let mut variance: f64 = self
            .lines()
            .into_iter()
            .map(|line| line.power * Kernel::Allan.at(m, PI * line.f_hz / self.rate_hz))
            .sum();
        let mut broad: Vec<&dyn Term> = Vec::new();
        for term in &self.terms {
            if term.is_drift() {
                variance += direct(&**term);
            } else if let Some(peaks) = term.narrow_peaks(m, self.true_rate_hz()) {
                let passed = |(f_hz, own): (f64, f64)| own * self.power(f_hz / self.clock);
                variance += peaks.into_iter().map(passed).sum::<f64>();
            } else {
                broad.push(&**term);
            }
        }
        let density = |f_hz: f64| {
            let sum: f64 = broad
                .iter()
                .map(|&term| self.density_ahead(term, f_hz))
                .sum();
            sum * self.power(f_hz) + self.density_added(f_hz)
        };
        variance + kernel::variance(Kernel::Allan, m, self.rate_hz, density)
    }
}

/// Two-sided spectral density of noise with these autocovariances, from lag zero on.
fn density_of(autocovariances: &[f64], f_hz: f64, rate_hz: f64) -> f64 {
    let twice = 2.0 * (TAU * f_hz / rate_hz).cos();
    // Clenshaw's recurrence for the sum of cosines.
    let (mut next, mut behind) = (0.0, 0.0);
    for value in autocovariances.iter().skip(1).rev() {
        (next, behind) = (value + twice * next - behind, next);
    }
    let at_zero = autocovariances.first().copied().unwrap_or_default();
    (at_zero + twice * next - 2.0 * behind) / rate_hz
}
