//! From converter codes to volts and m/s^2: the MMA7331L behind an ADS1281.
//!
//! ```text
//!   acceleration --sensitivity, zero-g--> sensor output --(AINP - AINN)--> word --link--> here
//! ```
//!
//! The sensor is ratiometric: sensitivity and zero-g voltage scale with its supply. They are
//! specified at 2.8 V: 308 mV/g on the 4 g range, 83.6 mV/g on the coarse range (12 g; the
//! MMA7331LC sheet calls the row 9 g), zero-g at half the supply. These typical values are from
//! the MMA7331L and MMA7341L data sheets as remembered, the first confirmed by two published
//! designs at 3.3 V; single parts differ by 6 % (Z zero-g 10 %), so that a calibrated scale
//! should take their place where there is one.
//!
//! AINN is biased at half the *nominal* supply from the reference, so that zero acceleration is
//! code zero and the converter's range fits the sensor's: with AINN at ground the 4 g range
//! would clip at 3.57 g.
//!
//! Pure functions in `f64`, for the host; the board never computes with them.

use inm_protocol::SensorRange;

/// Standard gravity, m/s^2 (exact by definition).
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// Supply at which the sensor is specified, volts.
pub const SPECIFIED_SUPPLY_V: f64 = 2.8;

/// Largest magnitude of a 31-bit value behind the FIR filter: positive full scale
/// (SBAS378D, page 24).
const FULL_SCALE: f64 = ((1_u32 << 30) - 1) as f64;

/// Words are twice the 31-bit value, with the sign repeated in their lowest bit.
const WORDS_PER_VALUE: f64 = 2.0;

/// Typical sensitivity at a supply of `supply_v` volts, volts per standard gravity.
pub fn sensitivity_v_per_g(range: SensorRange, supply_v: f64) -> f64 {
    let specified = match range {
        SensorRange::G4 => 0.308,
        SensorRange::G12 => 0.0836,
    };
    specified * supply_v / SPECIFIED_SUPPLY_V
}

/// Typical output at zero acceleration and a supply of `supply_v` volts, volts.
pub fn zero_g_v(supply_v: f64) -> f64 {
    supply_v / 2.0
}

/// What turns codes into acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scaling {
    /// Reference of the converter, VREFP - VREFN, volts.
    pub reference_v: f64,
    /// Range of the sensor.
    pub range: SensorRange,
    /// Supply of the sensor, volts.
    pub supply_v: f64,
    /// Voltage on AINN, volts.
    pub bias_v: f64,
}

impl Scaling {
    /// From what a board says of itself, microvolts; AINN at half the nominal supply.
    pub fn new(reference_uv: u32, range: SensorRange, sensor_supply_uv: u32) -> Self {
        let supply_v = f64::from(sensor_supply_uv) * 1e-6;
        Self {
            reference_v: f64::from(reference_uv) * 1e-6,
            range,
            supply_v,
            bias_v: zero_g_v(supply_v),
        }
    }

    /// The same chain at another supply of the sensor, volts: sensitivity and zero-g move, the
    /// bias does not.
    #[must_use]
    pub fn at_supply(self, supply_v: f64) -> Self {
        Self { supply_v, ..self }
    }

    /// Volts between AINP and AINN per count of the 31-bit value.
    pub fn volts_per_value(&self) -> f64 {
        self.reference_v / 2.0 / FULL_SCALE
    }

    /// Volts between AINP and AINN of a code as it comes over the link.
    ///
    /// The redundant sign bit is dropped, as an arithmetic shift does.
    pub fn volts(&self, code: i32) -> f64 {
        f64::from(code >> 1) * self.volts_per_value()
    }

    /// Acceleration of a code as it comes over the link, m/s^2.
    pub fn acceleration(&self, code: i32) -> f64 {
        let output_v = self.volts(code) + self.bias_v;
        (output_v - zero_g_v(self.supply_v)) / self.volts_per_acceleration()
    }

    /// Acceleration of one count of the code, m/s^2: `value = scale * (code - zero)`.
    ///
    /// A code counts half steps, with its lowest bit the sign again; to leave that bit in moves
    /// the value by half a step for negative codes, 1.2 nV, far below any noise.
    pub fn scale(&self) -> f64 {
        self.volts_per_value() / WORDS_PER_VALUE / self.volts_per_acceleration()
    }

    /// Code of zero acceleration, counts: 0 at the nominal supply.
    pub fn zero(&self) -> f64 {
        (zero_g_v(self.supply_v) - self.bias_v) / self.volts_per_value() * WORDS_PER_VALUE
    }

    fn volts_per_acceleration(&self) -> f64 {
        sensitivity_v_per_g(self.range, self.supply_v) / STANDARD_GRAVITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn board() -> Scaling {
        Scaling::new(5_000_000, SensorRange::G4, 2_800_000)
    }

    #[track_caller]
    fn close(found: f64, expected: f64, relative: f64) {
        assert!(
            (found - expected).abs() <= relative * expected.abs(),
            "{found} is not {expected}"
        );
    }

    #[test]
    fn volts_are_those_of_the_code_table() {
        // SBAS378D, page 24: positive full scale, zero, the smallest negative step.
        close(board().volts(0x7FFF_FFFE), 2.5, 1e-15);
        close(board().volts(0), 0.0, 0.0);
        close(board().volts(-1), -2.5 / 1_073_741_823.0, 1e-15);
    }

    #[test]
    fn one_g_on_both_ranges() {
        // Chain budget: 2.646e8 and 7.18e7 of the 32-bit word per g, to their printed digits.
        let coarse = Scaling::new(5_000_000, SensorRange::G12, 2_800_000);
        for (scaling, code_per_g, digits) in [(board(), 2.646e8, 2e-4), (coarse, 7.18e7, 5e-4)] {
            close(STANDARD_GRAVITY / scaling.scale(), code_per_g, digits);
            let code = (STANDARD_GRAVITY / scaling.scale()) as i32;
            close(scaling.acceleration(code), STANDARD_GRAVITY, 1e-7);
        }
    }

    #[test]
    fn scale_and_zero_agree_with_the_function_at_any_supply() {
        for supply_v in [2.2, 2.8, 2.81, 3.3, 3.6] {
            let scaling = board().at_supply(supply_v);
            for code in [-2_000_000_000, -264_600_001, 0, 4, 123_456_789] {
                let linear = scaling.scale() * (f64::from(code) - scaling.zero());
                let exact = scaling.acceleration(code);
                assert!(
                    (linear - exact).abs() <= scaling.scale() * 1.001,
                    "{supply_v} V, code {code}: {linear} and {exact}"
                );
            }
        }
    }

    #[test]
    fn the_sensor_is_ratiometric() {
        close(sensitivity_v_per_g(SensorRange::G4, 3.3), 0.363, 1e-3);
        close(sensitivity_v_per_g(SensorRange::G12, 3.3), 0.0985, 1e-3);
        // 10 mV more supply lift the output by 5 mV, 16 mg.
        let scaling = board().at_supply(2.81);
        close(
            scaling.zero() * board().scale() / STANDARD_GRAVITY,
            0.005 / 0.308,
            1e-9,
        );
    }
}
