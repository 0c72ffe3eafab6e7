//! One analog pole ahead of the sampler that no chain declares: it acts on everything.

use std::f64::consts::TAU;

use super::averaging::of_mean;
use super::lorentzian::in_place_of_a_pole;
use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::grid::Grid;
use crate::hidden::ideal::spectral::{contrast, contrast_nearest};
use crate::hidden::noise::chain::one_pole;

struct Rolloff {
    corner_hz: f64,
}

pub fn draw(scene: &Scene, _draw: &mut Draw) -> Box<dyn Effect> {
    let corner_hz = 0.5 * scene.rate_hz;
    Box::new(Rolloff { corner_hz })
}

/// Lengths of a mean that is a rival, in those of one that takes away as much at low frequencies.
const LENGTHS: [f64; 9] = [0.25, 0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0, 3.0];

impl Effect for Rolloff {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new("rolloff", &[("corner_hz", self.corner_hz)])]
    }

    /// What the pole takes away at a frequency far below it goes with the square of its
    /// distance, so twice as strong is lower by the root of two.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            corner_hz: self.corner_hz / factor.sqrt(),
        })
    }

    /// Rivals are Markov noise that takes the place of white noise, and a running mean. In noise that is white at
    /// high frequencies a pole and Markov noise differ only by their aliases; behind a chain by nothing, and
    /// such a draw has no strength 1.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let grid = Grid::new(scene, &[]);
        let truth = grid.at(|f_hz| scene.density(scene.target, f_hz) * self.power(f_hz));
        let base = grid.base(scene, |_| 1.0);
        let seen = Evidence::power(contrast(&truth, &base, &grid).power(1.0, 10.0));
        if !seen.suffices() {
            return seen;
        }
        let markov = in_place_of_a_pole(self.corner_hz, &base, &grid, scene);
        // 1 - (n^2 - 1) w^2 / 12 against 1 - (f / corner)^2.
        let bend = 12.0 * (scene.rate_hz / (TAU * self.corner_hz)).powi(2);
        let means = LENGTHS.iter().map(|length| {
            let samples = (1.0 + length * length * bend).sqrt();
            grid.base(scene, |f_hz| of_mean(samples, f_hz / scene.rate_hz))
        });
        Evidence {
            rival_error: contrast_nearest(&truth, markov.chain(means), &grid).error(),
            ..seen
        }
    }

    fn power(&self, f_hz: f64) -> f64 {
        one_pole(f_hz, self.corner_hz)
    }
}
