//! A board without hardware on a table, turned by hand: what its sensors feel of gravity, and what is true
//! of them.

use std::sync::{Arc, Mutex, PoisonError};

use inm_emulator::channel::Channel;
use inm_emulator::sensor::{Coefficients, GRAVITY_M_S2, Sensor, Unfit};
use inm_protocol::{AXES, SensorRange};
use nalgebra::{Matrix3, Vector3};
use rand_distr::{Distribution, Normal, Uniform};
use rand_pcg::Pcg64;

use crate::model::Seed;
use crate::model::random::random;

/// Streams of random numbers, others than those of noise and of what is hidden.
const TRUTH: u64 = 3 << 48;
const HAND: u64 = 4 << 48;

/// Largest error of a sensitivity, of a zero (volts) and of the direction of an axis (rad): those of the
/// sheet as remembered, and an axis within two degrees, as packages are soldered.
const SCALE_ERROR: f64 = 0.06;
const ZERO_ERROR_V: f64 = 0.08;
const TILT_RAD: f64 = 0.035;

/// How far a table, and the faces of a block that is not square, are from where they should be, rad: half
/// a degree as standard deviation, more than a spirit level leaves.
const ASKEW_RAD: f64 = 0.009;

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

/// A hand that turns a block.
#[derive(Debug)]
pub struct Hand {
    random: Pcg64,
    places: Vec<Vector3<f64>>,
    turned: Turned,
    gravity_m_s2: f64,
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
        let nominal = at(&Sensor::XY, range);
        let sensors = self.sensors.map(|sensor| at(&sensor, range));
        let scales = Vector3::from(sensors.map(|one| one.steps_per_m_s2()));
        let scales = scales / nominal.steps_per_m_s2();
        let inverse = (Matrix3::from_diagonal(&scales) * self.directions).try_inverse();
        let matrix = inverse.unwrap_or_else(Matrix3::identity);
        let zero = sensors.map(|one| one.rest_steps() / nominal.steps_per_m_s2());
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

    /// A hand that puts this block into `positions` places all over the sphere, one after the other in a
    /// random order, on a table and on faces that are askew.
    pub fn hand(&self, positions: usize, gravity_m_s2: f64, seed: u64) -> Hand {
        let mut random = random(Seed { seed, stream: HAND });
        let number = positions.max(1) as f64;
        // Fibonacci's lattice: evenly spread, whatever the number.
        let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let mut places: Vec<Vector3<f64>> = (0..positions)
            .map(|at| {
                let height = 1.0 - (2.0 * at as f64 + 1.0) / number;
                let radius = (1.0 - height * height).sqrt();
                let (sine, cosine) = (golden * at as f64).sin_cos();
                Vector3::new(radius * cosine, radius * sine, height)
            })
            .collect();
        for last in (1..places.len()).rev() {
            let share = Uniform::new(0.0, 1.0).map_or(0.0, |law| law.sample(&mut random));
            let other = ((share * (last + 1) as f64) as usize).min(last);
            places.swap(last, other);
        }
        Hand {
            random,
            places,
            turned: self.clone(),
            gravity_m_s2,
        }
    }
}

impl Hand {
    /// Puts the block into the next place; `false` if there is none.
    pub fn turn(&mut self) -> bool {
        let Some(place) = self.places.pop() else {
            return false;
        };
        let askew = Normal::new(0.0, ASKEW_RAD);
        let tilt = [(); 3].map(|()| askew.map_or(0.0, |law| law.sample(&mut self.random)));
        let direction = (place + Vector3::from(tilt)).normalize();
        self.turned.put((self.gravity_m_s2 * direction).into());
        true
    }
}
