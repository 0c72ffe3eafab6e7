//! A wandering line: a tone of constant size whose frequency moves, with its harmonics.

mod tone;

use std::f64::consts::TAU;

use rand_distr::{Distribution, Uniform};

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::random::{self, Gaussian, Generator};
use super::wander::{Phase, Wander};
use super::{Seed, Term};
use crate::numeric::peak::Peak;
use tone::Tone;

/// `sum_k A_k cos(k phi + phase_k)`, where `phi` is the integral of one frequency that [wanders](Wander).
#[derive(Debug, Clone, PartialEq)]
pub struct WanderingLine {
    /// Mean frequency of the base, hertz.
    pub f_hz: f64,
    /// How the base wanders; its multiples do as many times as far.
    pub wander: Wander,
    /// Amplitudes (half of peak to peak) of the base, twice the base and so on, unit of the signal; zero for those
    /// that are not there.
    pub amplitudes: Vec<f64>,
}

/// Width over frequency below which a filter acts on a line as on its middle, as for a resonance.
const NARROW: f64 = 0.05;

impl WanderingLine {
    /// The lines that are there.
    fn tones(&self) -> impl Iterator<Item = Tone> {
        let numbered = (1_u32..).zip(&self.amplitudes);
        let there = numbered.filter(|&(_, &amplitude)| amplitude != 0.0);
        there.map(|(number, &amplitude)| Tone {
            f_hz: f64::from(number) * self.f_hz,
            wander: self.wander.times(number),
            power: 0.5 * amplitude.powi(2),
        })
    }
}

impl Term for WanderingLine {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        self.tones()
            .map(|tone| tone.allan_variance(m, rate_hz))
            .sum()
    }

    fn peaks(&self) -> Vec<Peak> {
        let peak = |tone: Tone| Peak {
            f_hz: tone.f_hz,
            half_width_hz: tone.wander.half_width_hz(),
        };
        self.tones().map(peak).collect()
    }

    fn narrow_peaks(&self, m: u64, rate_hz: f64) -> Option<Vec<(f64, f64)>> {
        let is_narrow = |tone: Tone| 2.0 * tone.wander.half_width_hz() < NARROW * tone.f_hz;
        let peak = |tone: Tone| (tone.f_hz, tone.allan_variance(m, rate_hz));
        self.tones()
            .all(is_narrow)
            .then(|| self.tones().map(peak).collect())
    }

    fn shaped_by(&self, record_s: f64) -> f64 {
        self.wander.shaped_by(record_s)
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        // Long averages see what is left at zero frequency, white.
        self.spectrum_ahead(0.0, 0.0) / tau_s
    }

    fn spectrum(&self, f_hz: f64, rate_hz: f64) -> f64 {
        self.tones().map(|tone| tone.sampled(f_hz, rate_hz)).sum()
    }

    fn spectrum_ahead(&self, f_hz: f64, _rate_hz: f64) -> f64 {
        self.tones().map(|tone| tone.density(f_hz)).sum()
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let mut random = random::random(seed);
        let turn = Uniform::new(0.0, 1.0).expect("the bounds are in order");
        let starts = self.amplitudes.iter().map(|_| turn.sample(&mut random));
        let numbered = (1_u32..).zip(self.amplitudes.iter().copied()).zip(starts);
        let lines = numbered
            .map(|((number, amplitude), start)| (f64::from(number), amplitude, start))
            .filter(|(_, amplitude, _)| *amplitude != 0.0)
            .collect();
        let noise = Gaussian::of(random, 1.0);
        Box::new(Wandering {
            lines,
            phase: Phase::new(self.f_hz, self.wander, rate_hz, noise),
        })
    }
}

struct Wandering {
    /// Number, amplitude and phase at the start of each line, turns.
    lines: Vec<(f64, f64, f64)>,
    phase: Phase,
}

impl Generator for Wandering {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            let turns = self.phase.next();
            for (number, amplitude, start) in &self.lines {
                *sample += amplitude * (TAU * (number * turns + start).fract()).cos();
            }
        }
    }
}

/// The wandering line in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

/// Place of the first amplitude among the values.
pub const FIRST_AMPLITUDE: usize = 3;

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "wandering_line"
    }

    fn meaning(&self) -> &'static str {
        "a tone of steady size whose frequency moves: a motor, a fan or a pump under a changing load, a clock that \
         drifts against the samples', a dither"
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let lines = values.len().saturating_sub(FIRST_AMPLITUDE).max(1);
        let frequency = [
            Parameter::new("f_hz", Quantity::Hertz, "mean frequency"),
            Parameter::new(
                "wander_hz",
                Quantity::Hertz,
                "root mean square of the frequency about its mean",
            ),
            Parameter::new(
                "wander_s",
                Quantity::Second,
                "correlation time of the frequency",
            ),
        ];
        let amplitude = |number| {
            Parameter::new(
                "amplitude",
                Quantity::Signal,
                "half of peak to peak at this multiple of the frequency",
            )
            .in_row(number)
        };
        frequency
            .into_iter()
            .chain((1..=lines).map(amplitude))
            .collect()
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "look for what turns {:.5} times a second and does not keep its speed to {:.2} %: switch motors, fans and \
             pumps off one by one; change the data rate: an alias moves",
            values[0],
            100.0 * values[1] / values[0]
        )
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        let line = line_of(values);
        let tones = line.tones().zip(1..).flat_map(|(tone, multiple)| {
            let (f_hz, reach_hz) = (tone.f_hz, tone.wander.reach_hz());
            [
                Mark::Line { f_hz, multiple },
                Mark::Band((f_hz - reach_hz).max(0.5 * f_hz), f_hz + reach_hz),
            ]
        });
        tones.collect()
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(line_of(values)))
    }
}

/// The line with these values.
pub fn line_of(values: &[f64]) -> WanderingLine {
    WanderingLine {
        f_hz: values[0],
        wander: Wander {
            rms_hz: values[1],
            time_s: values[2],
        },
        amplitudes: values[FIRST_AMPLITUDE..].to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{kernel, trial};

    fn effect(f_hz: f64, wander_hz: f64, wander_s: f64, second: f64) -> String {
        format!(
            r#"{{ "effect": "wandering_line", "parameters": {{ "f_hz": {f_hz}, "wander_hz": {wander_hz},
                "wander_s": {wander_s}, "amplitude_1": 2, "amplitude_2": {second} }} }}"#
        )
    }

    #[test]
    fn data_have_its_allan_variance() {
        // Slow and fast wandering, near zero and near half the rate; 4096 samples hold 40 correlation times or more.
        for (f_hz, wander_hz, wander_s) in [
            (40.0, 2.0, 0.1),
            (200.0, 5.0, 0.05),
            (120.0, 1.0, 0.02),
            (230.0, 30.0, 0.01),
        ] {
            let axis = trial::axis(r#""N": 0.001"#, &effect(f_hz, wander_hz, wander_s, 0.5));
            trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 3, 5, 12, 50, 300]);
        }
    }

    #[test]
    fn its_density_holds_all_of_its_power() {
        for (f_hz, wander_hz, wander_s) in
            [(40.0, 2.0, 0.1), (300.0, 0.1, 20.0), (200.0, 30.0, 0.001)]
        {
            let line = WanderingLine {
                f_hz,
                wander: Wander {
                    rms_hz: wander_hz,
                    time_s: wander_s,
                },
                amplitudes: vec![2.0],
            };
            let width = |f: f64| (0.1 * (f - f_hz).abs()).max(0.2 * line.wander.half_width_hz());
            let power = 2.0 * kernel::panels(0.0, 500.0, width, |f| line.spectrum(f, 1000.0));
            // What folds back more than once is left out: some parts in a thousand of the fastest.
            assert!((power / 2.0 - 1.0).abs() < 1e-2, "{f_hz} Hz: {power}");
        }
    }

    #[test]
    fn a_harmonic_keeps_step_with_its_base() {
        // cos(2 phi + a) and cos(phi + b)^2 wander alike: their product has a mean that is the same throughout.
        let axis = trial::axis("", &effect(50.0, 3.0, 0.5, 1.5));
        let samples = trial::record(&axis, 1000.0, 1 << 15, 3, 512);
        let third = |part: &[f64]| part.iter().map(|x| x.powi(3)).sum::<f64>() / part.len() as f64;
        let whole = third(&samples);
        assert!(whole.abs() > 0.1, "seed 3: {whole}");
        for part in samples.chunks(1 << 13) {
            let own = third(part);
            assert!((own / whole - 1.0).abs() < 0.2, "seed 3: {own} for {whole}");
        }
    }
}
