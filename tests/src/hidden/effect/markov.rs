//! Exponentially correlated noise (eq. 3): Gaussian, `K(t) = amplitude^2 exp(-|t| / time)`.

use super::lorentzian::{lorentzian, width_of};
use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::grid::Grid;
use crate::hidden::ideal::levels::{self, Data};
use crate::hidden::ideal::spectral::{contrast, contrast_nearest};

struct Markov {
    amplitude: f64,
    time_s: f64,
}

pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let (from_s, to_s) = scene.times_s((0.003, 5.0), 6.0, 100.0);
    Box::new(Markov {
        amplitude: 1e-3,
        time_s: draw.log_uniform(from_s, to_s),
    })
}

/// Exponents of the power laws that stand for all of them as rivals.
pub const EXPONENTS: [f64; 6] = [0.4, 0.7, 1.2, 1.4, 1.6, 1.8];

/// Trials of a search over the correlation time: about three independent ones a decade.
pub const TRIALS: f64 = 15.0;

impl Effect for Markov {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "markov",
            &[("amplitude", self.amplitude), ("time_s", self.time_s)],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            amplitude: self.amplitude * factor,
            ..*self
        })
    }

    /// Rivals: the nearest power law, and two levels with the same spectrum.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let grid = Grid::new(scene, &[]);
        let truth = grid.at(|f_hz| {
            scene.density(scene.target, f_hz)
                + scene.chain.power(f_hz, scene.rate_hz) * self.density(f_hz, scene)
        });
        let base = grid.base(scene, |_| 1.0);
        let seen = Evidence::power(contrast(&truth, &base, &grid).power(2.0, TRIALS));
        if !seen.suffices() {
            return seen;
        }
        let powers = EXPONENTS.iter().map(|exponent| {
            let mut parts = base.clone();
            parts.push(
                grid.at(|f_hz| f_hz.powf(-exponent) * scene.chain.power(f_hz, scene.rate_hz)),
            );
            parts
        });
        let rival = contrast_nearest(&truth, powers, &grid).error();
        let noise = scene.allan_variance(scene.target, self.time_s);
        let blocks = scene.duration_s() / (2.0 * self.time_s);
        let levels = levels::contrast(2.0 * self.amplitude, noise, blocks, Data::Gaussian);
        Evidence {
            rival_error: rival.max(levels.error()),
            ..seen
        }
    }

    fn density(&self, f_hz: f64, scene: &Scene) -> f64 {
        self.amplitude.powi(2) * lorentzian(f_hz, 0.0, width_of(self.time_s), scene)
    }
}
