//! What data of one axis of a model should look like: spectral density, lines, Allan variance.
//!
//! The terms enter ahead of the signal chain, distortions act behind it. Behind a converter the
//! density is that of the continuous process times the chain's power, since the converter's
//! filter keeps out what lies above half the rate; without a converter it is that of the sampled
//! process, which includes what folds back.
//!
//! Where the time base is off, all of that happens at the true rate; frequencies and densities are
//! given as they look by the nominal one.
//!
//! Where values are held, all of that is of the values at their own rate `r`. Their spectrum, which repeats at its multiples,
//! is seen through `(sin(pi f / r) / (pi f / r))^2`, with what folds back at the rate at which they are written.

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
    /// Values a second, nominal.
    rate_hz: f64,
    /// Samples a second, nominal, where values are held.
    written_hz: Option<f64>,
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
        let written_hz = Some(rate_hz).filter(|&rate_hz| axis.values_hz(rate_hz) < rate_hz);
        let rate_hz = axis.values_hz(rate_hz);
        let mut terms = axis.coefficients.terms();
        let mut distortions = Vec::new();
        for effect in &axis.effects {
            match effect.part() {
                Part::Term(term) => terms.push(term),
                Part::Distortion(distortion) => distortions.push(distortion),
                // Clock and hold are known already; a leader's law is not in the model.
                Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => {}
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
            written_hz,
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
        let density = |f_hz: f64| self.own_density(f_hz / self.clock) / self.clock;
        let mut lines = self.own_lines();
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
    pub fn rate_hz(&self) -> f64 {
        self.written_hz.unwrap_or(self.rate_hz)
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
        self.written(f_hz, |f_hz| self.own_density_added(f_hz))
    }

    fn own_density_added(&self, f_hz: f64) -> f64 {
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
        self.written(f_hz, |f_hz| self.own_density(f_hz))
    }

    fn own_density(&self, f_hz: f64) -> f64 {
        self.density_of_terms(self.terms.iter().map(|one| &**one), f_hz)
            + self.own_density_added(f_hz)
    }

    fn density_of_terms<'a>(&self, terms: impl Iterator<Item = &'a dyn Term>, f_hz: f64) -> f64 {
        let sum: f64 = terms.map(|term| self.density_ahead(term, f_hz)).sum();
        sum * self.power(f_hz)
    }

    /// The density of samples at `f_hz` where that of the values is `own`.
    fn written(&self, f_hz: f64, own: impl Fn(f64) -> f64) -> f64 {
        /// What folds back is followed so many times on either side: beyond lies less than a hundredth of the power.
        const FOLDS: i32 = 16;
        /// Distance from a multiple of their rate, in it, at least: a walk has no end there, and holding shuts it out.
        const LEAST: f64 = 1e-9;
        let Some(written_hz) = self.written_hz else {
            return own(f_hz);
        };
        let seen = |fold: i32| {
            let turns = (f_hz + f64::from(fold) * written_hz) / self.rate_hz;
            let off = (turns - turns.round()).abs().max(LEAST);
            own(off * self.rate_hz) * held_power(turns)
        };
        (-FOLDS..=FOLDS).map(seen).sum()
    }

    /// Power of the samples at single frequencies, but for the images of held values.
    pub fn lines(&self) -> Vec<Line> {
        let mut lines = self.own_lines();
        if self.written_hz.is_some() {
            for line in &mut lines {
                line.power *= held_power(line.f_hz / self.rate_hz);
            }
        }
        lines
    }

    fn own_lines(&self) -> Vec<Line> {
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
        if let Some(hz) = self.written_hz {
            return self.held_variance(m, hz);
        }
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
            self.density_of_terms(broad.iter().copied(), f_hz) + self.own_density_added(f_hz)
        };
        variance + kernel::variance(Kernel::Allan, m, self.rate_hz, density)
    }

    /// The same of values held for `m` samples at `written_hz`; a slow course is one of either.
    fn held_variance(&self, m: u64, written_hz: f64) -> f64 {
        let lines = self.lines().into_iter();
        let lines = lines.map(|line| line.power * Kernel::Allan.at(m, PI * line.f_hz / written_hz));
        let values = (m as f64 * self.rate_hz / written_hz).round().max(1.0) as u64;
        let (drifts, random): (Vec<&dyn Term>, Vec<&dyn Term>) = self
            .terms
            .iter()
            .map(|one| &**one)
            .partition(|one| one.is_drift());
        let drifts = drifts.iter();
        let drifts = drifts.map(|one| one.allan_variance(values, self.true_rate_hz()));
        let own = |f_hz: f64| {
            self.density_of_terms(random.iter().copied(), f_hz) + self.own_density_added(f_hz)
        };
        let density = |f_hz: f64| self.written(f_hz, own);
        let noise = kernel::variance(Kernel::Allan, m, written_hz, density);
        lines.sum::<f64>() + drifts.sum::<f64>() + noise
    }
}

/// Power that is left of a frequency of so many turns a value, held until the next.
fn held_power(turns: f64) -> f64 {
    let x = PI * turns;
    if x == 0.0 { 1.0 } else { (x.sin() / x).powi(2) }
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
