//! Frequencies at which two laws are compared, and how much of the record stands behind each.

use crate::hidden::scene::Scene;

/// A feature of a spectrum that the grid must resolve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// Where, hertz.
    pub f_hz: f64,
    /// How wide, hertz.
    pub width_hz: f64,
}

/// Edges about a feature, in widths.
const ABOUT: [f64; 13] = [
    0.1, 0.25, 0.4, 0.6, 0.8, 1.0, 1.4, 2.0, 3.0, 5.0, 10.0, 20.0, 40.0,
];

/// Bins between the lowest frequency of the record's cosine transform and half the rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Centres, hertz.
    pub f_hz: Vec<f64>,
    /// Degrees of freedom of each: cosine coefficients in the bin.
    pub weight: Vec<f64>,
}

impl Grid {
    /// 12 bins an octave, single coefficients at the bottom, more about `features`. Leaves out
    /// what the chain stops; what samples that are missing take away counts as much less.
    pub fn new(scene: &Scene, features: &[Feature]) -> Self {
        let (spacing_hz, top_hz) = (0.5 / scene.duration_s(), 0.5 * scene.rate_hz);
        let mut edges: Vec<f64> = (0..32).map(|j| (f64::from(j) + 0.5) * spacing_hz).collect();
        let mut edge = edges[31];
        while edge < top_hz {
            edges.push(edge);
            edge *= 2_f64.powf(1.0 / 12.0);
        }
        edges.push(top_hz);
        let bottom_hz = edges[0];
        for feature in features {
            let around = ABOUT
                .iter()
                .flat_map(|about| [-about, *about])
                .map(|about| feature.f_hz + about * feature.width_hz);
            edges.extend(around.filter(|f_hz| (bottom_hz..top_hz).contains(f_hz)));
        }
        edges.sort_by(f64::total_cmp);
        let lost = scene.lost_density(scene.target);
        let seen = |f_hz: f64| (1.0 + lost / scene.density(scene.target, f_hz)).powi(-2);
        let (f_hz, weight) = edges
            .windows(2)
            .filter(|edge| edge[1] > edge[0])
            .map(|edge| (0.5 * (edge[0] + edge[1]), (edge[1] - edge[0]) / spacing_hz))
            .filter(|(f_hz, _)| scene.passes(*f_hz))
            .map(|(f_hz, weight)| (f_hz, weight * seen(f_hz)))
            .unzip();
        Self { f_hz, weight }
    }

    /// `law` at every bin.
    pub fn at(&self, law: impl Fn(f64) -> f64) -> Vec<f64> {
        self.f_hz.iter().map(|&f_hz| law(f_hz)).collect()
    }

    /// The base's terms at every bin, each per unit square, times `power`; of a real record also what was measured.
    pub fn base(&self, scene: &Scene, power: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
        let terms = (0..4).map(|part| self.at(|f_hz| scene.parts(f_hz)[part] * power(f_hz)));
        let measured = scene.measured.iter();
        let measured = measured.map(|law| self.at(|f_hz| law.density(f_hz) * power(f_hz)));
        terms.chain(measured).collect()
    }
}
