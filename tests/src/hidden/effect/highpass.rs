//! One pole that keeps the slow out, a coupling: it acts on everything.

use super::lorentzian::in_place_of_a_pole;
use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::grid::Grid;
use crate::hidden::ideal::spectral::{contrast, contrast_nearest};

struct Highpass {
    corner_hz: f64,
}

pub fn draw(scene: &Scene, _draw: &mut Draw) -> Box<dyn Effect> {
    /// Periods of the corner in the record: as many ordinates lie below it.
    const PERIODS: f64 = 10.0;
    let corner_hz = PERIODS * scene.rate_hz / scene.samples as f64;
    Box::new(Highpass { corner_hz })
}

impl Effect for Highpass {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new("highpass", &[("corner_hz", self.corner_hz)])]
    }

    /// As many ordinates more are below the corner.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            corner_hz: self.corner_hz * factor,
        })
    }

    /// The rival is Markov noise: a walk behind a coupling is nothing else, so that what is left of the white noise below the
    /// corner has to tell.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let grid = Grid::new(scene, &[]);
        let truth = grid.at(|f_hz| scene.density(scene.target, f_hz) * self.power(f_hz));
        let base = grid.base(scene, |_| 1.0);
        let seen = Evidence::power(contrast(&truth, &base, &grid).power(1.0, 10.0));
        if !seen.suffices() {
            return seen;
        }
        let markov = in_place_of_a_pole(self.corner_hz, &base, &grid, scene);
        Evidence {
            rival_error: contrast_nearest(&truth, markov, &grid).error(),
            ..seen
        }
    }

    fn power(&self, f_hz: f64) -> f64 {
        let corners = (f_hz / self.corner_hz).powi(2);
        corners / (1.0 + corners)
    }
}
