//! Stale samples: a sample repeats the one before.

use std::f64::consts::{PI, TAU};

use rand_distr::{Bernoulli, Distribution};
use rand_pcg::Pcg64;

use super::Seed;
use super::effect::{Distorter, Distortion, Effect, Incoming, Parameter, Part, Quantity, Stage};
use super::kernel::{self, Kernel};
use super::kind::Kind;
use super::random;

/// Each sample repeats the one before with the same probability, whatever happened before.
///
/// With `b` 1 for a fresh sample and 0 else, `y_k = y_(k-1) + b_k (x_k - y_(k-1))`. The part of
/// `b_k` that is not its mean multiplies what is independent of it, so it makes white noise that
/// is uncorrelated with the input, and with the share `s` of stale samples
///
/// ```text
/// y_k = s y_(k-1) + (1 - s) x_k + w_k,    <w^2> = s (1 - s) <(x_k - y_(k-1))^2>
/// ```
///
/// which is exact: a recursive filter, and a floor that grows with what the input does from one
/// sample to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stale {
    /// Share of samples that repeat the one before.
    pub share: f64,
}

impl Stale {
    /// `|1 - s z^-1|^2`.
    fn pole(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let sine = (PI * f_hz / rate_hz).sin();
        (1.0 - self.share).powi(2) + 4.0 * self.share * sine * sine
    }

    /// Mean square of the difference of a fresh sample and the one sent before it. That is of an
    /// age that is geometric: `2 (1 + s) int S(f) (1 - cos w) / |1 - s z^-1|^2 df` over both
    /// sides.
    fn jump(&self, incoming: &Incoming<'_>) -> f64 {
        let rate_hz = incoming.rate_hz;
        // The Allan kernel of single samples is 1 - cos w.
        let smooth = kernel::variance(Kernel::Allan, 1, rate_hz, |f_hz| {
            (incoming.density)(f_hz) / self.pole(f_hz, rate_hz)
        });
        let lines: f64 = incoming
            .lines
            .iter()
            .map(|line| {
                let step = 1.0 - (TAU * line.f_hz / rate_hz).cos();
                line.power * step / self.pole(line.f_hz, rate_hz)
            })
            .sum();
        2.0 * (1.0 + self.share) * (smooth + lines)
    }
}

impl Distortion for Stale {
    fn stage(&self) -> Stage {
        Stage::Reading
    }

    fn power(&self, f_hz: f64, rate_hz: f64) -> f64 {
        (1.0 - self.share).powi(2) / self.pole(f_hz, rate_hz)
    }

    fn floor(&self, incoming: &Incoming<'_>) -> f64 {
        if self.share >= 1.0 {
            // Nothing but the first sample.
            return 0.0;
        }
        self.share / (1.0 - self.share) * self.jump(incoming) / incoming.rate_hz
    }

    fn distorter(&self, _rate_hz: f64, seed: Seed) -> Box<dyn Distorter> {
        Box::new(Repeater {
            random: random::random(seed),
            stale: Bernoulli::new(self.share).expect("a share"),
            last: None,
        })
    }
}

struct Repeater {
    random: Pcg64,
    stale: Bernoulli,
    last: Option<f64>,
}

impl Distorter for Repeater {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        for sample in samples {
            if let (true, Some(last)) = (self.stale.sample(&mut self.random), self.last) {
                *sample = last;
            }
            self.last = Some(*sample);
        }
    }
}

/// Stale samples in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "stale"
    }

    fn meaning(&self) -> &'static str {
        "samples that repeat the one before: the reader was faster than the converter, or missed \
         a ready signal"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new(
            "share",
            Quantity::Share,
            "part of the samples that repeat the one before",
        )]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "compare the converter's clock with the reader's: {:.3} % of the samples are read \
             twice; read on the converter's ready signal, and count those that are missed",
            100.0 * values[0]
        )
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Stale { share: values[0] }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::trial;

    #[test]
    fn as_many_repeat_as_told() {
        let (stale, seed) = (Stale { share: 0.07 }, 4);
        let mut samples: Vec<f64> = (0..100_000).map(f64::from).collect();
        stale
            .distorter(1.0, Seed { seed, stream: 0 })
            .apply(&mut samples);
        let pairs = (samples.len() - 1) as f64;
        let found = samples.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64;
        let sigma = (pairs * stale.share * (1.0 - stale.share)).sqrt();
        let z = (found - pairs * stale.share) / sigma;
        assert!(z.abs() < 5.0, "seed {seed}: {found}, {z} sigma");
        // What is fresh is on time.
        let fresh = (0_u32..).zip(&samples).filter(|&(k, &x)| x == f64::from(k));
        assert_eq!(fresh.count() as f64, pairs + 1.0 - found);
    }

    #[test]
    fn allan_variance_follows_the_law() {
        for share in [0.05, 0.6] {
            let effects = format!(
                r#"{{ "effect": "sinusoid", "parameters": {{ "f_hz": 230, "amplitude": 0.5 }} }},
                   {{ "effect": "stale", "parameters": {{ "share": {share} }} }}"#
            );
            // Each of about the same size at one sample.
            let axis = trial::axis(r#""N": 0.02, "K": 20, "Q": 4e-4"#, &effects);
            trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 3, 8, 30]);
        }
    }
}
