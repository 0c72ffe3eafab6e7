//! The MMA7331L channel: sensor, noise and pole as a converter sees them.
//!
//! ```text
//! gravity, zero-g error ─┐
//! R ramp, K walk, B flicker (once a conversion) ─┤
//! N white, Q differenced white (every input) ────┴─> one pole (400 Hz X, Y; 300 Hz Z) ─> rails ─> converter
//! ```
//!
//! The noise enters at the sensing element, ahead of the sensor's own filter: what is published
//! about a sensor is referred to acceleration, and the filter shapes noise and signal alike. The
//! slow terms are held for the 32 inputs of a conversion; what that does to their spectra near
//! the data rate lies more than 60 dB below the white terms.

use crate::{
    Signal,
    filter::DECIMATION,
    flicker::Flicker,
    plan::{FAST_FRACTION, Plan, RatePlan, SLOW_FRACTION},
    random::Random,
    sensor::{Sensor, Unfit},
};

/// The published axes, worked out by the compiler.
const PUBLISHED: [Plan; 3] = {
    let [x, y, z] = Sensor::PUBLISHED;
    [fit(&x), fit(&y), fit(&z)]
};

/// A plan that is known to fit when the program is compiled.
const fn fit(sensor: &Sensor) -> Plan {
    match Plan::new(sensor) {
        Ok(plan) => plan,
        Err(_) => panic!("the published axes fit"),
    }
}

/// Axis 0, 1 or 2 (X, Y, Z) of the published experiment; any other is Z. Without floating point.
pub fn published(axis: usize, seed: u64) -> Channel {
    Channel::from_plan(PUBLISHED[axis.min(2)].clone(), seed, axis as u64)
}

/// One axis of an MMA7331L as a [`Signal`].
#[derive(Debug, Clone)]
pub struct Channel {
    plan: Plan,
    rate: RatePlan,
    fast: Random,
    slow: Random,
    /// Inputs left of the conversion under way.
    left: usize,
    /// Ramp and walk, and the level they add up to with everything else that is slow.
    ramp: i64,
    walk: i64,
    flicker: Flicker,
    /// What acts on the sensing element beside gravity, 2^-32 steps.
    outside: i64,
    /// Level ahead of the pole, steps.
    level: i64,
    /// State of the pole, 2^-20 steps.
    output: i64,
    /// Last velocity noise.
    velocity: i64,
}

impl Channel {
    /// The channel of `sensor`; equal seeds give equal noise on equal axes, and `axis` keeps the
    /// axes apart.
    ///
    /// # Errors
    ///
    /// [`Unfit`] if a parameter is no sensible number or the output would leave the 32-bit codes.
    pub fn new(sensor: &Sensor, seed: u64, axis: u64) -> Result<Self, Unfit> {
        Plan::new(sensor).map(|plan| Self::from_plan(plan, seed, axis))
    }

    fn from_plan(plan: Plan, seed: u64, axis: u64) -> Self {
        let fast = Random::new(seed, 2 * axis);
        let mut slow = Random::new(seed, 2 * axis + 1);
        let flicker = Flicker::new(plan.flicker_sigma, &mut slow);
        let level = plan.rest >> SLOW_FRACTION;
        Self {
            rate: plan.rates[2],
            plan,
            fast,
            slow,
            left: 0,
            ramp: 0,
            walk: 0,
            flicker,
            outside: 0,
            level,
            output: level << FAST_FRACTION,
            velocity: 255,
        }
    }

    /// Lets an acceleration act on the sensing element from the next conversion on, beside gravity
    /// and in the same way: in 2^-32 steps of the code ([`Sensor::steps_per_m_s2`]).
    pub fn act(&mut self, acceleration: i64) {
        self.outside = acceleration;
    }

    /// How far the zero has wandered since the channel was built, ramp and walk together: in 2^-32 steps
    /// of the code. For who calibrates, the truth of this moment.
    pub fn wandered(&self) -> i64 {
        self.ramp.saturating_add(self.walk)
    }

    /// The slow terms of the next conversion.
    fn step_slow(&mut self) {
        self.left = DECIMATION;
        self.ramp = self.ramp.saturating_add(self.rate.ramp);
        let step = self.rate.walk * i64::from(self.slow.gauss());
        self.walk = self.walk.saturating_add(step);
        let flicker = self.flicker.next(self.plan.flicker_step, &mut self.slow);
        let sum = self
            .plan
            .rest
            .saturating_add(self.ramp)
            .saturating_add(self.walk)
            .saturating_add(flicker)
            .saturating_add(self.outside);
        self.level = sum >> SLOW_FRACTION;
    }

    /// White terms, pole and rails: one input.
    fn step_fast(&mut self) -> i32 {
        // Two sums of two bytes: triangular, which the 32 and more inputs in a word make normal.
        let [a, b, c, d] = self.fast.next().to_le_bytes().map(i64::from);
        let white = a + b - 255;
        let velocity = c + d;
        let change = velocity - self.velocity;
        self.velocity = velocity;
        let error = self.level - (self.output >> FAST_FRACTION);
        self.output +=
            self.rate.pole * error + self.rate.white * white + self.rate.velocity * change;
        let steps = self.output >> FAST_FRACTION;
        steps.clamp(i64::from(self.plan.lowest), i64::from(self.plan.highest)) as i32
    }
}

impl Signal for Channel {
    /// Inputs come at 32 times one of the converter's data rates; any other leaves the channel as
    /// it is.
    fn set_rate(&mut self, input_hz: u32) {
        if let Some(&rate) = self
            .plan
            .rates
            .iter()
            .find(|rate| rate.input_hz == input_hz)
        {
            self.rate = rate;
        }
    }

    fn next(&mut self) -> i32 {
        if self.left == 0 {
            self.step_slow();
        }
        self.left -= 1;
        self.step_fast()
    }

    fn fill(&mut self, inputs: &mut [i32; DECIMATION]) {
        if self.left > 0 {
            inputs.fill_with(|| self.next());
            return;
        }
        self.step_slow();
        self.left = 0;
        inputs.fill_with(|| self.step_fast());
    }
}
