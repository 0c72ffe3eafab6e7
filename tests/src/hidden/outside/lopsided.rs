//! White noise of a skewed law: as a rectified disturbance makes.

use super::Place;
use crate::hidden::draw::Draw;
use crate::hidden::effect::{Distorts, Effect};
use crate::hidden::ideal::detector::{Evidence, power};
use crate::hidden::scene::Scene;
use crate::hidden::truth::Truth;

struct Lopsided {
    deviation: f64,
    side: f64,
}

pub fn draw(_scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    Box::new(Lopsided {
        deviation: 1e-2,
        side: draw.sign(),
    })
}

impl Effect for Lopsided {
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new("lopsided", &[("deviation", self.deviation)])]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            deviation: self.deviation * factor,
            ..*self
        })
    }

    /// By the skewness of what single samples tell beside their neighbours, `N skewness^2 / 6`.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let own = self.deviation.powi(2);
        let share = own / (own + scene.interpolation_variance(scene.target));
        let skewness = 8_f64.sqrt() * share.powf(1.5);
        let energy = scene.samples as f64 * skewness.powi(2) / 6.0;
        Evidence::power(power(energy, 1.0, 4.0))
    }

    /// Chi-squared with one degree of freedom, less its mean; behind the chain, which would make
    /// it normal again.
    fn distort(
        &self,
        samples: &mut Vec<f64>,
        _scene: &Scene,
        draw: &mut Draw,
    ) -> Vec<(String, f64)> {
        let scale = self.side * self.deviation / 2_f64.sqrt();
        for sample in samples {
            *sample += scale * (draw.normal().powi(2) - 1.0);
        }
        Vec::new()
    }

    fn distorts(&self, _scene: &Scene) -> Distorts {
        Distorts::Adds
    }

    fn place(&self) -> Option<Place> {
        Some(Place::Amplitude)
    }
}
