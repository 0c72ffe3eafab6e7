//! Each sample is the mean of the latest ones: it acts on everything.

use std::f64::consts::TAU;

use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::grid::Grid;
use crate::hidden::ideal::spectral::{contrast, contrast_nearest};
use crate::hidden::noise::chain::one_pole;

struct Averaging {
    /// Samples that a mean is over; the oldest of them counts by what is left of the number.
    samples: f64,
    rate_hz: f64,
}

pub fn draw(scene: &Scene, _draw: &mut Draw) -> Box<dyn Effect> {
    Box::new(Averaging {
        samples: 2.0_f64.sqrt(),
        rate_hz: scene.rate_hz,
    })
}

/// Corners of the rival, in those of a pole that takes away as much at low frequencies.
const CORNERS: [f64; 9] = [0.3, 0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0, 4.0];

impl Effect for Averaging {
    fn truths(&self) -> Vec<Truth> {
        let duration_s = self.samples / self.rate_hz;
        vec![Truth::new("averaging", &[("duration_s", duration_s)])]
    }

    /// What a mean takes away at a low frequency goes with the square of its length, but for one sample.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        let square = 1.0 + (self.samples.powi(2) - 1.0) * factor;
        Box::new(Self {
            samples: square.sqrt(),
            ..*self
        })
    }

    /// The rival is a pole.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let grid = Grid::new(scene, &[]);
        let truth = grid.at(|f_hz| scene.density(scene.target, f_hz) * self.power(f_hz));
        let base = grid.base(scene, |_| 1.0);
        let seen = Evidence::power(contrast(&truth, &base, &grid).power(1.0, 10.0));
        if !seen.suffices() {
            return seen;
        }
        // 1 - (n^2 - 1) w^2 / 12 against 1 - (f / corner)^2.
        let bend = ((self.samples.powi(2) - 1.0) / 12.0).sqrt();
        let corner_hz = self.rate_hz / (TAU * bend);
        let poles = CORNERS.iter().map(|corner| {
            let passed = |f_hz: f64| one_pole(f_hz, corner * corner_hz);
            grid.base(scene, passed)
        });
        Evidence {
            rival_error: contrast_nearest(&truth, poles, &grid).error(),
            ..seen
        }
    }

    fn power(&self, f_hz: f64) -> f64 {
        of_mean(self.samples, f_hz / self.rate_hz)
    }
}

/// Power behind a mean over so many `samples` at so many `cycles` a sample: the square of the sum of the weights, each turned by
/// its lag.
pub fn of_mean(samples: f64, cycles: f64) -> f64 {
    let whole = samples as usize;
    let weights = std::iter::repeat_n(1.0, whole).chain([samples.fract()]);
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (lag, weight) in weights.enumerate() {
        let turn = TAU * cycles * lag as f64;
        cosine += weight * turn.cos();
        sine += weight * turn.sin();
    }
    (cosine * cosine + sine * sine) / samples.powi(2)
}
