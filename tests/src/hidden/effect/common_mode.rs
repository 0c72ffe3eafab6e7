//! White noise that three axes share, each with a gain of its own.

use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::Contrast;
use crate::hidden::ideal::grid::Grid;

#[derive(Clone, Copy)]
struct CommonMode {
    /// Square root of the two-sided density in the first axis.
    root_density: f64,
    /// Relative to the first axis.
    gains: [f64; 3],
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let mut gain = || draw.sign() * draw.log_uniform(0.4, 2.0);
    Box::new(CommonMode {
        root_density: 1e-3,
        gains: [1.0, gain(), gain()],
    })
}

impl CommonMode {
    /// Twice the log-ratio against independent axes of the same spectra, `-ln det` of the
    /// coherence matrix a coefficient, with one of the axes left out or none.
    fn contrast(&self, scene: &Scene, without: Option<usize>) -> Contrast {
        let grid = Grid::new(scene, &[]);
        let mut mean = 0.0;
        for (f_hz, weight) in grid.f_hz.iter().zip(&grid.weight) {
            let shared = self.root_density.powi(2) * scene.chain.power(*f_hz, scene.rate_hz);
            // det(D + c g g') = prod D (1 + sum c g^2 / D).
            let ratios = (0..3)
                .filter(|axis| Some(*axis) != without)
                .map(|axis| shared * self.gains[axis].powi(2) / scene.density(axis, *f_hz));
            let (mut sum, mut apart) = (0.0, 0.0);
            for ratio in ratios {
                sum += ratio;
                apart += (1.0 + ratio).ln();
            }
            mean += weight * (apart - (1.0 + sum).ln());
        }
        Contrast::shift(mean)
    }
}

impl Effect for CommonMode {
    /// The gains of the second and third axis, in order.
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new(
            "common_mode",
            &[("gain_2", self.gains[1]), ("gain_3", self.gains[2])],
        )]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            root_density: self.root_density * factor,
            ..*self
        })
    }

    /// Every pair of axes by itself, so that the three gains can be told; twenty bands searched.
    fn evidence(&self, scene: &Scene) -> Evidence {
        (0..3)
            .map(|axis| {
                let pair = self.contrast(scene, Some(axis));
                Evidence::power(pair.power(1.0, 20.0 * 3.0))
            })
            .fold(Evidence::power(1.0), Evidence::and)
    }

    fn waveform(&self, scene: &Scene, axis: usize, draw: &mut Draw) -> Option<Vec<f64>> {
        let deviation = self.root_density * scene.rate_hz.sqrt() * self.gains[axis];
        Some(
            (0..scene.samples)
                .map(|_| deviation * draw.normal())
                .collect(),
        )
    }

    fn in_all_axes(&self) -> bool {
        true
    }
}
