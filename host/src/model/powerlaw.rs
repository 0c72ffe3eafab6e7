//! A spectrum that falls, or rises, with a power of frequency that none of the five terms has.

use super::effect::{Band, Effect, Parameter, Part, Quantity};
use super::filter::{REACH, SymmetricFilter};
use super::kernel::{self, Kernel};
use super::kind::Kind;
use super::markov::Markov;
use super::random::Generator;
use super::{Seed, Term};

/// Noise of the two-sided density `density_1hz (f / 1 Hz)^-exponent`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// Slope of the spectrum, between 0 and 2.
    pub exponent: f64,
    /// Two-sided density at 1 Hz, square of the signal's unit per hertz.
    pub density_1hz: f64,
}

impl Term for PowerLaw {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        kernel::variance(Kernel::Allan, m, rate_hz, |f| self.spectrum(f, rate_hz))
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        // The kernel at an averaging time scales with tau^(exponent - 1).
        const M: u64 = 1 << 16;
        self.allan_variance(M, M as f64) * tau_s.powf(self.exponent - 1.0)
    }

    fn spectrum(&self, f_hz: f64, _rate_hz: f64) -> f64 {
        self.density_1hz * f_hz.powf(-self.exponent)
    }

    fn spectrum_ahead(&self, f_hz: f64, rate_hz: f64) -> f64 {
        self.spectrum(f_hz, rate_hz)
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        Box::new(Shelves::new(*self, rate_hz, seed))
    }
}

/// Corners an octave of the sum of Markov processes that stands for the power law.
const CORNERS_PER_OCTAVE: f64 = 1.0;

/// Octaves below half the rate that the sum covers.
const OCTAVES: f64 = 30.0;

/// Streams of random numbers further on that the shelves take, out of reach of other terms.
const STREAMS: u64 = 1 << 32;

/// Frequency over half the rate at and below which the sum is level with the law, and is left as it is.
const LEVEL: f64 = 1.0 / REACH as f64;

/// Samples that are made at a time.
const BLOCK: usize = 4096;

/// Markov processes whose corners are equally spaced in the logarithm: a sum of shelves with
/// weights `f^(1 - exponent)` falls as `f^-exponent` between the lowest and the highest. What sampling folds back into
/// the upper end of the band, up to three times the law, is taken off by a filter.
struct Shelves {
    markov: Vec<Box<dyn Generator>>,
    filter: SymmetricFilter,
    /// Samples that were made and not asked for yet.
    ready: Vec<f64>,
}

impl Shelves {
    fn new(law: PowerLaw, rate_hz: f64, seed: Seed) -> Self {
        let count = (CORNERS_PER_OCTAVE * OCTAVES) as usize;
        // Some corners above half the rate keep the slope up to it.
        let top_hz = 4.0 * rate_hz;
        let corners: Vec<f64> = (0..count)
            .map(|k| top_hz * (-(k as f64) / CORNERS_PER_OCTAVE).exp2())
            .collect();
        let markov = |corner_hz: f64, power: f64| Markov {
            deviation: power.sqrt(),
            time_s: 1.0 / (std::f64::consts::TAU * corner_hz),
        };
        let power = |corner: f64| corner.powf(1.0 - law.exponent);
        let unit = |f_hz: f64| -> f64 {
            let shelves = corners.iter();
            let each = shelves.map(|&corner| markov(corner, power(corner)).spectrum(f_hz, rate_hz));
            each.sum()
        };
        let over = |share: f64| {
            let f_hz = 0.5 * rate_hz * share.max(LEVEL);
            law.spectrum(f_hz, rate_hz) / unit(f_hz)
        };
        let gain = over(0.0);
        let shelf = |(k, &corner): (u64, &f64)| {
            let stream = Seed {
                seed: seed.seed,
                stream: seed.stream + STREAMS * (k + 1),
            };
            markov(corner, gain * power(corner)).generator(rate_hz, stream)
        };
        Self {
            markov: (0..).zip(&corners).map(shelf).collect(),
            filter: SymmetricFilter::new(|share| (over(share) / gain).sqrt()),
            ready: Vec::new(),
        }
    }
}

impl Generator for Shelves {
    fn add_to(&mut self, samples: &mut [f64]) {
        while self.ready.len() < samples.len() {
            let mut block = vec![0.0; BLOCK];
            for shelf in &mut self.markov {
                shelf.add_to(&mut block);
            }
            self.ready.append(&mut self.filter.pass(&block));
        }
        let made = self.ready.drain(..samples.len());
        samples
            .iter_mut()
            .zip(made)
            .for_each(|(sample, made)| *sample += made);
    }
}

/// Power law in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "powerlaw"
    }

    fn meaning(&self) -> &'static str {
        "a slope of the spectrum between those of the five terms, over decades: traps or \
         relaxations whose time constants are not spread evenly"
    }

    fn check(&self, _values: &[f64]) -> String {
        "record at another temperature and supply: a slope that changes points to traps in the \
         electronics, one that stays to the mechanics"
            .to_owned()
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("exponent", Quantity::Ratio, "slope, density ~ f^-exponent"),
            Parameter::new(
                "density_1hz",
                Quantity::Density,
                "two-sided density at 1 Hz",
            ),
        ]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(PowerLaw {
            exponent: values[0],
            density_1hz: values[1],
        }))
    }

    fn size(&self) -> Option<usize> {
        Some(1)
    }

    fn starts(&self, _band: &Band) -> Vec<Vec<f64>> {
        [0.3, 0.5, 0.7, 1.3, 1.5, 1.7]
            .into_iter()
            .map(|exponent| vec![exponent, 1.0])
            .collect()
    }
}
