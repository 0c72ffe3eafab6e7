//! Hum: lines at multiples of one frequency, such as the mains and its harmonics.
//!
//! Mains keep their frequency to some 20 mHz: where a record is long enough to see that, the lines wander together
//! ([`WanderingLine`]).

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::random::{self, Generator};
use super::sinusoid::ALLAN_PEAK;
use super::sinusoid::{Oscillator, Sinusoid};
use super::wandering_line;
use super::{Line, Seed, Term};

/// Sinusoids at multiples of a frequency, each with a phase of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Hum {
    /// Base frequency, hertz.
    pub f_hz: f64,
    /// Amplitudes of the base, twice the base and so on, unit of the signal; zero for those that
    /// are not there.
    pub amplitudes: Vec<f64>,
}

impl Hum {
    /// The lines that are there.
    fn tones(&self) -> impl Iterator<Item = Sinusoid> {
        let tone = |(number, &amplitude): (u32, &f64)| Sinusoid {
            f_hz: f64::from(number) * self.f_hz,
            amplitude,
        };
        (1..)
            .zip(&self.amplitudes)
            .filter(|&(_, &amplitude)| amplitude != 0.0)
            .map(tone)
    }
}

impl Term for Hum {
    /// The sum of the lines': their products average out.
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        self.tones()
            .map(|tone| tone.allan_variance(m, rate_hz))
            .sum()
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        self.tones().map(|tone| tone.allan_asymptote(tau_s)).sum()
    }

    fn spectrum(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    fn spectrum_ahead(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    fn lines(&self) -> Vec<Line> {
        self.tones().flat_map(|tone| tone.lines()).collect()
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let mut random = random::random(seed);
        let tones = self.tones();
        Box::new(Chord(
            tones
                .map(|tone| tone.oscillator(rate_hz, &mut random))
                .collect(),
        ))
    }
}

struct Chord(Vec<Oscillator>);

impl Generator for Chord {
    fn add_to(&mut self, samples: &mut [f64]) {
        self.0.iter_mut().for_each(|tone| tone.add_to(samples));
    }
}

/// Frequency below which lines at its multiples are no mains and no machine, but what is switched: a choice.
const SLOW_HZ: f64 = 0.2;

/// Hum in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

/// Place of the first amplitude among the values: that of a wandering line, whose law it has where it wanders.
pub const FIRST_AMPLITUDE: usize = wandering_line::FIRST_AMPLITUDE;

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "hum"
    }

    fn meaning(&self) -> &'static str {
        "lines at multiples of one frequency: the mains, through the supply, the sensor's leads or \
         a transformer that shakes the bench; slow ones, what is switched in turns, such as a heater"
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let harmonics = values.len().saturating_sub(FIRST_AMPLITUDE).max(1);
        let frequency = [
            Parameter::new("f_hz", Quantity::Hertz, "base frequency"),
            Parameter::new(
                "wander_hz",
                Quantity::Wander,
                "root mean square of the base frequency about its mean; zero if steady",
            )
            .or_zero(),
            Parameter::new(
                "wander_s",
                Quantity::Delay,
                "correlation time of the base frequency; zero if steady",
            )
            .or_zero(),
        ];
        let amplitude = |number| {
            Parameter::new(
                "amplitude",
                Quantity::Signal,
                "half of peak to peak at this multiple of the base",
            )
            .in_row(number)
        };
        frequency
            .into_iter()
            .chain((1..=harmonics).map(amplitude))
            .collect()
    }

    fn check(&self, values: &[f64]) -> String {
        let (number, _) = (1_u32..)
            .zip(&values[FIRST_AMPLITUDE..])
            .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
            .expect("at least one harmonic");
        if values[0] < SLOW_HZ {
            return format!(
                "look for what comes every {:.4} s: a heater with a thermostat, an air conditioner, a pump; record the \
                 temperature with it, for what follows it goes with that",
                1.0 / values[0]
            );
        }
        format!(
            "run the board from a battery, then move it away from transformers: what goes came \
             through the supply, or over the air; of the multiples of {:.4} Hz look for number \
             {number} at {:.4} Hz, the strongest",
            values[0],
            f64::from(number) * values[0]
        )
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let numbered = (1_u32..).zip(&values[FIRST_AMPLITUDE..]);
        let there = numbered.filter(|(_, amplitude)| **amplitude != 0.0);
        let lines = there.map(|(multiple, _)| Mark::Line {
            f_hz: values[0] * f64::from(multiple),
            multiple,
        });
        let peak = Mark::AveragingTime(ALLAN_PEAK / values[0]);
        lines.chain([peak]).collect()
    }

    fn part(&self, values: &[f64]) -> Part {
        if values[1] > 0.0 && values[2] > 0.0 {
            return Part::Term(Box::new(wandering_line::line_of(values)));
        }
        Part::Term(Box::new(Hum {
            f_hz: values[0],
            amplitudes: values[FIRST_AMPLITUDE..].to_vec(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::model::trial;

    #[test]
    fn has_its_amplitudes_and_nothing_else() {
        let hum = r#"{ "effect": "hum",
            "parameters": { "f_hz": 50, "amplitude_1": 3, "amplitude_2": 0, "amplitude_3": 0.5 } }"#;
        // Whole periods of all multiples: the sums are exact.
        let (rate_hz, count) = (2000.0, 4000);
        let samples = trial::record(&trial::axis("", hum), rate_hz, count, 7, 512);
        for f_hz in [25.0, 50.0, 100.0, 150.0, 200.0] {
            let (mut cosine, mut sine) = (0.0, 0.0);
            for (index, sample) in (0..).zip(&samples) {
                let phase = TAU * f_hz * f64::from(index) / rate_hz;
                cosine += sample * phase.cos();
                sine += sample * phase.sin();
            }
            let found = 2.0 * f64::hypot(cosine, sine) / count as f64;
            let expected = match f_hz {
                50.0 => 3.0,
                150.0 => 0.5,
                _ => 0.0,
            };
            assert!(
                (found - expected).abs() < 1e-10,
                "{f_hz} Hz: {found} for {expected}"
            );
        }
    }

    #[test]
    fn has_its_allan_variance() {
        let hum = Hum {
            f_hz: 10.0,
            amplitudes: vec![3.0, 0.0, 1.0, 2.0],
        };
        // Over whole periods the sum is exact, whatever the phases.
        let (rate_hz, count) = (100.0, 1000);
        for m in [1, 2, 3, 7, 40] {
            let mut samples = vec![0.0; count + 2 * m];
            let seed = Seed { seed: 5, stream: 0 };
            hum.generator(rate_hz, seed).add_to(&mut samples);
            let measured = trial::allan_variance(&samples[..count + 2 * m - 1], m);
            let expected = hum.allan_variance(m as u64, rate_hz);
            assert!(
                (measured - expected).abs() < 1e-9,
                "m = {m}: {measured} for {expected}"
            );
        }
    }

    #[test]
    fn how_it_wanders_may_be_left_out() {
        let of = |wander: &str| {
            let hum = format!(
                r#"{{ "effect": "hum",
                    "parameters": {{ "f_hz": 50, {wander} "amplitude_1": 3, "amplitude_2": 1 }} }}"#
            );
            trial::axis("", &hum)
        };
        let (old, steady) = (of(""), of(r#""wander_hz": 0, "wander_s": 0,"#));
        assert_eq!(old, steady);
        assert_eq!(old.law(1000.0).lines().len(), 2);
        let wandering = of(r#""wander_hz": 0.5, "wander_s": 0.2,"#);
        assert_eq!(wandering.law(1000.0).lines(), []);
        trial::assert_allan_variance(&wandering, 1000.0, &[1, 3, 20, 200]);
    }

    #[test]
    fn multiples_from_half_the_rate_on_are_refused() {
        let text = r#"{ "schema": 1, "rate_hz": 200, "axes": [ { "name": "X", "effects": [
            { "effect": "hum",
              "parameters": { "f_hz": 50, "amplitude_1": 1, "amplitude_2": 1 } } ] } ] }"#;
        let error = crate::model::whole::Model::from_json(text).expect_err("100 Hz of 200/s");
        assert!(
            error.contains("100 Hz is not below half the rate"),
            "{error}"
        );
    }
}
