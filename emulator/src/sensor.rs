//! The MMA7331L in physical units: its noise, its output, its connection to the converter.
//!
//! Plain `f64`, turned into the [`channel`](crate::channel)'s integers once, when it is built.

use crate::word::CODE_MAX;

/// Standard gravity, m/s^2.
pub const GRAVITY_M_S2: f64 = 9.806_65;

/// Supply at which the sensor is specified, volts.
const NOMINAL_SUPPLY_V: f64 = 2.8;

/// The five coefficients of the noise model: sigma^2(tau) = R^2 tau^2/2 + K^2 tau/3 + B^2 2
/// ln2/pi + N^2/tau + 3 Q^2/tau^2.
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
/// The output is `supply/2 + (zero-g error + sensitivity * acceleration) * supply / 2.8 V`:
/// offset and sensitivity are ratiometric. The converter sees it against AINN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Noise at the sensing element.
    pub noise: Coefficients,
    /// Gravity along the axis, m/s^2.
    pub gravity_m_s2: f64,
    /// Error of the zero-g output at a supply of 2.8 V, volts; up to +-0.084 on X and Y, +-0.14
    /// on Z.
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
    /// X or Y in the 4 g range, at rest and level, noise-free: 308 mV/g, 400 Hz, 2.8 V, AINN at
    /// 1.4 V, VREF 5 V.
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
