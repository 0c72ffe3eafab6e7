//! A sensor on which something acts that its noise model does not know.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use inm_emulator::Signal;
use inm_emulator::channel::Channel;
use inm_emulator::filter::DECIMATION;
use inm_emulator::sensor::{GRAVITY_M_S2, Sensor};

use crate::model::Seed;
use crate::model::axis::ModelEffect;
use crate::model::effect::Part;
use crate::model::random::Generator;

/// Accelerations that are made at a time.
const BLOCK: usize = 1024;

/// Stream of random numbers, another than those of simulated records.
const STREAM: u64 = 1 << 48;

/// Fraction bits of the channel's level.
const FRACTION: f64 = (1_u64 << 32) as f64;

/// What acts on a sensor.
#[derive(Debug, Clone)]
pub struct Hidden {
    /// Axis: 0, 1 or 2.
    pub axis: usize,
    /// An effect that adds to the signal, in m/s^2.
    pub effect: ModelEffect,
    /// Seed of its random numbers.
    pub seed: u64,
}

/// A channel, and what acts on its sensing element: held for a conversion, as the channel's own
/// slow terms are, so that a line keeps its height within 1 % up to a twelfth of the data rate.
pub struct Shaken {
    channel: Channel,
    /// Inputs left of the conversion under way.
    left: usize,
    outside: Option<Outside>,
    /// Whether the board drives the sensors' self-test pin.
    pin: Arc<AtomicBool>,
    /// What the sensing element moves by then, 2^-32 steps of the code.
    self_test: i64,
}

struct Outside {
    hidden: Hidden,
    /// 2^-32 steps of the code in 1 m/s^2.
    scale: f64,
    generator: Option<Box<dyn Generator>>,
    ready: Vec<f64>,
}

impl Shaken {
    /// The channel of `sensor`, and what acts on it; its self-test pin is low.
    pub fn new(channel: Channel, sensor: &Sensor, hidden: Option<&Hidden>) -> Self {
        Self {
            channel,
            left: 0,
            pin: Arc::default(),
            self_test: 0,
            outside: hidden.map(|hidden| Outside {
                hidden: hidden.clone(),
                scale: sensor.steps_per_m_s2() * FRACTION,
                generator: None,
                ready: Vec::new(),
            }),
        }
    }

    /// The same, where `pin` is the self-test pin of `sensor`, which then moves by `step_g`.
    #[must_use]
    pub fn tested_by(mut self, pin: &Arc<AtomicBool>, sensor: &Sensor, step_g: f64) -> Self {
        self.pin = Arc::clone(pin);
        self.self_test = (step_g * GRAVITY_M_S2 * sensor.steps_per_m_s2() * FRACTION) as i64;
        self
    }

    fn act(&mut self) {
        let outside = self.outside.as_mut().map_or(0, Outside::next);
        let driven = self.pin.load(Ordering::Relaxed);
        let self_test = if driven { self.self_test } else { 0 };
        self.channel.act(outside + self_test);
    }
}

impl Outside {
    /// Begins at another data rate.
    fn set_rate(&mut self, rate_hz: f64) {
        let seed = Seed {
            seed: self.hidden.seed,
            stream: STREAM,
        };
        self.ready.clear();
        self.generator = match self.hidden.effect.part() {
            Part::Term(term) => Some(term.generator(rate_hz, seed)),
            // What is done to samples is no acceleration.
            Part::Distortion(_) | Part::Clock(_) | Part::Follows(_) => None,
        };
    }

    /// The next acceleration, 2^-32 steps of the code.
    fn next(&mut self) -> i64 {
        if self.ready.is_empty() {
            self.ready.resize(BLOCK, 0.0);
            if let Some(generator) = &mut self.generator {
                generator.add_to(&mut self.ready);
            }
            self.ready.reverse();
        }
        (self.scale * self.ready.pop().unwrap_or(0.0)) as i64
    }
}

impl Signal for Shaken {
    fn set_rate(&mut self, input_hz: u32) {
        self.channel.set_rate(input_hz);
        if let Some(outside) = &mut self.outside {
            outside.set_rate(f64::from(input_hz) / DECIMATION as f64);
        }
    }

    fn next(&mut self) -> i32 {
        if self.left == 0 {
            self.act();
            self.left = DECIMATION;
        }
        self.left -= 1;
        self.channel.next()
    }

    fn fill(&mut self, inputs: &mut [i32; DECIMATION]) {
        if self.left > 0 {
            inputs.fill_with(|| self.next());
            return;
        }
        self.act();
        self.channel.fill(inputs);
    }
}

#[cfg(test)]
mod tests {
    use inm_emulator::channel;

    use super::*;

    #[test]
    fn a_step_arrives_as_high_as_it_is() {
        let effect = serde_json::from_str::<ModelEffect>(
            r#"{ "effect": "steps", "parameters": { "time_s_1": 0.5, "height_1": 0.1 } }"#,
        )
        .expect("an effect");
        let hidden = Hidden {
            axis: 0,
            effect,
            seed: 1,
        };
        let sensor = &Sensor::PUBLISHED[0];
        let [mut quiet, mut shaken] =
            [None, Some(&hidden)].map(|one| Shaken::new(channel::published(0, 3), sensor, one));
        let mut inputs = [[0; DECIMATION]; 2];
        for sensor in [&mut quiet, &mut shaken] {
            sensor.set_rate(2000 * DECIMATION as u32);
        }
        for conversion in 0..2000 {
            quiet.fill(&mut inputs[0]);
            shaken.fill(&mut inputs[1]);
            let difference = f64::from(inputs[1][31] - inputs[0][31]);
            let expected = 0.1 * sensor.steps_per_m_s2();
            // The same noise in both; the pole has 9 ms to settle, rounding is a step each.
            match conversion {
                0..1000 => assert_eq!(difference, 0.0, "conversion {conversion}"),
                1020.. => assert!((difference - expected).abs() <= 2.0, "{difference}"),
                _ => {}
            }
        }
    }
}
