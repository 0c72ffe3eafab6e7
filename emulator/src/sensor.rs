//! The MMA7331L in physical units, and the integers that its channel runs on.
//!
//! The arithmetic here is plain `f64` without library functions: the same result on every machine, and
//! evaluated by the compiler for the published axes.

use crate::{
    filter::DECIMATION,
    flicker::{NEW_VARIANCE, POLE_VARIANCE},
    random::{GAUSS_VARIANCE, PAIR_VARIANCE},
    word::CODE_MAX,
};

/// Standard gravity, m/s^2.
pub const GRAVITY_M_S2: f64 = 9.806_65;

/// Supply at which the sensor is specified, volts.
const NOMINAL_SUPPLY_V: f64 = 2.8;

/// Distance of the sensor's output swing from either rail of its supply, volts.
const RAIL_MARGIN_V: f64 = 0.1;

/// Fraction bits of what is stepped once an input.
pub(crate) const FAST_FRACTION: u32 = 20;
/// Fraction bits of what is stepped once a conversion.
pub(crate) const SLOW_FRACTION: u32 = 32;

/// The five coefficients of the noise model: sigma^2(tau) = R^2 tau^2/2 + K^2 tau/3 + B^2 2 ln2/pi +
/// N^2/tau + 3 Q^2/tau^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// R, rate ramp, m/s^3: deterministic, and the only one that may be negative.
    pub ramp: f64,
    /// K, rate random walk, m/s^2/sqrt(s).
    pub walk: f64,
    /// B, bias instability (flicker), m/s^2.
    pub flicker: f64,
    /// N, velocity random walk (white), m/s/sqrt(s).
    pub white: f64,
    /// Q, quantisation (differenced white velocity noise), m/s, as seen at the data rate.
    pub quantisation: f64,
}

impl Coefficients {
    /// No noise at all.
    pub const NONE: Self = Self {
        ramp: 0.0,
        walk: 0.0,
        flicker: 0.0,
        white: 0.0,
        quantisation: 0.0,
    };

    /// The published table for the axes X, Y, Z (1.5 h at 2000/s; Pavlov and Petrov).
    pub const PUBLISHED: [Self; 3] = [
        Self {
            ramp: 4.2e-8,
            walk: 3.6e-5,
            flicker: 0.55e-4,
            white: 1.05e-4,
            quantisation: 2.25e-4,
        },
        Self {
            ramp: 3.7e-8,
            walk: 2.3e-5,
            flicker: 0.39e-4,
            white: 0.94e-4,
            quantisation: 1.82e-4,
        },
        Self {
            ramp: 5.9e-8,
            walk: 3.3e-5,
            flicker: 0.48e-4,
            white: 1.03e-4,
            quantisation: 2.12e-4,
        },
    ];
}

/// One axis of an MMA7331L and its connection to the converter.
///
/// The output is `supply/2 + (zero-g error + sensitivity * acceleration) * supply / 2.8 V`: offset and
/// sensitivity are ratiometric. The converter sees it against AINN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Noise at the sensing element.
    pub noise: Coefficients,
    /// Gravity along the axis, m/s^2.
    pub gravity_m_s2: f64,
    /// Error of the zero-g output at a supply of 2.8 V, volts; up to +-0.084 on X and Y, +-0.14 on Z.
    pub zero_g_error_v: f64,
    /// Sensitivity at a supply of 2.8 V, volts per g.
    pub sensitivity_v_per_g: f64,
    /// Corner of the sensor's one-pole filter, hertz.
    pub pole_hz: f64,
    /// The sensor's supply, volts.
    pub supply_v: f64,
    /// Voltage at AINN, volts.
    pub ainn_v: f64,
    /// The converter's reference, volts.
    pub vref_v: f64,
}

impl Sensor {
    /// X or Y in the 4 g range, at rest and level, noise-free: 308 mV/g, 400 Hz, 2.8 V, AINN at 1.4 V,
    /// VREF 5 V.
    pub const XY: Self = Self {
        noise: Coefficients::NONE,
        gravity_m_s2: 0.0,
        zero_g_error_v: 0.0,
        sensitivity_v_per_g: 0.308,
        pole_hz: 400.0,
        supply_v: NOMINAL_SUPPLY_V,
        ainn_v: NOMINAL_SUPPLY_V / 2.0,
        vref_v: 5.0,
    };

    /// Z: as [`Sensor::XY`], but 300 Hz.
    pub const Z: Self = Self {
        pole_hz: 300.0,
        ..Self::XY
    };

    /// Sensitivity in the 12 g range at a supply of 2.8 V, volts per g.
    pub const COARSE_V_PER_G: f64 = 0.0836;

    /// The published axes, mounted as sensors are: not quite level, and with zero-g errors inside
    /// their limits.
    pub const PUBLISHED: [Self; 3] = [
        Self {
            noise: Coefficients::PUBLISHED[0],
            gravity_m_s2: 0.117,
            zero_g_error_v: 0.042,
            ..Self::XY
        },
        Self {
            noise: Coefficients::PUBLISHED[1],
            gravity_m_s2: -0.204,
            zero_g_error_v: -0.037,
            ..Self::XY
        },
        Self {
            noise: Coefficients::PUBLISHED[2],
            gravity_m_s2: 9.803,
            zero_g_error_v: -0.096,
            ..Self::Z
        },
    ];

    /// Steps of the 31-bit code per volt.
    pub const fn steps_per_volt(&self) -> f64 {
        2.0 * CODE_MAX as f64 / self.vref_v
    }

    /// Steps of the 31-bit code per m/s^2.
    pub const fn steps_per_m_s2(&self) -> f64 {
        let v_per_g = self.sensitivity_v_per_g * self.supply_v / NOMINAL_SUPPLY_V;
        v_per_g / GRAVITY_M_S2 * self.steps_per_volt()
    }

    /// The converter's code at rest, without noise.
    pub const fn rest_steps(&self) -> f64 {
        let zero_g_v = self.supply_v / 2.0 + self.zero_g_error_v * self.supply_v / NOMINAL_SUPPLY_V
            - self.ainn_v;
        zero_g_v * self.steps_per_volt() + self.gravity_m_s2 * self.steps_per_m_s2()
    }
}

/// Why a [`Sensor`] cannot be emulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unfit {
    /// A number is not finite, or negative where it must not be.
    Number,
    /// The output or a noise term exceeds what 32-bit codes can hold.
    Range,
}

impl core::fmt::Display for Unfit {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Number => "a sensor parameter is not finite, or negative where it must not be",
            Self::Range => "the sensor's output or noise exceeds the range of the emulated channel",
        })
    }
}

impl core::error::Error for Unfit {}

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
                return Err(Unfit::Number);
            }
            i += 1;
        }
        i = 0;
        while i < signed.len() {
            if !signed[i].is_finite() {
                return Err(Unfit::Number);
            }
            i += 1;
        }
        if !(sensor.vref_v > 0.0 && sensor.vref_v.is_finite()) {
            return Err(Unfit::Number);
        }

        let per_volt = sensor.steps_per_volt();
        let lowest = (RAIL_MARGIN_V - sensor.ainn_v) * per_volt;
        let highest = (sensor.supply_v - RAIL_MARGIN_V - sensor.ainn_v) * per_volt;
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
        i = 0;
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
        // Velocity noise of variance 32 Q^2 at the input rate has the density Q^2 tau0 below the data
        // rate's Nyquist frequency; its difference, times the input rate, is the acceleration.
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
    fn scale_is_that_of_the_data_sheets() {
        // 308 mV/g and VREF = 5 V: 2.646e8 counts of the 32-bit word per g.
        let per_g = 2.0 * Sensor::XY.steps_per_m_s2() * GRAVITY_M_S2;
        assert!((per_g / 2.646e8 - 1.0).abs() < 2e-4, "{per_g}");
        // Ratiometric: at 3.3 V, 363 mV/g and a zero-g output 0.25 V above AINN.
        let sensor = Sensor {
            supply_v: 3.3,
            ..Sensor::XY
        };
        let v_per_g = sensor.steps_per_m_s2() * GRAVITY_M_S2 / sensor.steps_per_volt();
        assert!((v_per_g - 0.363).abs() < 1e-12);
        assert!((sensor.rest_steps() / sensor.steps_per_volt() - 0.25).abs() < 1e-12);
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
