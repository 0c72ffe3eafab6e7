//! A sensor on which something acts that its noise model does not know.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use inm_emulator::Signal;
use inm_emulator::channel::Channel;
use inm_emulator::filter::DECIMATION;
use inm_emulator::sensor::GRAVITY_M_S2;

use super::turned::Turned;
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

/// Pins from the board to its sensors.
#[derive(Debug, Default)]
pub(super) struct Pins {
    /// Whether the board drives the self-test pin.
    pub(super) self_test: AtomicBool,
    /// Whether it selects the coarse range.
    pub(super) coarse: AtomicBool,
}

/// A channel, and what acts on its sensing element: held for a conversion, as the channel's own
/// slow terms are, so that a line keeps its height within 1 % up to a twelfth of the data rate.
pub struct Shaken {
    /// On the fine and on the coarse range.
    ranges: [OnRange; 2],
    /// The one that is selected.
    range: usize,
    /// Inputs left of the conversion under way.
    left: usize,
    outside: Option<Outside>,
    pins: Arc<Pins>,
    /// What the sensing element moves by while its self-test pin is driven, m/s^2.
    self_test_m_s2: f64,
    block: Option<(Turned, usize)>,
}

/// A sensor on one of its ranges.
struct OnRange {
    channel: Channel,
    /// 2^-32 steps of the code in 1 m/s^2.
    scale: f64,
}

struct Outside {
    hidden: Hidden,
    generator: Option<Box<dyn Generator>>,
    ready: Vec<f64>,
}

impl Shaken {
    /// The channels of a sensor on its fine and its coarse range with the steps of the code in 1 m/s^2,
    /// and what acts on it; both pins are low.
    pub fn new(ranges: [(Channel, f64); 2], hidden: Option<&Hidden>) -> Self {
        Self {
            ranges: ranges.map(|(channel, steps_per_m_s2)| OnRange {
                channel,
                scale: steps_per_m_s2 * FRACTION,
            }),
            range: 0,
            left: 0,
            pins: Arc::default(),
            self_test_m_s2: 0.0,
            block: None,
            outside: hidden.map(|hidden| Outside {
                hidden: hidden.clone(),
                generator: None,
                ready: Vec::new(),
            }),
        }
    }

    /// The same at these pins, where the sensing element moves by `step_g` in the self-test.
    #[must_use]
    pub(super) fn at(mut self, pins: &Arc<Pins>, step_g: f64) -> Self {
        self.pins = Arc::clone(pins);
        self.self_test_m_s2 = step_g * GRAVITY_M_S2;
        self
    }

    /// The same as the sensor of `axis` on a block that is turned.
    #[must_use]
    pub(super) fn on(mut self, block: Turned, axis: usize) -> Self {
        self.block = Some((block, axis));
        self
    }

    fn act(&mut self) {
        self.range = usize::from(self.pins.coarse.load(Ordering::Relaxed));
        let OnRange { channel, scale } = &mut self.ranges[self.range];
        let driven = self.pins.self_test.load(Ordering::Relaxed);
        let parts = [
            self.outside.as_mut().map_or(0.0, Outside::next),
            if driven { self.self_test_m_s2 } else { 0.0 },
            self.block
                .as_ref()
                .map_or(0.0, |(block, axis)| block.along(*axis)),
        ];
        channel.act(parts.map(|part| (*scale * part) as i64).iter().sum());
        if let Some((block, axis)) = &self.block {
            block.note(*axis, channel.wandered() as f64 / FRACTION);
        }
    }

    fn channel(&mut self) -> &mut Channel {
        &mut self.ranges[self.range].channel
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
            Part::Distortion(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => None,
        };
    }

    /// The next acceleration, m/s^2.
    fn next(&mut self) -> f64 {
        if self.ready.is_empty() {
            self.ready.resize(BLOCK, 0.0);
            if let Some(generator) = &mut self.generator {
                generator.add_to(&mut self.ready);
            }
            self.ready.reverse();
        }
        self.ready.pop().unwrap_or(0.0)
    }
}

impl Signal for Shaken {
    fn set_rate(&mut self, input_hz: u32) {
        for range in &mut self.ranges {
            range.channel.set_rate(input_hz);
        }
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
        self.channel().next()
    }

    fn fill(&mut self, inputs: &mut [i32; DECIMATION]) {
        if self.left > 0 {
            inputs.fill_with(|| self.next());
            return;
        }
        self.act();
        self.channel().fill(inputs);
    }
}

#[cfg(test)]
mod tests {
    use inm_emulator::channel;
    use inm_emulator::sensor::Sensor;

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
        let [mut quiet, mut shaken] = [None, Some(&hidden)].map(|one| {
            let range = (channel::published(0, 3), sensor.steps_per_m_s2());
            Shaken::new([range.clone(), range], one)
        });
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
