//! The noise model: a sum of independent terms, one file for each.
//!
//! A [`Term`] knows its law (Allan variance and spectrum of the *sampled* process), how to make
//! data that follow it, and what it is physically. The five terms of the published model
//! (Pavlov and Petrov eq. 8) are each linear in one squared [`Coefficient`]; that is what the
//! fits use. Spectra are two-sided, per hertz; averaging times are `m` data periods.
//!
//! What else a record can hold is an [`effect`], listed in the [`catalogue`]. A [`whole`] model is
//! some [axes](axis) with coefficients, effects and a signal chain, as a [`file`] holds it; an axis's
//! [`law`] is what data of it should look like.

pub mod averaging;
pub mod axis;
pub mod burst;
pub mod catalogue;
pub mod clipping;
pub mod common_mode;
mod correlation;
pub mod cyclic;
pub mod drift;
pub mod dropped;
pub mod effect;
pub mod file;
mod filter;
pub mod flicker;
pub mod follows;
pub mod held;
pub mod highpass;
pub mod hum;
pub mod kernel;
pub mod kind;
pub mod law;
pub mod markov;
pub mod marks;
pub mod motion;
pub mod once;
pub mod outliers;
mod parameter;
pub mod powerlaw;
pub mod published;
pub mod quantisation;
pub mod ramp;
pub mod random;
pub mod resonance;
pub mod rolloff;
pub mod rounding;
pub mod shock;
pub mod sinusoid;
pub mod stale;
pub mod steps;
pub mod telegraph;
pub mod thermal;
pub mod timebase;
#[cfg(test)]
mod trial;
pub mod unnamed;
pub mod walk;
pub mod wander;
pub mod wandering_line;
pub mod warmup;
pub mod white;
pub mod whole;

use std::f64::consts::PI;

pub use random::Seed;

use self::random::Generator;
use crate::numeric::peak::Peak;
use crate::signal::Unit;

/// One kind of noise with its parameters.
pub trait Term: Send + Sync {
    /// Allan variance of the sampled process at `m` data periods, exact.
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64;

    /// Allan variance of the process in continuous time: the textbook straight line.
    fn allan_asymptote(&self, tau_s: f64) -> f64;

    /// Two-sided spectral density of the sampled process at `f_hz`, between zero and half the
    /// rate. Zero for what is not random.
    fn spectrum(&self, f_hz: f64, rate_hz: f64) -> f64;

    /// The same at many frequencies: what they have in common is worked out once.
    fn spectra(&self, at: &Frequencies) -> Vec<f64> {
        let each = at.f_hz.iter();
        each.map(|&f_hz| self.spectrum(f_hz, at.rate_hz)).collect()
    }

    /// Two-sided spectral density ahead of a signal chain that band-limits and samples it.
    fn spectrum_ahead(&self, f_hz: f64, rate_hz: f64) -> f64;

    /// Its power at single frequencies, which is in no density.
    fn lines(&self) -> Vec<Line> {
        Vec::new()
    }

    /// Peaks of its density that may be narrower than what the density is asked for.
    fn peaks(&self) -> Vec<Peak> {
        Vec::new()
    }

    /// Its peaks, where it has nothing but peaks so narrow that a filter acts on all of each as on its middle: the
    /// frequency of each, hertz, and its Allan variance at `m` data periods.
    fn narrow_peaks(&self, _m: u64, _rate_hz: f64) -> Option<Vec<(f64, f64)>> {
        None
    }

    /// Whether it is a slow course without a spectrum, that any chain lets through as it is.
    fn is_drift(&self) -> bool {
        false
    }

    /// Whether it is what one record [holds once](once): what makes noise louder leaves it as it is.
    fn is_once(&self) -> bool {
        false
    }

    /// How many independent values give its spectrum its shape in a record of `record_s` seconds: without an end for
    /// noise, whose ordinates are independent.
    fn shaped_by(&self, _record_s: f64) -> f64 {
        f64::INFINITY
    }

    /// What it adds to the Allan variance over `m` samples of a record of `samples`, in the mean, where it is random
    /// and passes: its law is zero, as no other record has it.
    fn passing(&self, _m: u64, _samples: u64, _rate_hz: f64) -> f64 {
        0.0
    }

    /// What it adds to the two-sided density at `f_hz` of a record of `record_s` seconds, likewise.
    fn passing_density(&self, _f_hz: f64, _record_s: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    /// Makes data that follow the law; the same `seed` gives the same data.
    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator>;
}

/// Frequencies at which many terms are asked for their spectra.
#[derive(Debug, Clone)]
pub struct Frequencies {
    f_hz: Vec<f64>,
    rate_hz: f64,
    /// Sine and cosine of half the angle that each turns in a sample.
    half_turns: Vec<(f64, f64)>,
}

impl Frequencies {
    /// Of samples at `rate_hz`.
    pub fn new(f_hz: &[f64], rate_hz: f64) -> Self {
        let half_turn = |f_hz: &f64| (PI * f_hz / rate_hz).sin_cos();
        Self {
            f_hz: f_hz.to_vec(),
            rate_hz,
            half_turns: f_hz.iter().map(half_turn).collect(),
        }
    }

    /// Each of them, hertz.
    pub fn f_hz(&self) -> &[f64] {
        &self.f_hz
    }
}

/// Power at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// The frequency, hertz.
    pub f_hz: f64,
    /// Mean square of the signal, unit of the signal squared: half the amplitude's square.
    pub power: f64,
}

/// The five coefficients of eq. 8, in the order of falling slope of the Allan curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Coefficient {
    /// Rate ramp, in the unit of the signal a second.
    R,
    /// Rate random walk, in the unit of the signal over the root of a second.
    K,
    /// Bias instability, in the unit of the signal.
    B,
    /// White noise (velocity or angle random walk), in the unit of the signal times the root of a second.
    N,
    /// Quantisation noise, in the unit of the signal times a second.
    Q,
}

impl Coefficient {
    /// All five coefficients.
    pub const ALL: [Self; 5] = [Self::R, Self::K, Self::B, Self::N, Self::Q];

    /// Letter of the coefficient.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::R => "R",
            Self::K => "K",
            Self::B => "B",
            Self::N => "N",
            Self::Q => "Q",
        }
    }

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::R => "rate ramp",
            Self::K => "rate random walk",
            Self::B => "bias instability",
            Self::N => "white noise",
            Self::Q => "quantisation noise",
        }
    }

    /// What it does physically, in a sentence.
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::R => ramp::MEANING,
            Self::K => walk::MEANING,
            Self::B => flicker::MEANING,
            Self::N => white::MEANING,
            Self::Q => quantisation::MEANING,
        }
    }

    /// Its unit, for a signal in `unit`.
    pub fn unit(self, unit: Unit) -> String {
        let special = match (unit, self) {
            (Unit::MetrePerSecondSquared, Self::R) => "m/s^3",
            (Unit::MetrePerSecondSquared, Self::K) => "m/s^2/sqrt(s)",
            (Unit::MetrePerSecondSquared, Self::N) => "m/s/sqrt(s)",
            (Unit::MetrePerSecondSquared, Self::Q) => "m/s",
            (Unit::RadianPerSecond, Self::N) => "rad/sqrt(s)",
            (Unit::RadianPerSecond, Self::Q) => "rad",
            (Unit::DegreePerSecond, Self::N) => "deg/sqrt(s)",
            (Unit::DegreePerSecond, Self::Q) => "deg",
            (_, Self::B) => unit.symbol(),
            _ => "",
        };
        if !special.is_empty() {
            return special.to_owned();
        }
        match self {
            Self::R => format!("{unit}/s"),
            Self::K => format!("{unit}/sqrt(s)"),
            Self::N => format!("{unit}*sqrt(s)"),
            _ => format!("{unit}*s"),
        }
    }

    /// The term with this coefficient at `value`.
    pub fn term(self, value: f64) -> Box<dyn Term> {
        match self {
            Self::R => Box::new(ramp::Ramp { per_s: value }),
            Self::K => Box::new(walk::Walk { per_root_s: value }),
            Self::B => Box::new(flicker::Flicker { level: value }),
            Self::N => Box::new(white::White {
                root_density: value,
            }),
            Self::Q => Box::new(quantisation::Quantisation { step: value }),
        }
    }
}

/// One number for each coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PerCoefficient<T> {
    /// That of the rate ramp.
    #[serde(rename = "R")]
    pub r: T,
    /// That of the rate random walk.
    #[serde(rename = "K")]
    pub k: T,
    /// That of the bias instability.
    #[serde(rename = "B")]
    pub b: T,
    /// That of the white noise.
    #[serde(rename = "N")]
    pub n: T,
    /// That of the quantisation noise.
    #[serde(rename = "Q")]
    pub q: T,
}

impl<T> PerCoefficient<T> {
    /// Asks `value` for each.
    pub fn from_fn(mut value: impl FnMut(Coefficient) -> T) -> Self {
        Self {
            r: value(Coefficient::R),
            k: value(Coefficient::K),
            b: value(Coefficient::B),
            n: value(Coefficient::N),
            q: value(Coefficient::Q),
        }
    }

    /// The one for `coefficient`.
    pub const fn get(&self, coefficient: Coefficient) -> &T {
        match coefficient {
            Coefficient::R => &self.r,
            Coefficient::K => &self.k,
            Coefficient::B => &self.b,
            Coefficient::N => &self.n,
            Coefficient::Q => &self.q,
        }
    }
}

impl PerCoefficient<f64> {
    /// The terms whose coefficient is not zero.
    pub fn terms(&self) -> Vec<Box<dyn Term>> {
        let present = |&coefficient: &Coefficient| *self.get(coefficient) != 0.0;
        let term = |coefficient: Coefficient| coefficient.term(*self.get(coefficient));
        Coefficient::ALL
            .into_iter()
            .filter(present)
            .map(term)
            .collect()
    }
}
