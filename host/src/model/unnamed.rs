//! Unnamed: a band of noise that no effect explains.
//!
//! A model with it is right all the same: what is measured and has no name is given as the sum of bands.
//! Each is a process that can be made at any rate, without an end, and whose spectrum falls with the fourth
//! power of the distance from its middle: far from there it leaves alone what is a million times weaker. With one
//! decay `g` and two stages its covariance is `amplitude^2 (1 + g |t|) e^{-g |t|} cos(2 pi f t)`, which is
//! `1 - g d/dg` of that of a [resonance](super::resonance); so are its spectrum and its Allan variance.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::markov;
use super::marks::Mark;
use super::random::{Gaussian, Generator};
use super::{Frequencies, Seed, Term};
use crate::numeric::turning::turning;

/// Noise about a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Middle of the band, hertz; zero or above.
    pub f_hz: f64,
    /// Width at half the power, hertz.
    pub width_hz: f64,
    /// Root mean square, unit of the signal.
    pub amplitude: f64,
}

/// Half the width at half the power over the decay, both as angular frequencies: where `(1 + x^2)^2` is 2.
const HALF_WIDTH: f64 = 0.643_594_252_905_583;

/// Decay for one period of data below which a hyperbolic sine less its argument is its series; its error is below
/// 1e-9 of it.
const SMALL: f64 = 0.02;

/// Width over frequency below which a filter acts on the band as on its middle, as for a resonance.
const NARROW: f64 = 0.05;

impl Band {
    /// With these parameters, in the catalogue's order.
    pub fn of(values: &[f64]) -> Self {
        Self {
            f_hz: values[0],
            width_hz: values[1],
            amplitude: values[2],
        }
    }

    /// Its covariance at a distance of `lag_s` seconds.
    pub fn covariance(&self, lag_s: f64) -> f64 {
        self.bound(lag_s) * (TAU * self.f_hz * lag_s).cos()
    }

    /// Its covariances at a distance of nothing and of all multiples of `lag_s` seconds.
    pub fn covariances(&self, lag_s: f64) -> impl Iterator<Item = f64> {
        let rate = Complex64::new(-self.decay_per_s(), TAU * self.f_hz) * lag_s;
        let square = self.amplitude.powi(2);
        let turned = turning(0, rate.exp(), move |lag| (rate * lag as f64).exp());
        let lags = (0_u64..).zip(turned);
        lags.map(move |(lag, turned)| square * (1.0 - rate.re * lag as f64) * turned.re)
    }

    /// What the covariance is at most at that distance and beyond.
    pub fn bound(&self, lag_s: f64) -> f64 {
        let decayed = self.decay_per_s() * lag_s.abs();
        self.amplitude.powi(2) * (1.0 + decayed) * (-decayed).exp()
    }

    /// Its density as sampled, with all that folds back, by sine and cosine of half the angle that a frequency turns in a
    /// sample.
    fn folded(&self, rate_hz: f64) -> impl Fn((f64, f64)) -> f64 {
        let decay = self.decay_per_s() / rate_hz;
        let sinh = decay.sinh();
        let low = (0.5 * decay).sinh().powi(2);
        let excess = if decay < SMALL {
            decay.powi(3) / 6.0 * (1.0 + decay * decay / 20.0)
        } else {
            sinh - decay
        };
        let half = 0.5 * self.amplitude.powi(2);
        let (middle_sine, middle_cosine) = (PI * self.f_hz / rate_hz).sin_cos();
        let side = move |sine: f64| {
            let high = sine * sine;
            let above = low * (sinh + decay - 2.0 * decay * high) + high * excess;
            above / (2.0 * (low + high).powi(2) * rate_hz)
        };
        move |(sine, cosine)| {
            // The sines of a difference and of a sum by those of both.
            let (across, along) = (cosine * middle_sine, sine * middle_cosine);
            half * (side(along - across) + side(along + across))
        }
    }

    /// Its decay, 1/s.
    fn decay_per_s(&self) -> f64 {
        PI * self.width_hz / HALF_WIDTH
    }
}

impl Term for Band {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        let decay = self.decay_per_s() / rate_hz;
        let turning = Complex64::new(decay, -TAU * self.f_hz / rate_hz);
        let [variance, slope] = markov::unit_allan_variance_and_slope(turning, m);
        self.amplitude.powi(2) * (variance - decay * slope).re
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        // Long averages see what is left at zero frequency, white.
        self.spectrum_ahead(0.0, 0.0) / tau_s
    }

    fn spectrum(&self, f_hz: f64, rate_hz: f64) -> f64 {
        self.folded(rate_hz)((PI * f_hz / rate_hz).sin_cos())
    }

    fn spectra(&self, at: &Frequencies) -> Vec<f64> {
        let half_turns = at.half_turns.iter().copied();
        half_turns.map(self.folded(at.rate_hz)).collect()
    }

    fn spectrum_ahead(&self, f_hz: f64, _rate_hz: f64) -> f64 {
        let decay = self.decay_per_s();
        let side = |offset_hz: f64| {
            let offset = TAU * offset_hz;
            4.0 * decay.powi(3) / (decay * decay + offset * offset).powi(2)
        };
        0.5 * self.amplitude.powi(2) * (side(f_hz - self.f_hz) + side(f_hz + self.f_hz))
    }

    fn narrow_peaks(&self, m: u64, rate_hz: f64) -> Option<Vec<(f64, f64)>> {
        let is_narrow = self.width_hz < NARROW * self.f_hz;
        is_narrow.then(|| vec![(self.f_hz, self.allan_variance(m, rate_hz))])
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let decay = self.decay_per_s() / rate_hz;
        let mut noise = Gaussian::new(seed, self.amplitude);
        let mut draw = || Complex64::new(noise.draw(), noise.draw());
        // Two stages behind one another, the first of twice the power of the second.
        let second = draw();
        let first = second + draw();
        // What is new to both, from what they lose: the first two rows of a Cholesky factor.
        let new = [1, 2, 3].map(|from| exponential_from(2.0 * decay, from));
        let own = (2.0 * new[0]).sqrt();
        let shared = new[1] / own;
        Box::new(TwoStages {
            noise,
            stages: [first, second],
            turn: Complex64::from_polar((-decay).exp(), TAU * self.f_hz / rate_hz),
            decay,
            own,
            shared: [shared, (new[2] - shared * shared).max(0.0).sqrt()],
        })
    }
}

/// The terms of the exponential series of `x` from number `from` on, over all of them.
fn exponential_from(x: f64, from: u32) -> f64 {
    let before: f64 = (1..from).map(|k| x / f64::from(k)).product();
    let mut term = before * x / f64::from(from) * (-x).exp();
    let mut sum = 0.0;
    for number in from + 1.. {
        sum += term;
        if term <= f64::EPSILON * sum && f64::from(number) > x {
            break;
        }
        term *= x / f64::from(number);
    }
    sum
}

/// Two leaky stages, one behind the other, that turn and are pushed about at random.
struct TwoStages {
    noise: Gaussian,
    stages: [Complex64; 2],
    turn: Complex64,
    decay: f64,
    /// What is new to the first stage, over the amplitude.
    own: f64,
    /// What is new to the second: with the first, and by itself.
    shared: [f64; 2],
}

impl Generator for TwoStages {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            let [first, second] = self.stages;
            *sample += second.re;
            let mut draw = || Complex64::new(self.noise.draw(), self.noise.draw());
            let (one, other) = (draw(), draw());
            self.stages = [
                self.turn * first + self.own * one,
                self.turn * (second + self.decay * first)
                    + self.shared[0] * one
                    + self.shared[1] * other,
            ];
        }
    }
}

/// Unnamed noise in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "unnamed"
    }

    fn meaning(&self) -> &'static str {
        "noise that no effect of the catalogue explains: the model makes it, and says nothing of its cause"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("f_hz", Quantity::Centre, "middle of the band"),
            Parameter::new("width_hz", Quantity::Hertz, "width at half the power"),
            Parameter::new("amplitude", Quantity::Signal, "root mean square"),
        ]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "switch off what turns, hums or regulates about {:.4} Hz, one by one, and see what goes",
            values[0]
        )
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let half = 0.5 * values[1];
        vec![Mark::Band((values[0] - half).max(0.0), values[0] + half)]
    }

    fn size(&self) -> Option<usize> {
        Some(2)
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(Band::of(values)))
    }
}

#[cfg(test)]
mod tests;
