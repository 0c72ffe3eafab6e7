//! One analog pole ahead of the sampler that no chain declares: it acts on everything.

use super::lorentzian::{lorentzian, width_of};
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

/// Correlation times of the rival, in those of the pole.
const TIMES: [f64; 9] = [0.1, 0.3, 0.6, 0.8, 1.0, 1.2, 1.6, 3.0, 10.0];

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

    /// The rival is Markov noise that takes the place of white noise. In noise that is white at
    /// high frequencies the two differ only by their aliases; behind a chain by nothing, and
    /// such a draw has no strength 1.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let grid = Grid::new(scene, &[]);
        let truth = grid.at(|f_hz| scene.density(scene.target, f_hz) * self.power(f_hz));
        let base = grid.base(scene, |_| 1.0);
        let seen = Evidence::power(contrast(&truth, &base, &grid).power(1.0, 10.0));
        if !seen.suffices() {
            return seen;
        }
        let markov = TIMES.iter().map(|time| {
            let width_hz = width_of(time / (std::f64::consts::TAU * self.corner_hz));
            let mut parts = base.clone();
            parts.push(grid.at(|f_hz| {
                let passed = scene.chain.power(f_hz, scene.rate_hz);
                lorentzian(f_hz, 0.0, width_hz, scene) * passed
            }));
            parts
        });
        Evidence {
            rival_error: contrast_nearest(&truth, markov, &grid).error(),
            ..seen
        }
    }

    fn power(&self, f_hz: f64) -> f64 {
        one_pole(f_hz, self.corner_hz)
    }
}
