//! A cube under the board, laid on its faces by a hand: faces that are not square, a table that is not level.

use inm_protocol::{AXES, SensorRange};
use nalgebra::{Matrix3, Rotation3, Vector3};
use rand_distr::{Distribution, Normal, Uniform};
use rand_pcg::Pcg64;

use super::hand::{Hand, below, shuffle};
use super::turned::{Truth, Turned};
use crate::model::Seed;
use crate::model::random::random;

/// Stream of random numbers, another than those of noise, of what is hidden, and of truth and hand.
const CUBE: u64 = 5 << 48;

/// How far the sensors' frame is turned in the cube's about each axis at most, rad: as boards are screwed on.
const MOUNT_RAD: f64 = 0.035;

/// A cube as it is in truth.
#[derive(Debug, Clone)]
pub struct Cube {
    /// From the cube's frame to that of the sensors.
    mount: Matrix3<f64>,
    /// Each face's error in two directions across, rad.
    faces: [[f64; 2]; 6],
    /// The table's in two directions, rad: the cube lies on it a quarter turn one way or the other.
    table: [f64; 2],
    random: Pcg64,
}

impl Cube {
    /// A cube whose faces are off level by `tilt_rad`, a standard deviation in each direction: half of its square is the
    /// table's, half the cube's own.
    pub fn draw(tilt_rad: f64, seed: u64) -> Self {
        let mut random = random(Seed { seed, stream: CUBE });
        let mount = Uniform::new(-MOUNT_RAD, MOUNT_RAD);
        let mount = [(); 3].map(|()| mount.map_or(0.0, |law| law.sample(&mut random)));
        let share = Normal::new(0.0, tilt_rad * std::f64::consts::FRAC_1_SQRT_2);
        let mut tilt = || [(); 2].map(|()| share.map_or(0.0, |law| law.sample(&mut random)));
        Self {
            mount: Rotation3::new(Vector3::from(mount)).into_inner(),
            faces: [(); 6].map(|()| tilt()),
            table: tilt(),
            random,
        }
    }

    /// The parameters of a calibration on it by the nominal scale of a range, in its order: nine numbers row by row, in
    /// the frame of faces as they should be, and zeros in m/s^2 without what they wander.
    pub fn parameters(&self, truth: &Truth, range: SensorRange) -> [f64; 12] {
        let matrix = (truth.rows(range) * self.mount).try_inverse();
        let matrix = matrix.unwrap_or_else(Matrix3::identity);
        let zeros = truth.zeros(range);
        std::array::from_fn(|at| match at.checked_sub(9) {
            None => matrix[(at / AXES, at % AXES)],
            Some(axis) => zeros[axis],
        })
    }

    /// A hand that puts the cube with `block` on it on each of its faces, in a random order.
    pub fn hand(mut self, block: &Turned, gravity_m_s2: f64) -> Hand {
        let mut places = Vec::with_capacity(self.faces.len());
        for (at, face) in self.faces.iter().enumerate() {
            let (axis, sign) = (at / 2, if at % 2 == 0 { 1.0 } else { -1.0 });
            // The cube is laid down a quarter turn one way or the other.
            let quarter = below(4, &mut self.random) as f64 * std::f64::consts::FRAC_PI_2;
            let (sine, cosine) = quarter.sin_cos();
            let [one, other] = self.table;
            let mut up = Vector3::zeros();
            up[axis] = sign;
            up[(axis + 1) % AXES] = face[0] + cosine * one - sine * other;
            up[(axis + 2) % AXES] = face[1] + sine * one + cosine * other;
            places.push(gravity_m_s2 * (self.mount * up.normalize()));
        }
        shuffle(&mut places, &mut self.random);
        Hand::new(block, places)
    }
}
