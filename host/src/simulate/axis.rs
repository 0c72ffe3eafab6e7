//! One simulated axis: terms, signal chain, distortions.

use std::sync::Arc;

use super::shaping::{Shape, Shaper};
use crate::model::axis::ModelAxis;
use crate::model::effect::{Distorter, Part, Stage};
use crate::model::follows::{Follower, Leader};
use crate::model::random::Generator;
use crate::model::{Coefficient, Seed, Term};

/// Samples that are made at a time. Distorters see these blocks and no others, so that the data
/// do not depend on how they are asked for.
const BLOCK: usize = 4096;

/// Streams of random numbers that an axis reserves for its coefficients.
const STREAMS_PER_AXIS: u64 = 64;

/// First stream of the effects of an axis, and how many it reserves for them.
const EFFECT_STREAMS: u64 = 1 << 32;
const EFFECTS_PER_AXIS: u64 = 1 << 16;

/// Makes the samples of one axis.
pub struct AxisSimulation {
    generators: Vec<Box<dyn Generator>>,
    /// What happens to the noise ahead of the level.
    louder: Vec<Box<dyn Distorter>>,
    /// The level's course, which joins it behind that.
    joining: Vec<Box<dyn Generator>>,
    distorters: Vec<Box<dyn Distorter>>,
    followers: Vec<Follower>,
    temperature: Arc<[f64]>,
    mean: f64,
    /// Values made so far.
    made: usize,
    ready: Vec<f64>,
    /// How values become samples, where each is written until there is the next.
    hold: Option<Hold>,
}

/// The writing of values that come more rarely than samples.
struct Hold {
    /// Values a sample, below 1.
    values: f64,
    /// Samples written, and values taken for them.
    written: u64,
    taken: u64,
    latest: f64,
}

impl Hold {
    /// How many more values the next `count` samples take.
    fn needs(&self, count: usize) -> usize {
        let last = self.written + count as u64;
        let of = last
            .checked_sub(1)
            .map_or(0, |sample| self.number(sample) + 1);
        of.saturating_sub(self.taken) as usize
    }

    /// Number of the value that a sample shows.
    fn number(&self, sample: u64) -> u64 {
        (sample as f64 * self.values) as u64
    }

    /// The next `count` samples, of these values.
    fn write(&mut self, values: Vec<f64>, count: usize) -> Vec<f64> {
        let mut values = values.into_iter();
        let sample = |_| {
            while self.taken <= self.number(self.written) {
                self.taken += 1;
                self.latest = values.next().unwrap_or(self.latest);
            }
            self.written += 1;
            self.latest
        };
        (0..count).map(sample).collect()
    }
}

impl AxisSimulation {
    /// Axis `index` of a model at a nominal `rate_hz`, without what follows a leader. `mixing`
    /// weighs the random numbers of the axes up to this one.
    pub fn new(axis: &ModelAxis, index: u64, mixing: &[f64], rate_hz: f64, seed: u64) -> Self {
        let values = axis.values_hz(rate_hz) / rate_hz;
        let rate_hz = axis.clock() * axis.values_hz(rate_hz);
        let mut parts = Parts::new(axis, rate_hz);
        parts.add_coefficients(axis, mixing, seed);
        let mut joining = Parts::new(axis, rate_hz);
        let ramp = axis.coefficients.r;
        if ramp != 0.0 {
            // Nothing random is in it.
            let stream = Seed { seed, stream: 0 };
            joining.add(&*Coefficient::R.term(ramp), stream);
        }
        let (mut louder, mut distorters): (Vec<_>, Vec<_>) = Default::default();
        for (effect_index, effect) in (0..).zip(&axis.effects) {
            let stream = Seed {
                seed,
                stream: EFFECT_STREAMS + index * EFFECTS_PER_AXIS + effect_index,
            };
            match effect.part() {
                Part::Term(term) if term.is_once() => joining.add(&*term, stream),
                Part::Term(term) => parts.add(&*term, stream),
                Part::Distortion(one) => {
                    let is_first = one.stage() <= Stage::Noise && distorters.is_empty();
                    let all = if is_first {
                        &mut louder
                    } else {
                        &mut distorters
                    };
                    all.push(one.distorter(rate_hz, stream));
                }
                // Clock and hold are in the rate. What follows something needs a leader.
                Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => {}
            }
        }
        Self {
            generators: parts.generators(),
            louder,
            joining: joining.generators(),
            distorters,
            followers: Vec::new(),
            temperature: Arc::default(),
            mean: axis.mean,
            made: 0,
            ready: Vec::new(),
            hold: (values < 1.0).then_some(Hold {
                values,
                written: 0,
                taken: 0,
                latest: 0.0,
            }),
        }
    }

    /// Makes what follows the temperature in `axis` follow this one, a value a sample: about its mean,
    /// at which the axis has its own.
    pub fn follow(&mut self, axis: &ModelAxis, rate_hz: f64, temperature: &Arc<[f64]>) {
        let mean = temperature.iter().sum::<f64>() / temperature.len().max(1) as f64;
        let follower = |part: Part| match part {
            Part::Follows(follows) if follows.leader == Leader::Temperature => {
                Some(follows.follower(axis.values_hz(rate_hz), mean))
            }
            _ => None,
        };
        let parts = axis.effects.iter().map(|effect| effect.part());
        self.followers = parts.filter_map(follower).collect();
        self.temperature = match &self.hold {
            None => Arc::clone(temperature),
            // As it is when each value comes.
            Some(hold) => {
                let sample = |value: usize| (value as f64 / hold.values).ceil() as usize;
                let at = (0..).map_while(|value| temperature.get(sample(value)).copied());
                at.collect()
            }
        };
    }

    /// The next `count` samples.
    pub fn next(&mut self, count: usize) -> Vec<f64> {
        let Some(needs) = self.hold.as_ref().map(|hold| hold.needs(count)) else {
            return self.next_values(count);
        };
        let values = self.next_values(needs);
        match &mut self.hold {
            Some(hold) => hold.write(values, count),
            None => values,
        }
    }

    /// The next `count` values of the sensor.
    fn next_values(&mut self, count: usize) -> Vec<f64> {
        while self.ready.len() < count {
            let mut block = vec![0.0; BLOCK];
            for generator in &mut self.generators {
                generator.add_to(&mut block);
            }
            let left = &self.temperature[self.made.min(self.temperature.len())..];
            for follower in &mut self.followers {
                follower.add_to(left, &mut block);
            }
            self.made += BLOCK;
            for distorter in &mut self.louder {
                distorter.apply(&mut block);
            }
            block.iter_mut().for_each(|value| *value += self.mean);
            for generator in &mut self.joining {
                generator.add_to(&mut block);
            }
            for distorter in &mut self.distorters {
                distorter.apply(&mut block);
            }
            self.ready.append(&mut block);
        }
        let rest = self.ready.split_off(count);
        std::mem::replace(&mut self.ready, rest)
    }
}

/// Generators, those with the same shape together.
struct Parts<'a> {
    rate_hz: f64,
    shaper: Option<Shaper<'a>>,
    plain: Vec<Box<dyn Generator>>,
    shaped: Vec<(Shape, Vec<Box<dyn Generator>>)>,
}

impl<'a> Parts<'a> {
    fn new(axis: &'a ModelAxis, rate_hz: f64) -> Self {
        Self {
            rate_hz,
            shaper: axis.chain.as_ref().map(|chain| Shaper::new(chain, rate_hz)),
            plain: Vec::new(),
            shaped: Vec::new(),
        }
    }

    /// The coefficients of an axis; `mixing` weighs the random numbers of the axes up to it.
    fn add_coefficients(&mut self, axis: &ModelAxis, mixing: &[f64], seed: u64) {
        for (term_index, coefficient) in (0..).zip(Coefficient::ALL) {
            let value = *axis.coefficients.get(coefficient);
            // The ramp is part of the level, not of the noise.
            if value == 0.0 || coefficient == Coefficient::R {
                continue;
            }
            let stream = |source: u64| Seed {
                seed,
                stream: source * STREAMS_PER_AXIS + term_index,
            };
            // Every term is linear in its random numbers: weights on them are weights on it.
            for (source, weight) in (0..).zip(mixing).filter(|(_, weight)| **weight != 0.0) {
                let term = coefficient.term(value * weight);
                self.add(&*term, stream(source));
            }
        }
    }

    fn add(&mut self, term: &dyn Term, seed: Seed) {
        let generator = term.generator(self.rate_hz, seed);
        let Some(shaper) = self.shaper.as_ref().filter(|_| !term.is_drift()) else {
            self.plain.push(generator);
            return;
        };
        let shape = shaper.shape(term);
        match self.shaped.iter_mut().find(|(known, _)| *known == shape) {
            Some((_, generators)) => generators.push(generator),
            None => self.shaped.push((shape, vec![generator])),
        }
    }

    fn generators(self) -> Vec<Box<dyn Generator>> {
        let shaped = self
            .shaped
            .into_iter()
            .map(|(shape, generators)| shape.shaped(generators));
        self.plain.into_iter().chain(shaped).collect()
    }
}
