//! Resonance: noise that rings, a peak of finite width in the spectrum.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;

use super::effect::{Band, Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::markov;
use super::marks::Mark;
use super::random::{Gaussian, Generator};
use super::{Frequencies, Seed, Term};

/// Noise about a frequency: `Re(z e^{2 pi i f0 t})` with `z` complex Markov noise. Its covariance
/// is `amplitude^2 e^{-pi width |t|} cos(2 pi f0 t)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// Frequency of the peak, hertz.
    pub f_hz: f64,
    /// Width of the peak at half its power, hertz.
    pub width_hz: f64,
    /// Root mean square, unit of the signal.
    pub amplitude: f64,
}

impl Resonance {
    /// Its density as sampled: half of the Lorentzian on either side, each with all that folds back onto it; by sine and
    /// cosine of half the angle that a frequency turns in a sample.
    fn folded(&self, rate_hz: f64) -> impl Fn((f64, f64)) -> f64 {
        let decay = PI * self.width_hz / rate_hz;
        let (fall, keep) = (-(-decay).exp_m1(), (-decay).exp());
        let height = -(-2.0 * decay).exp_m1() / rate_hz;
        let half = 0.5 * self.amplitude.powi(2);
        let (middle_sine, middle_cosine) = (PI * self.f_hz / rate_hz).sin_cos();
        let side = move |sine: f64| height / (fall * fall + 4.0 * keep * sine * sine);
        move |(sine, cosine)| {
            // The sines of a difference and of a sum by those of both.
            let (across, along) = (cosine * middle_sine, sine * middle_cosine);
            half * (side(along - across) + side(along + across))
        }
    }
}

impl Term for Resonance {
    /// That of Markov noise with a complex decay: its covariance is the real part of a power of one.
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        let decay = Complex64::new(PI * self.width_hz, -TAU * self.f_hz) / rate_hz;
        self.amplitude.powi(2) * markov::unit_allan_variance(decay, m).re
    }

    fn narrow_peaks(&self, m: u64, rate_hz: f64) -> Option<Vec<(f64, f64)>> {
        let is_narrow = self.width_hz < NARROW * self.f_hz;
        is_narrow.then(|| vec![(self.f_hz, self.allan_variance(m, rate_hz))])
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
        let half = 0.5 * self.width_hz;
        let side = |offset_hz: f64| half / PI / (offset_hz * offset_hz + half * half);
        0.5 * self.amplitude.powi(2) * (side(f_hz - self.f_hz) + side(f_hz + self.f_hz))
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let decay = PI * self.width_hz / rate_hz;
        let mut noise = Gaussian::new(seed, self.amplitude);
        let turn = TAU * self.f_hz / rate_hz;
        Box::new(Ringing {
            state: [noise.draw(), noise.draw()],
            noise,
            turn: [turn.cos(), turn.sin()],
            keep: (-decay).exp(),
            innovation: (-(-2.0 * decay).exp_m1()).sqrt(),
        })
    }
}

/// Width over frequency below which a filter acts on a peak as it does on its middle: a filter that falls with
/// the square of the frequency changes by a tenth across it. A choice.
const NARROW: f64 = 0.05;

/// A rotating vector that is pushed about at random.
struct Ringing {
    noise: Gaussian,
    state: [f64; 2],
    turn: [f64; 2],
    keep: f64,
    innovation: f64,
}

impl Generator for Ringing {
    fn add_to(&mut self, samples: &mut [f64]) {
        let [cosine, sine] = self.turn;
        for sample in samples {
            let [x, y] = self.state;
            *sample += x;
            self.state = [
                self.keep * (cosine * x - sine * y) + self.innovation * self.noise.draw(),
                self.keep * (sine * x + cosine * y) + self.innovation * self.noise.draw(),
            ];
        }
    }
}

/// Resonance in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "resonance"
    }

    fn meaning(&self) -> &'static str {
        "noise that rings about one frequency: a mechanical resonance of sensor or mounting, or a \
         clock whose alias wanders"
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "tap the block and load it with a mass: a mechanical resonance at {:.4} Hz moves, an \
             electrical one does not; change the data rate: an alias moves",
            values[0]
        )
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("f_hz", Quantity::Hertz, "frequency of the peak"),
            Parameter::new("width_hz", Quantity::Hertz, "width at half the power"),
            Parameter::new("amplitude", Quantity::Signal, "root mean square"),
        ]
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let [f_hz, width_hz] = [values[0], values[1]];
        // As far down as an octave: what is wider is no band about it.
        let from_hz = (f_hz - 0.5 * width_hz).max(0.5 * f_hz);
        vec![
            Mark::Line { f_hz, multiple: 1 },
            Mark::Band(from_hz, f_hz + 0.5 * width_hz),
        ]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(Resonance {
            f_hz: values[0],
            width_hz: values[1],
            amplitude: values[2],
        }))
    }

    fn is_sound(&self, values: &[f64]) -> bool {
        // Wider it does not ring: noise behind a first-order lag.
        values[1] <= 0.8 * values[0]
    }

    fn size(&self) -> Option<usize> {
        Some(2)
    }

    fn starts(&self, band: &Band) -> Vec<Vec<f64>> {
        let mut starts = Vec::new();
        for f_hz in band.steps(8.0) {
            for share in [0.02, 0.1, 0.5] {
                starts.push(vec![f_hz, share * f_hz, 1.0]);
            }
        }
        starts
    }
}
