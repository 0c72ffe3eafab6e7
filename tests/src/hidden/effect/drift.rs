//! A slow smooth course of the level that nothing leads.

use std::f64::consts::PI;

use super::slow::share_beside_step;
use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::{Contrast, power};
use crate::hidden::ideal::matched::energy;

/// Half-waves in the record, of a cosine and of a sine each: two whole waves, twice what is there of a day.
const HALF_WAVES: usize = 4;

#[derive(Clone)]
struct Drift {
    /// Sizes of cosine and sine of each half-wave.
    sizes: Vec<[f64; 2]>,
    /// Non-centrality, and what is left of it beside the best of a row of steps.
    energy: f64,
    beside_step: f64,
}

/// Each half-wave is as large as its length, at random.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let size = |number: usize, draw: &mut Draw| 1e-3 * draw.normal() / number as f64;
    let sizes: Vec<[f64; 2]> = (1..=HALF_WAVES)
        .map(|number| [size(number, draw), size(number, draw)])
        .collect();
    let energy = energy(&course(&sizes, scene), scene, scene.target);
    let share = share_beside_step(scene, |thinned| course(&sizes, thinned));
    Box::new(Drift {
        sizes,
        energy,
        beside_step: energy * share,
    })
}

fn course(sizes: &[[f64; 2]], scene: &Scene) -> Vec<f64> {
    let at = |i: usize| {
        let turn = PI * i as f64 / scene.samples as f64;
        let waves = sizes.iter().zip(1..);
        let waves = waves.map(|([cosine, sine], number)| {
            let turn = turn * f64::from(number);
            cosine * turn.cos() + sine * turn.sin()
        });
        waves.sum()
    };
    (0..scene.samples).map(at).collect()
}

impl Effect for Drift {
    /// Its levels are the report's own choice: no number of it is a truth.
    fn truths(&self) -> Vec<Truth> {
        vec![Truth::new("drift", &[])]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            sizes: self
                .sizes
                .iter()
                .map(|pair| pair.map(|size| factor * size))
                .collect(),
            energy: self.energy * factor * factor,
            beside_step: self.beside_step * factor * factor,
        })
    }

    /// As many numbers as sizes, in one trial. The rival is one step anywhere.
    fn evidence(&self, _scene: &Scene) -> Evidence {
        Evidence {
            power: power(self.energy, 2.0 * HALF_WAVES as f64, 1.0),
            rival_error: Contrast::shift(self.beside_step).error(),
        }
    }

    fn waveform(&self, scene: &Scene, _axis: usize, _draw: &mut Draw) -> Option<Vec<f64>> {
        Some(course(&self.sizes, scene))
    }
}
