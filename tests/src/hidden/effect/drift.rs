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
    /// The lowest ordinates of the record.
    ordinates: Vec<Ordinate>,
}

/// The product of the record with a half-wave of a cosine, whose square is expected to be the density for noise.
#[derive(Clone, Copy)]
struct Ordinate {
    f_hz: f64,
    /// Density of the noise.
    noise: f64,
    /// Square of what the course adds.
    course: f64,
}

/// Ordinates that are looked at: sixteen times those that hold the course.
const ORDINATES: usize = 16 * HALF_WAVES;

/// Places in which the course is multiplied with a half-wave.
const PLACES: usize = 1024;

/// Each half-wave is as large as its length, at random.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let size = |number: usize, draw: &mut Draw| 1e-3 * draw.normal() / number as f64;
    let sizes: Vec<[f64; 2]> = (1..=HALF_WAVES)
        .map(|number| [size(number, draw), size(number, draw)])
        .collect();
    let energy = energy(&course(&sizes, scene), scene, scene.target);
    let share = share_beside_step(scene, |thinned| course(&sizes, thinned));
    let lost = scene.lost_density(scene.target);
    Box::new(Drift {
        ordinates: (1..=ORDINATES)
            .map(|j| ordinate(&sizes, scene, lost, j))
            .collect(),
        sizes,
        energy,
        beside_step: energy * share,
    })
}

fn course(sizes: &[[f64; 2]], scene: &Scene) -> Vec<f64> {
    let at = |i: usize| level(sizes, i as f64 / scene.samples as f64);
    (0..scene.samples).map(at).collect()
}

/// The course at a share of the record.
fn level(sizes: &[[f64; 2]], place: f64) -> f64 {
    let waves = sizes.iter().zip(1..);
    let waves = waves.map(|([cosine, sine], number)| {
        let turn = PI * place * f64::from(number);
        cosine * turn.cos() + sine * turn.sin()
    });
    waves.sum()
}

fn ordinate(sizes: &[[f64; 2]], scene: &Scene, lost: f64, j: usize) -> Ordinate {
    let duration_s = scene.duration_s();
    let f_hz = 0.5 * j as f64 / duration_s;
    let places = (0..PLACES).map(|i| (i as f64 + 0.5) / PLACES as f64);
    let products = places.map(|place| level(sizes, place) * (PI * j as f64 * place).cos());
    let product = products.sum::<f64>() / PLACES as f64;
    Ordinate {
        f_hz,
        noise: scene.density(scene.target, f_hz) + lost,
        course: 2.0 * duration_s * product.powi(2),
    }
}

/// What the log-likelihood of a course as noise of its own spectrum beside noise that is known is ahead, on average, of the
/// likeliest walk and flicker that are taken for both, nats. Their sizes are tried in octaves, over what there is at the
/// lowest ordinate.
fn ahead_of_walk(ordinates: &[Ordinate]) -> f64 {
    const OCTAVES: i32 = 24;
    let first = ordinates[0];
    let most = first.noise + first.course;
    let sizes =
        || std::iter::once(0.0).chain((-OCTAVES..4).map(|octave| most * f64::from(octave).exp2()));
    let ahead = |walk: f64, flicker: f64| -> f64 {
        let each = ordinates.iter().map(|one| {
            let over = first.f_hz / one.f_hz;
            let taken = one.noise + walk * over * over + flicker * over;
            let own = one.noise + one.course;
            0.5 * ((taken / own).ln() + own / taken - 1.0)
        });
        each.sum()
    };
    let all = sizes().flat_map(|walk| sizes().map(move |flicker| (walk, flicker)));
    all.map(|(walk, flicker)| ahead(walk, flicker))
        .fold(f64::INFINITY, f64::min)
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
            ordinates: self
                .ordinates
                .iter()
                .map(|one| Ordinate {
                    course: one.course * factor * factor,
                    ..*one
                })
                .collect(),
        })
    }

    /// As Gaussian noise of its spectrum. The rivals are one step anywhere, and walk and flicker: the log-likelihood's lead
    /// is half of what a known waveform's non-centrality would be.
    fn evidence(&self, _scene: &Scene) -> Evidence {
        let ahead = 2.0 * ahead_of_walk(&self.ordinates);
        Evidence {
            power: power(self.energy.min(ahead), 2.0, 1.0),
            rival_error: Contrast::shift(self.beside_step.min(ahead)).error(),
        }
    }

    fn waveform(&self, scene: &Scene, _axis: usize, _draw: &mut Draw) -> Option<Vec<f64>> {
        Some(course(&self.sizes, scene))
    }
}
