//! A peak of finite width: noise with autocorrelation `exp(-pi width |t|) cos(2 pi f0 t)`.

use super::lorentzian::lorentzian;
use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::grid::{Feature, Grid};
use crate::hidden::ideal::spectral::contrast;

struct Resonance {
    f_hz: f64,
    width_hz: f64,
    amplitude: f64,
}

/// Between 2 Hz and 0.35 of the rate, quality 4 to 60, at least 100 times wider than a line.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let lowest_hz = match scene.relative {
        true => 400.0 / scene.duration_s(),
        false => 2.0,
    };
    let f_hz = draw.log_uniform(lowest_hz, 0.35 * scene.rate_hz);
    let width_hz = (f_hz / draw.log_uniform(4.0, 60.0)).max(100.0 / scene.duration_s());
    Box::new(Resonance {
        f_hz,
        width_hz,
        amplitude: 1e-3,
    })
}

impl Effect for Resonance {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "resonance",
            &[
                ("f_hz", self.f_hz),
                ("width_hz", self.width_hz),
                ("amplitude", self.amplitude),
            ],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            amplitude: self.amplitude * factor,
            ..*self
        })
    }

    /// Trials: as many as such peaks have room side by side, over ten widths. Against a line no
    /// error is counted: a hundred cells of the spectrum share the power.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let grid = Grid::new(scene, &self.features());
        let truth = grid.at(|f_hz| {
            scene.density(scene.target, f_hz)
                + scene.chain.power(f_hz, scene.rate_hz) * self.density(f_hz, scene)
        });
        let trials = 10.0 * 0.5 * scene.rate_hz / self.width_hz;
        let seen = contrast(&truth, &grid.base(scene, |_| 1.0), &grid);
        Evidence::power(seen.power(3.0, trials))
    }

    fn density(&self, f_hz: f64, scene: &Scene) -> f64 {
        self.amplitude.powi(2) * lorentzian(f_hz, self.f_hz, self.width_hz, scene)
    }

    fn features(&self) -> Vec<Feature> {
        vec![Feature {
            f_hz: self.f_hz,
            width_hz: self.width_hz,
        }]
    }
}
