//! The integers that a sensor's channel runs on, for all data rates.
//!
//! The arithmetic here is plain `f64` without library functions: the same result on every machine,
//! and evaluated by the compiler for the published axes.

use crate::{
    filter::DECIMATION,
    flicker::{NEW_VARIANCE, POLE_VARIANCE},
    random::{GAUSS_VARIANCE, PAIR_VARIANCE},
    sensor::{Coefficients, Sensor, Unfit},
};

/// Distance of the sensor's output swing from either rail of its supply, volts.
const RAIL_MARGIN_V: f64 = 0.1;

/// Fraction bits of what is stepped once an input.
pub(crate) const FAST_FRACTION: u32 = 20;
/// Fraction bits of what is stepped once a conversion.
pub(crate) const SLOW_FRACTION: u32 = 32;

/// A sensor in integers, for all data rates.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    /// Level at rest, 2^-32 steps.
    pub(crate) rest: i64,
    /// The sensor's output swing, steps.
    pub(crate) lowest: i32,
    pub(crate) highest: i32,
    /// A flicker relaxation's level and step, 2^-32 steps over sigma of the generator.
    pub(crate) flicker_sigma: i64,
    pub(crate) flicker_step: i64,
    pub(crate) rates: [RatePlan; 5],
}

/// The part of a [`Plan`] that depends on the rate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RatePlan {
    pub(crate) input_hz: u32,
    /// Coefficient of the pole, 2^-20.
    pub(crate) pole: i64,
    /// White noise behind the pole's coefficient, 2^-20 steps over sigma of the generator.
    pub(crate) white: i64,
    /// As `white`, for the velocity noise that is differenced.
    pub(crate) velocity: i64,
    /// Step of the walk, 2^-32 steps over sigma of the generator.
    pub(crate) walk: i64,
    /// Change of the ramp, 2^-32 steps a conversion.
    pub(crate) ramp: i64,
}

impl Plan {
    /// Works the integers out.
    pub(crate) const fn new(sensor: &Sensor) -> Result<Self, Unfit> {
        if !are_possible(sensor) {
            return Err(Unfit::Number);
        }
        let per_volt = sensor.steps_per_volt();
        let lowest = (RAIL_MARGIN_V - sensor.ainn_v) * per_volt;
        let highest = (sensor.supply_v - RAIL_MARGIN_V - sensor.ainn_v) * per_volt;
        let flicker = sensor.noise.flicker;
        let relaxation = sqrt(POLE_VARIANCE / GAUSS_VARIANCE) * flicker * sensor.steps_per_m_s2();
        let mut plan = Self {
            rest: 0,
            lowest: 0,
            highest: 0,
            flicker_sigma: 0,
            flicker_step: 0,
            rates: [RatePlan::SILENT; 5],
        };
        if highest < lowest || !fits(&[sensor.rest_steps(), lowest, highest, relaxation]) {
            return Err(Unfit::Range);
        }
        plan.rest = fixed(sensor.rest_steps(), SLOW_FRACTION);
        plan.lowest = lowest as i32;
        plan.highest = highest as i32;
        plan.flicker_sigma = fixed(relaxation, SLOW_FRACTION);
        plan.flicker_step = fixed(relaxation * sqrt(NEW_VARIANCE), SLOW_FRACTION);
        let mut i = 0;
        while i < plan.rates.len() {
            match RatePlan::new(sensor, 250 << i) {
                Ok(rate) => plan.rates[i] = rate,
                Err(unfit) => return Err(unfit),
            }
            i += 1;
        }
        Ok(plan)
    }
}

impl RatePlan {
    const SILENT: Self = Self {
        input_hz: 0,
        pole: 0,
        white: 0,
        velocity: 0,
        walk: 0,
        ramp: 0,
    };

    const fn new(sensor: &Sensor, data_rate_hz: u32) -> Result<Self, Unfit> {
        let input_hz = data_rate_hz * DECIMATION as u32;
        let steps = sensor.steps_per_m_s2();
        let (input_rate, data_rate) = (input_hz as f64, data_rate_hz as f64);
        // Matched to the analog pole: the step response is sampled exactly.
        let pole = 1.0 - exp_negative(2.0 * core::f64::consts::PI * sensor.pole_hz / input_rate);
        // A two-sided density of N^2 at the input rate is a variance of N^2 times that rate.
        let white = sensor.noise.white * sqrt(input_rate / PAIR_VARIANCE) * steps;
        // Velocity noise of variance 32 Q^2 at the input rate has the density Q^2 tau0 below the
        // data rate's Nyquist frequency; its difference, times the input rate, is the
        // acceleration.
        let velocity = sensor.noise.quantisation
            * sqrt(DECIMATION as f64 / PAIR_VARIANCE)
            * input_rate
            * steps;
        let walk = sensor.noise.walk * sqrt(1.0 / (data_rate * GAUSS_VARIANCE)) * steps;
        let ramp = sensor.noise.ramp / data_rate * steps;
        // The generator's pairs reach 255 either way; behind the pole that bounds both.
        let peak = 255.0 * white + 510.0 * velocity * pole;
        if !fits(&[peak, walk, ramp]) {
            return Err(Unfit::Range);
        }
        Ok(Self {
            input_hz,
            pole: fixed(pole, FAST_FRACTION),
            white: fixed(white * pole, FAST_FRACTION),
            velocity: fixed(velocity * pole, FAST_FRACTION),
            walk: fixed(walk, SLOW_FRACTION),
            ramp: fixed(ramp, SLOW_FRACTION),
        })
    }
}

/// Whether all numbers of a sensor are finite, and those of them that are amounts not below zero.
const fn are_possible(sensor: &Sensor) -> bool {
    let Coefficients {
        ramp,
        walk,
        flicker,
        white,
        quantisation,
    } = sensor.noise;
    let (sensitivity, pole) = (sensor.sensitivity_v_per_g, sensor.pole_hz);
    let amounts = [
        walk,
        flicker,
        white,
        quantisation,
        sensitivity,
        pole,
        sensor.supply_v,
    ];
    let signed = [
        ramp,
        sensor.gravity_m_s2,
        sensor.zero_g_error_v,
        sensor.ainn_v,
    ];
    let mut i = 0;
    while i < amounts.len() {
        if !(amounts[i] >= 0.0 && amounts[i].is_finite()) {
            return false;
        }
        i += 1;
    }
    i = 0;
    while i < signed.len() {
        if !signed[i].is_finite() {
            return false;
        }
        i += 1;
    }
    sensor.vref_v > 0.0 && sensor.vref_v.is_finite()
}

/// Whether all are within half the range of a 32-bit word.
const fn fits(steps: &[f64]) -> bool {
    let mut i = 0;
    while i < steps.len() {
        let within = steps[i].abs() < (1 << 30) as f64;
        if !within {
            return false;
        }
        i += 1;
    }
    true
}

/// Fixed point, rounded to nearest.
const fn fixed(value: f64, fraction: u32) -> i64 {
    let scaled = value * (1_u64 << fraction) as f64;
    (if scaled < 0.0 {
        scaled - 0.5
    } else {
        scaled + 0.5
    }) as i64
}

/// Square root by Newton's iteration, for constants.
const fn sqrt(value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let mut root = if value > 1.0 { value } else { 1.0 };
    loop {
        let next = 0.5 * (root + value / root);
        // From above, the iteration falls until rounding stops it.
        if next >= root {
            return root;
        }
        root = next;
    }
}

/// exp(-x) for x >= 0, for constants: the series at x/64, squared six times.
const fn exp_negative(x: f64) -> f64 {
    if x > 700.0 {
        return 0.0;
    }
    let small = x / 64.0;
    let mut power = 1.0;
    // The series of exp(+x): all terms positive, nothing cancels.
    let mut sum = 1.0;
    let mut k = 1;
    while k < 60 {
        power *= small / k as f64;
        sum += power;
        k += 1;
    }
    k = 0;
    while k < 6 {
        sum *= sum;
        k += 1;
    }
    1.0 / sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_and_exponentials_are_those_of_the_library() {
        for x in [1e-9, 0.1, 0.25, 1.0, 2.0, 640.0, 1e9] {
            assert!((sqrt(x) / libm::sqrt(x) - 1.0).abs() < 1e-15, "{x}");
        }
        for x in [0.0, 1e-6, 0.0393, 0.3, 1.0, 20.0, 600.0] {
            assert!((exp_negative(x) / libm::exp(-x) - 1.0).abs() < 1e-12, "{x}");
        }
    }

    #[test]
    fn what_cannot_be_emulated_is_refused() {
        let noisy = |noise| {
            Plan::new(&Sensor {
                noise,
                ..Sensor::XY
            })
            .err()
        };
        let none = Coefficients::NONE;
        assert_eq!(noisy(none), None);
        assert_eq!(
            noisy(Coefficients {
                white: -1.0,
                ..none
            }),
            Some(Unfit::Number)
        );
        assert_eq!(
            noisy(Coefficients {
                walk: f64::NAN,
                ..none
            }),
            Some(Unfit::Number)
        );
        assert_eq!(
            noisy(Coefficients {
                quantisation: 1.0,
                ..none
            }),
            Some(Unfit::Range)
        );
        assert!(
            Plan::new(&Sensor {
                vref_v: 0.0,
                ..Sensor::XY
            })
            .is_err()
        );
        assert!(
            Plan::new(&Sensor {
                supply_v: 0.1,
                ..Sensor::XY
            })
            .is_err()
        );
    }
}
