//! A slope between those of the five terms.

use super::lorentzian::{lorentzian, width_of};
use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::grid::Grid;
use crate::hidden::ideal::spectral::{contrast, contrast_nearest};

struct Powerlaw {
    exponent: f64,
    density_1hz: f64,
}

/// Exponents halfway between white and flicker, or between flicker and walk.
pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let middle = draw.pick(&[0.5, 1.5]);
    Box::new(Powerlaw {
        exponent: middle + draw.uniform(-0.2, 0.2),
        density_1hz: 1e-6,
    })
}

/// Correlation times of the Markov noise that stands for a wide crossover, seconds.
const TIMES_S: [f64; 8] = [0.001, 0.005, 0.02, 0.1, 0.5, 2.0, 8.0, 30.0];

/// The same from two samples to a seventeenth of a record of any kind.
fn times_s(scene: &Scene) -> [f64; 8] {
    if !scene.relative {
        return TIMES_S;
    }
    let (from_s, to_s) = scene.times_s((0.0, 0.0), 2.0, 17.0);
    std::array::from_fn(|i| from_s * (to_s / from_s).powf(i as f64 / 7.0))
}

impl Effect for Powerlaw {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "powerlaw",
            &[
                ("exponent", self.exponent),
                ("density_1hz", self.density_1hz),
            ],
        )]
    }

    /// The density, by the square: the amplitude is what is scaled.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            density_1hz: self.density_1hz * factor * factor,
            ..*self
        })
    }

    /// Against the nearest of the five terms' sums; the rival is Markov noise beside them.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let grid = Grid::new(scene, &[]);
        let truth = grid.at(|f_hz| {
            let passed = scene.chain.power(f_hz, scene.rate_hz);
            scene.density(scene.target, f_hz) + passed * self.density(f_hz, scene)
        });
        let base = grid.base(scene, |_| 1.0);
        let seen = Evidence::power(contrast(&truth, &base, &grid).power(2.0, 10.0));
        if !seen.suffices() {
            return seen;
        }
        let markov = times_s(scene).into_iter().map(|time_s| {
            let mut parts = base.clone();
            parts.push(grid.at(|f_hz| {
                let passed = scene.chain.power(f_hz, scene.rate_hz);
                lorentzian(f_hz, 0.0, width_of(time_s), scene) * passed
            }));
            parts
        });
        Evidence {
            rival_error: contrast_nearest(&truth, markov, &grid).error(),
            ..seen
        }
    }

    fn density(&self, f_hz: f64, _scene: &Scene) -> f64 {
        self.density_1hz * f_hz.powf(-self.exponent)
    }
}
