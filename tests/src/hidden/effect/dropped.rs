//! Samples lost without a trace but the jump of phase of the mains lines.

use std::f64::consts::TAU;

use super::hum::Hum;
use super::{Effect, Evidence, Gain, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::{Contrast, power};

struct Dropped {
    hum: Hum,
    time_s: f64,
    samples: usize,
}

/// One gap of 2 to 30 samples in the middle of the record, under a hum.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let hum = Hum::draw(scene, draw);
    // The moment of the first sample that is lost: more is not in the record.
    let index = (draw.uniform(0.25, 0.75) * scene.duration_s() * scene.rate_hz).floor();
    Box::new(Dropped {
        hum,
        time_s: index / scene.rate_hz,
        samples: 2 + draw.index(29),
    })
}

impl Dropped {
    fn index(&self, scene: &Scene) -> usize {
        (self.time_s * scene.rate_hz).round() as usize
    }
}

impl Effect for Dropped {
    fn truths(&self) -> Vec<Truth> {
        let mut truths = self.hum.truths();
        truths.push(Truth::new(
            "dropped",
            &[
                ("time_s_1", self.time_s),
                ("samples_1", self.samples as f64),
            ],
        ));
        truths
    }

    /// The lines are what makes it visible.
    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            hum: self.hum.times(factor),
            ..*self
        })
    }

    /// What a steady line of the best frequency leaves of each line; the search over times and
    /// lengths counts as 2000 trials. The rival is one line that changes its phase by itself:
    /// the second line decides. The hum must suffice too.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let at = self.time_s / scene.duration_s();
        let mut left: Vec<f64> = self
            .hum
            .lines()
            .map(|tone| {
                let turn = TAU * tone.f_hz * self.samples as f64 / scene.rate_hz;
                tone.energy(scene) * (1.0 - steady_share(at, turn))
            })
            .collect();
        left.sort_by(f64::total_cmp);
        let second = left[left.len() - 2];
        Evidence {
            power: power(left.iter().sum(), 2.0, 2000.0),
            rival_error: Contrast::shift(second).error(),
        }
        .and(self.hum.evidence(scene))
    }

    fn tones(&self, scene: &Scene, draw: &mut Draw, gain: Gain<'_>) -> Option<Vec<f64>> {
        self.hum.tones(scene, draw, gain)
    }

    /// The record gets shorter.
    fn distort(
        &self,
        samples: &mut Vec<f64>,
        scene: &Scene,
        _draw: &mut Draw,
    ) -> Vec<(String, f64)> {
        let from = self.index(scene);
        samples.drain(from..from + self.samples);
        Vec::new()
    }
}

/// Share of a line's energy that a steady line takes if the phase jumps by `turn` at the share
/// `at` of the record: the largest `|int_0^1 e^{j (turn [u > at] - w u)} du|^2` over `w`.
fn steady_share(at: f64, turn: f64) -> f64 {
    let part = |w: f64, from: f64, to: f64, phase: f64| {
        // int e^{j (phase - w u)} du
        if w.abs() < 1e-9 {
            return ((to - from) * phase.cos(), (to - from) * phase.sin());
        }
        let at = |u: f64| {
            let angle = phase - w * u;
            (-angle.sin() / w, angle.cos() / w)
        };
        let ((a, b), (c, d)) = (at(from), at(to));
        (c - a, d - b)
    };
    (-200..=200)
        .map(|step| {
            let w = f64::from(step) * 0.05;
            let (a, b) = part(w, 0.0, at, 0.0);
            let (c, d) = part(w, at, 1.0, turn);
            (a + c).powi(2) + (b + d).powi(2)
        })
        .fold(0.0, f64::max)
}
