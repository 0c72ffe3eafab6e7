//! Telegraph noise: jumps to and fro between two levels.

use rand_distr::{Bernoulli, Distribution};
use rand_pcg::Pcg64;

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::markov::Markov;
use super::marks::Mark;
use super::random::{self, Generator};
use super::{Seed, Term};

/// Two levels, at plus and minus half the height, held for exponentially distributed times.
///
/// Its covariance is `(height / 2)^2 exp(-2 |t| / dwell)`, so that spectrum and Allan variance are
/// those of [`Markov`] noise; the levels distinguish them. S. Machlup, J. Appl. Phys. 25 (1954)
/// 341, with equal times at both levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Telegraph {
    /// Distance of the levels, unit of the signal.
    pub height: f64,
    /// Mean time at a level before it is left, the same for both, seconds.
    pub dwell_s: f64,
}

impl Telegraph {
    /// With these parameters, in the catalogue's order.
    pub fn of(values: &[f64]) -> Self {
        Self {
            height: values[0],
            dwell_s: values[1],
        }
    }

    /// The one whose spectrum is that of some Markov noise: twice the deviation apart, each level kept for
    /// twice the correlation time.
    pub fn with_spectrum_of(markov: &Markov) -> Self {
        Self {
            height: Self::per_markov(markov.deviation),
            dwell_s: Self::per_markov(markov.time_s),
        }
    }

    /// Height of a deviation, and dwell of a correlation time.
    pub fn per_markov(parameter: f64) -> f64 {
        2.0 * parameter
    }

    /// The Markov noise with the same covariance.
    fn gaussian(&self) -> Markov {
        Markov {
            deviation: 0.5 * self.height.abs(),
            time_s: 0.5 * self.dwell_s,
        }
    }

    /// Probability that the level is another one a sample later: an odd number of jumps.
    fn turning(&self, rate_hz: f64) -> f64 {
        -0.5 * (-2.0 / (self.dwell_s * rate_hz)).exp_m1()
    }
}

impl Term for Telegraph {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        self.gaussian().allan_variance(m, rate_hz)
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        self.gaussian().allan_asymptote(tau_s)
    }

    fn spectrum(&self, f_hz: f64, rate_hz: f64) -> f64 {
        self.gaussian().spectrum(f_hz, rate_hz)
    }

    fn spectrum_ahead(&self, f_hz: f64, rate_hz: f64) -> f64 {
        self.gaussian().spectrum_ahead(f_hz, rate_hz)
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let mut random = random::random(seed);
        let chance = |probability| Bernoulli::new(probability).expect("between 0 and 1");
        let half = 0.5 * self.height;
        Box::new(Switch {
            level: if chance(0.5).sample(&mut random) {
                half
            } else {
                -half
            },
            turn: chance(self.turning(rate_hz)),
            random,
        })
    }
}

struct Switch {
    random: Pcg64,
    turn: Bernoulli,
    level: f64,
}

impl Generator for Switch {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            *sample += self.level;
            if self.turn.sample(&mut self.random) {
                self.level = -self.level;
            }
        }
    }
}

/// Telegraph noise in the catalogue. Its spectrum is that of Markov noise, so no search by the
/// spectrum's shape begins with it.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "telegraph"
    }

    fn meaning(&self) -> &'static str {
        "jumps to and fro between two levels: a single trap in the sensor's amplifier (popcorn \
         noise), a loose contact, a particle that sticks"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("height", Quantity::Signal, "distance of the levels"),
            Parameter::new("dwell_s", Quantity::Second, "mean time at a level"),
        ]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "warm and cool the sensor by 10 K: jumps of a trap come at another rate than one in \
             {:.3} s, at the same height; tap the board: a contact or a particle answers",
            values[1]
        )
    }

    fn size(&self) -> Option<usize> {
        Some(0)
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        Telegraph::of(values).gaussian().marks()
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(Telegraph::of(values)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::trial;

    #[test]
    fn times_at_a_level_are_exponential() {
        let (rate_hz, seed) = (1000.0, 3);
        let telegraph = Telegraph {
            height: 2.0,
            dwell_s: 0.01,
        };
        let mut samples = vec![5.0; 200_000];
        telegraph
            .generator(rate_hz, Seed { seed, stream: 0 })
            .add_to(&mut samples);
        assert!(samples.iter().all(|&x| x == 4.0 || x == 6.0));
        // Runs of samples at one level are geometric: longer than n with probability (1 - p)^n.
        let runs: Vec<usize> = samples.chunk_by(|a, b| a == b).map(<[f64]>::len).collect();
        let whole = &runs[1..runs.len() - 1];
        let count = whole.len() as f64;
        for length in [1, 3, 10, 30] {
            let found = whole.iter().filter(|&&run| run > length).count() as f64 / count;
            let expected = (1.0 - telegraph.turning(rate_hz)).powi(length as i32);
            let sigma = (expected * (1.0 - expected) / count).sqrt();
            assert!(
                (found - expected).abs() < 5.0 * sigma,
                "seed {seed}, longer than {length}: {found} for {expected}, sigma {sigma}"
            );
        }
        // Jumps there and back within one sample are not seen, hence 10 % longer.
        let seen = 1.0 / telegraph.turning(rate_hz) / rate_hz;
        assert!((seen / telegraph.dwell_s - 1.1).abs() < 0.01, "{seen}");
    }

    #[test]
    fn allan_variance_follows_the_law() {
        let telegraph = r#"{ "effect": "telegraph",
            "parameters": { "height": 2, "dwell_s": 0.02 } }"#;
        let axis = trial::axis("", telegraph);
        trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 8, 20, 64]);
    }
}
