//! A board without hardware on a table, turned by hand: what its sensors feel of gravity, and what is true
//! of them.

use std::sync::{Arc, Mutex, PoisonError};

use inm_emulator::channel::Channel;
use inm_emulator::sensor::{Coefficients, GRAVITY_M_S2, Sensor, Unfit};
use inm_protocol::{AXES, SensorRange};
use nalgebra::{Matrix3, Vector3};
use rand_distr::{Distribution, Uniform};

use crate::model::Seed;
use crate::model::random::random;

/// Stream of random numbers, another than those of noise and of what is hidden.
const TRUTH: u64 = 3 << 48;

/// Largest error of a sensitivity, of a zero (volts) and of the direction of an axis (rad): those of the
/// sheet as remembered, and an axis within two degrees, as packages are soldered.
const SCALE_ERROR: f64 = 0.06;
const ZERO_ERROR_V: f64 = 0.08;
const TILT_RAD: f64 = 0.035;

/// What a sensor of each axis is in truth.
#[derive(Debug, Clone)]
pub struct Truth {
    sensors: [Sensor; AXES],
    /// Unit directions of the sensitive axes, one a row; x is that of X, y in the plane of X and Y.
    directions: Matrix3<f64>,
}

/// The block under the board, in a hand.
#[derive(Debug, Clone)]
pub struct Turned {
    /// Directions of the sensitive axes.
    directions: Matrix3<f64>,
    /// What the block feels, m/s^2, in the same frame.
    felt: Arc<Mutex<Vector3<f64>>>,
    /// How far the zeros have wandered since power came on, steps of the code.
    wandered: Arc<Mutex<[f64; AXES]>>,
}

impl Truth {
    /// Sensors of this noise with errors drawn from the seed.
    pub fn draw(noise: [Coefficients; AXES], seed: u64) -> Self {
        let mut random = random(Seed {
            seed,
            stream: TRUTH,
        });
        let mut within =
            |most: f64| Uniform::new(-most, most).map_or(0.0, |law| law.sample(&mut random));
        let mut axis = 0;
        let sensors = noise.map(|noise| {
            let sheet = if axis == 2 { Sensor::Z } else { Sensor::XY };
            axis += 1;
            Sensor {
                noise,
                zero_g_error_v: within(ZERO_ERROR_V),
                sensitivity_v_per_g: sheet.sensitivity_v_per_g * (1.0 + within(SCALE_ERROR)),
                ..sheet
            }
        });
        let [yx, zx, zy] = [(); 3].map(|()| within(TILT_RAD));
        let directions = Matrix3::new(
            1.0,
            0.0,
            0.0,
            yx,
            (1.0 - yx * yx).sqrt(),
            0.0,
            zx,
            zy,
            (1.0 - zx * zx - zy * zy).sqrt(),
        );
        Self {
            sensors,
            directions,
        }
    }

    /// The parameters of a calibration by the nominal scale of a range, in its order: the lower triangle,
    /// then zeros in m/s^2 without what they wander.
    pub fn parameters(&self, range: SensorRange) -> [f64; 9] {
        let inverse = self.rows(range).try_inverse();
        let matrix = inverse.unwrap_or_else(Matrix3::identity);
        let zero = self.zeros(range);
        [
            matrix[(0, 0)],
            matrix[(1, 0)],
            matrix[(1, 1)],
            matrix[(2, 0)],
            matrix[(2, 1)],
            matrix[(2, 2)],
            zero[0],
            zero[1],
            zero[2],
        ]
    }

    /// What each sensor reads by the nominal scale of 1 m/s^2 along x, y, z, one sensor a row.
    pub(super) fn rows(&self, range: SensorRange) -> Matrix3<f64> {
        let scales = Vector3::from(self.steps_per_m_s2(range));
        let scales = scales / at(&Sensor::XY, range).steps_per_m_s2();
        Matrix3::from_diagonal(&scales) * self.directions
    }

    /// Zeros by the nominal scale of a range, m/s^2, without what they wander.
    pub(super) fn zeros(&self, range: SensorRange) -> [f64; AXES] {
        let nominal = at(&Sensor::XY, range).steps_per_m_s2();
        self.sensors
            .map(|sensor| at(&sensor, range).rest_steps() / nominal)
    }

    /// The sensors as channels on a range.
    ///
    /// # Errors
    /// [`Unfit`] if the noise is none that a channel can make.
    pub fn channels(&self, range: SensorRange, seed: u64) -> Result<[Channel; AXES], Unfit> {
        let [x, y, z] = self.sensors.map(|sensor| at(&sensor, range));
        Ok([
            Channel::new(&x, seed, 0)?,
            Channel::new(&y, seed, 1)?,
            Channel::new(&z, seed, 2)?,
        ])
    }

    /// Steps of the code in 1 m/s^2 along each axis.
    pub fn steps_per_m_s2(&self, range: SensorRange) -> [f64; AXES] {
        self.sensors
            .map(|sensor| at(&sensor, range).steps_per_m_s2())
    }

    /// A block with these sensors, level.
    pub fn block(&self) -> Turned {
        let level = Vector3::new(0.0, 0.0, GRAVITY_M_S2);
        Turned {
            directions: self.directions,
            felt: Arc::new(Mutex::new(level)),
            wandered: Arc::default(),
        }
    }
}

/// A sensor on a range: what is off by so much on one is on the other.
pub(super) fn at(sensor: &Sensor, range: SensorRange) -> Sensor {
    match range {
        SensorRange::G4 => *sensor,
        SensorRange::G12 => {
            let coarser = Sensor::COARSE_V_PER_G / Sensor::XY.sensitivity_v_per_g;
            Sensor {
                sensitivity_v_per_g: sensor.sensitivity_v_per_g * coarser,
                ..*sensor
            }
        }
    }
}

impl Turned {
    /// What the sensor of an axis feels, m/s^2.
    pub fn along(&self, axis: usize) -> f64 {
        let felt = *self.felt.lock().unwrap_or_else(PoisonError::into_inner);
        self.directions.row(axis).transpose().dot(&felt)
    }

    /// What the block feels, m/s^2.
    pub fn felt(&self) -> [f64; 3] {
        (*self.felt.lock().unwrap_or_else(PoisonError::into_inner)).into()
    }

    /// Puts the block so that it feels this, m/s^2.
    pub fn put(&self, felt: [f64; 3]) {
        *self.felt.lock().unwrap_or_else(PoisonError::into_inner) = felt.into();
    }

    /// How far the zeros have wandered since power came on, steps of the code.
    pub fn wandered(&self) -> [f64; AXES] {
        *self.wandered.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn note(&self, axis: usize, steps: f64) {
        let mut wandered = self.wandered.lock().unwrap_or_else(PoisonError::into_inner);
        wandered[axis] = steps;
    }
}
