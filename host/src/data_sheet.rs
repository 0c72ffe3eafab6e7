//! What the data sheets state: noise, compared with an estimate of N; step of the self-test and
//! output at rest, for `inm board selftest`.
//!
//! The sensor is an MMA7331L: 350 ug/sqrt(Hz) typical from 0.1 Hz to 1 kHz (Freescale MMA7331L; the
//! number as remembered, the band as read). Data sheets mean the root of a one-sided density:
//! N is that over sqrt(2). The converter is an ADS1281 (SBAS378D page 11, typical signal-to-noise
//! ratio with a reference of 5 V): 55 nV/sqrt(Hz) one-sided at every rate to within a decibel,
//! referred to acceleration through 308 mV/g.

use std::f64::consts::SQRT_2;

use inm_firmware::mma7331l::{STANDARD_GRAVITY, sensitivity_v_per_g};
use inm_protocol::SensorRange;

use crate::chain::Chain;
use crate::signal::{Dimension, Unit};

/// Noise of the sensor, one-sided, g per root hertz.
const SENSOR_G: f64 = 350e-6;

/// Noise of the converter, one-sided, volts per root hertz.
const CONVERTER_V: f64 = 55e-9;

/// Supply at which the sensor is specified, volts.
const SUPPLY_V: f64 = 2.8;

/// Corners of the sensor's own filter, hertz: what tells its channel from another.
const SENSOR_POLES_HZ: [f64; 2] = [400.0, 300.0];

/// Ratio up to which an estimate agrees with a typical value: parts of one type scatter, and a
/// channel adds noise of its own.
const TOLERANCE: f64 = 1.5;

/// Smallest and largest step of an axis' output when its self-test pin is driven, g, whatever its sign:
/// X and Y move by 0.05 g at least (typically -0.1 g), Z by 0.8 to 1.2 g (typically +1 g). Numbers of the
/// MMA7331L's and MMA7361L's sheets (table 2, "Self Test: Output Response") as remembered, not yet tried
/// on hardware. For X and Y no maximum is stated: theirs is the minimum of Z, beyond which they answer as
/// a Z does.
const SELF_TEST_STEP_G: [[f64; 2]; 3] = [[0.05, 0.8], [0.05, 0.8], [0.8, 1.2]];

/// Largest error of the zero-g output of X, Y, Z, volts at a supply of 2.8 V: 6 % of 1.4 V in plane, 10 %
/// across (the same sheets, as remembered: `firmware/src/mma7331l.rs`).
const ZERO_G_ERROR_V: [f64; 3] = [0.084, 0.084, 0.14];

/// Supplies at which the MMA7331L is specified, volts (MMA7331LC, head of table 2).
pub const SENSOR_SUPPLY_V: [f64; 2] = [2.2, 3.6];

/// Smallest and largest magnitude of the self-test step of `axis` (0 to 2 for X to Z), g; the sign of Z's
/// is positive.
pub fn self_test_step_g(axis: usize) -> [f64; 2] {
    SELF_TEST_STEP_G[axis.min(2)]
}

/// Largest output at rest of `axis` (0 to 2 for X to Z), g either way: gravity, and the error of the zero-g
/// output.
pub fn rest_g(axis: usize, range: SensorRange) -> f64 {
    1.0 + ZERO_G_ERROR_V[axis.min(2)] / sensitivity_v_per_g(range, SUPPLY_V)
}

/// What the data sheets say of the white noise of a channel, root of the two-sided density in
/// m/s^2 per root hertz.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SheetNoise {
    /// Of the MMA7331L.
    pub sensor: f64,
    /// Of the ADS1281, referred to acceleration.
    pub converter: f64,
}

impl SheetNoise {
    /// That of an MMA7331L behind an ADS1281; `None` for any other chain.
    pub fn of(chain: &Chain) -> Option<Self> {
        let sensor = chain
            .poles_hz
            .iter()
            .any(|pole_hz| SENSOR_POLES_HZ.contains(pole_hz));
        (sensor && chain.converter.is_some()).then(|| Self::on(SensorRange::G4))
    }

    /// That of an MMA7331L on this range behind an ADS1281; the sensor's is stated for both alike.
    pub fn on(range: SensorRange) -> Self {
        let v_per_g = sensitivity_v_per_g(range, SUPPLY_V);
        Self {
            sensor: SENSOR_G * STANDARD_GRAVITY / SQRT_2,
            converter: CONVERTER_V / v_per_g * STANDARD_GRAVITY / SQRT_2,
        }
    }

    /// Where the density of a sound channel lies: above what a converter alone may have, up to what still
    /// agrees with the sensor's typical value.
    pub fn plausible(&self) -> [f64; 2] {
        [self.converter * TOLERANCE, self.sensor * TOLERANCE]
    }
}

/// Lines about an estimate `n` with its 95 % interval from `lo` to `hi`, in the unit of the axis
/// times root second: what the sheets say, and whether they agree. Nothing where the chain is not
/// that of the known hardware.
pub fn lines(chain: Option<&Chain>, unit: Unit, n: f64, lo: f64, hi: f64) -> Vec<String> {
    let Some(sheet) = chain.and_then(SheetNoise::of) else {
        return Vec::new();
    };
    let Some((Dimension::Acceleration, factor)) = unit.si() else {
        return Vec::new();
    };
    let (n, lo, hi) = (n * factor, lo * factor, hi * factor);
    let SheetNoise { sensor, converter } = sheet;
    let mut lines = vec![format!(
        "Data sheets, typical: N {sensor:.2e} m/s/sqrt(s) of the sensor (MMA7331L), \
         {converter:.1e} of the converter (ADS1281); here {n:.2e}."
    )];
    if lo > sensor * TOLERANCE {
        lines.push(format!(
            "The white noise is {:.1} times the sensor's typical: look for another source, such \
             as the supply, an unbuffered output or vibration.",
            n / sensor
        ));
    } else if hi < sensor / TOLERANCE {
        lines.push(format!(
            "The white noise is {:.1} times below the sensor's typical: is it the sensor that was \
             recorded, at this scale, and is the chain the one declared?",
            sensor / n
        ));
    }
    if hi < converter {
        lines.push(
            "It is below the converter's own noise, which cannot be: scale or unit is wrong."
                .to_owned(),
        );
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::published::PublishedAxis;

    fn chain() -> Chain {
        "ads1281:linear+400hz".parse().expect("a chain")
    }

    #[test]
    fn the_published_white_noise_is_far_below_the_sensor() {
        let sheet = SheetNoise::of(&chain()).expect("known hardware");
        let n = PublishedAxis::X.coefficients().n;
        assert!(
            (sheet.sensor / n - 23.1).abs() < 0.1,
            "{}",
            sheet.sensor / n
        );
        // 66 dB between sensor and converter.
        let decibels = 20.0 * (sheet.sensor / sheet.converter).log10();
        assert!((decibels - 66.0).abs() < 0.5, "{decibels}");
        let said = lines(Some(&chain()), Unit::MetrePerSecondSquared, n, n, n);
        assert_eq!(said.len(), 2, "{said:?}");
        assert!(said[1].contains("23.1 times below"), "{said:?}");
    }

    #[test]
    fn agreement_and_unknown_hardware_say_nothing_more() {
        let typical = SENSOR_G / SQRT_2;
        let said = lines(Some(&chain()), Unit::Gravity, typical, typical, typical);
        assert_eq!(said.len(), 1, "{said:?}");
        let other = "100hz".parse().expect("a chain");
        assert!(lines(Some(&other), Unit::Gravity, typical, typical, typical).is_empty());
        assert!(lines(None, Unit::Gravity, typical, typical, typical).is_empty());
        let twice = 2.0 * typical;
        let said = lines(
            Some(&chain()),
            Unit::Gravity,
            twice,
            1.9 * typical,
            2.1 * typical,
        );
        assert!(said[1].contains("2.0 times the sensor"), "{said:?}");
    }
}
