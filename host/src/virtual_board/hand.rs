//! A hand that turns the block under a board without hardware.

use nalgebra::Vector3;
use rand_distr::{Distribution, Normal, Uniform};
use rand_pcg::Pcg64;

use super::turned::Turned;
use crate::model::Seed;
use crate::model::random::random;

/// Stream of random numbers, another than those of noise, of what is hidden, and of truth.
const HAND: u64 = 4 << 48;

/// How far a table, and the faces of a block that is not square, are from where they should be, rad: half
/// a degree as standard deviation, more than a spirit level leaves.
const ASKEW_RAD: f64 = 0.009;

/// A hand that turns a block.
#[derive(Debug)]
pub struct Hand {
    /// What the block feels in each place, m/s^2, the last one first.
    places: Vec<Vector3<f64>>,
    turned: Turned,
}

impl Turned {
    /// A hand that puts this block into `positions` places all over the sphere, one after the other in a
    /// random order, on a table and on faces that are askew.
    pub fn hand(&self, positions: usize, gravity_m_s2: f64, seed: u64) -> Hand {
        Hand::new(self, all_over(positions, gravity_m_s2, seed))
    }
}

impl Hand {
    /// A hand that puts a block where it feels these, m/s^2, the last one first.
    pub(super) fn new(turned: &Turned, places: Vec<Vector3<f64>>) -> Self {
        let turned = turned.clone();
        Self { places, turned }
    }

    /// Puts the block into the next place; `false` if there is none.
    pub fn turn(&mut self) -> bool {
        let Some(felt) = self.places.pop() else {
            return false;
        };
        self.turned.put(felt.into());
        true
    }
}

/// What a block feels in `positions` places all over the sphere, the last one first, m/s^2.
fn all_over(positions: usize, gravity_m_s2: f64, seed: u64) -> Vec<Vector3<f64>> {
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
    shuffle(&mut places, &mut random);
    let askew = Normal::new(0.0, ASKEW_RAD);
    for place in places.iter_mut().rev() {
        let tilt = [(); 3].map(|()| askew.map_or(0.0, |law| law.sample(&mut random)));
        *place = gravity_m_s2 * (*place + Vector3::from(tilt)).normalize();
    }
    places
}

/// Puts places into a random order.
pub(super) fn shuffle(places: &mut [Vector3<f64>], random: &mut Pcg64) {
    for last in (1..places.len()).rev() {
        places.swap(last, below(last + 1, random));
    }
}

/// A random number from 0 to `end`, that excluded.
pub(super) fn below(end: usize, random: &mut Pcg64) -> usize {
    let share = Uniform::new(0.0, 1.0).map_or(0.0, |law| law.sample(random));
    ((share * end as f64) as usize).min(end - 1)
}
