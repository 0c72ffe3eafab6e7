//! Switching between two levels at random: dwell times exponential, both levels alike.

use super::lorentzian::{lorentzian, width_of};
use super::markov::TRIALS;
use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::grid::Grid;
use crate::hidden::ideal::levels::{self, Data};
use crate::hidden::ideal::spectral::contrast;

struct Telegraph {
    height: f64,
    dwell_s: f64,
}

/// Dwell times from a tenth of a second to a fortieth of the record: with fewer switches the
/// same record is one of steps.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let (from_s, to_s) = scene.times_s((0.1, scene.duration_s() / 40.0), 20.0, 40.0);
    Box::new(Telegraph {
        height: 1e-3,
        dwell_s: draw.log_uniform(from_s, to_s),
    })
}

impl Effect for Telegraph {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "telegraph",
            &[("height", self.height), ("dwell_s", self.dwell_s)],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            height: self.height * factor,
            ..*self
        })
    }

    /// Seen as its spectrum is, `height^2 / 4` with correlation time `dwell / 2`. The rival is
    /// Gaussian noise of that spectrum: told apart by the law of means over half a dwell, one
    /// independent mean a dwell (an approximation: the likelihood of the two-state chain knows a
    /// little more).
    fn evidence(&self, scene: &Scene) -> Evidence {
        let grid = Grid::new(scene, &[]);
        let width_hz = width_of(0.5 * self.dwell_s);
        let truth = grid.at(|f_hz| {
            let passed = scene.chain.power(f_hz, scene.rate_hz);
            scene.density(scene.target, f_hz)
                + 0.25 * self.height.powi(2) * lorentzian(f_hz, 0.0, width_hz, scene) * passed
        });
        let seen = contrast(&truth, &grid.base(scene, |_| 1.0), &grid);
        let noise = scene.allan_variance(scene.target, 0.5 * self.dwell_s);
        let blocks = scene.duration_s() / self.dwell_s;
        let levels = levels::contrast(self.height, noise, blocks, Data::TwoLevels);
        Evidence {
            power: seen.power(2.0, TRIALS),
            rival_error: levels.error(),
        }
    }

    fn waveform(&self, scene: &Scene, _axis: usize, draw: &mut Draw) -> Option<Vec<f64>> {
        let mut level = 0.5 * self.height * draw.sign();
        let mut until_s = draw.exponential(self.dwell_s);
        let samples = (0..scene.samples).map(|i| {
            let t_s = i as f64 / scene.rate_hz;
            while t_s >= until_s {
                level = -level;
                until_s += draw.exponential(self.dwell_s);
            }
            level
        });
        Some(samples.collect())
    }
}
