//! A tone of steady size whose frequency follows a slow random process, with or without its second harmonic.

use std::f64::consts::{PI, TAU};

use super::tone::{Tone, frequency};
use super::{Effect, Evidence, Gain, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::Contrast;
use crate::hidden::ideal::grid::{Feature, Grid};
use crate::hidden::ideal::spectral::contrast;

#[derive(Clone)]
struct WanderingLine {
    f_hz: f64,
    /// Standard deviation and correlation time of the frequency.
    wander_hz: f64,
    wander_s: f64,
    /// Amplitudes of the base and of its second harmonic.
    amplitudes: [f64; 2],
    /// Phases at the start of the record, radians.
    phases: [f64; 2],
}

/// From 2 Hz on, wandering by 0.02 to 2 % and at least ten times as far as the record is fine, over 1 s to a
/// twentieth of it. Where the phase turns by less than half a cycle within the correlation time, how far and how fast
/// it wanders have one effect alone: drawn again.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let f_hz = loop {
        let f_hz = frequency(scene, draw);
        // In slow records from a twentieth of the rate on: there may be no frequency of 2 Hz.
        let least_hz = (0.05 * scene.rate_hz).min(2.0);
        if (least_hz..0.2 * scene.rate_hz).contains(&f_hz) {
            break f_hz;
        }
    };
    let (wander_hz, wander_s) = loop {
        let wander_hz = (f_hz * draw.log_uniform(2e-4, 2e-2)).max(10.0 / scene.duration_s());
        // In a record of seconds a twentieth is too short for any of it.
        let longest_s = (scene.duration_s() / 20.0).max(1.0 / wander_hz).max(2.0);
        let wander_s = draw.log_uniform(1.0, longest_s);
        if TAU * wander_hz * wander_s > PI {
            break (wander_hz, wander_s);
        }
    };
    let second = if draw.index(2) == 0 {
        draw.log_uniform(0.5, 1.0) * Tone::amplitude_for(2.0 * f_hz, 1.0, scene)
            / Tone::amplitude_for(f_hz, 1.0, scene)
    } else {
        0.0
    };
    let phases = [draw.uniform(0.0, TAU), draw.uniform(0.0, TAU)];
    Box::new(WanderingLine {
        f_hz,
        wander_hz,
        wander_s,
        amplitudes: [1e-3, 1e-3 * second],
        phases,
    })
}

impl WanderingLine {
    /// How long it can be followed as a tone: a phase that wanders as the integral of a walk lies within a radian
    /// over the square root of ten of a straight line (residual variance `q t^3 / 420`, `q` the walk's variance a
    /// second).
    fn coherent_s(&self) -> f64 {
        let walk = 2.0 * (TAU * self.wander_hz).powi(2) / self.wander_s;
        (0.1 * 420.0 / walk).cbrt()
    }
}

impl Effect for WanderingLine {
    fn truths(&self) -> Vec<Truth> {
        let mut parameters = vec![
            ("f_hz".to_owned(), self.f_hz),
            ("wander_hz".to_owned(), self.wander_hz),
            ("wander_s".to_owned(), self.wander_s),
            ("amplitude_1".to_owned(), self.amplitudes[0]),
        ];
        if self.amplitudes[1] > 0.0 {
            parameters.push(("amplitude_2".to_owned(), self.amplitudes[1]));
        }
        vec![Truth {
            effect: "wandering_line",
            parameters,
        }]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            amplitudes: self.amplitudes.map(|one| factor * one),
            ..self.clone()
        })
    }

    /// Seen as Gaussian noise of its spectrum is. The rival is just that, a resonance: told apart by following the
    /// tone, which gains its energy in each stretch where it is coherent, and pays for what it has to choose there:
    /// the phase, `ln(4 pi energy) / 2` (the asymptote of the Bessel function of the mean over all phases), and the
    /// frequency, which moves by a normal step of 1.03 cells of the stretch: the entropy of that in halves of a cell is
    /// `ln 8.5`. The harmonic is left out: a bonus.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let feature = Feature {
            f_hz: self.f_hz,
            width_hz: self.wander_hz,
        };
        let grid = Grid::new(scene, &[feature]);
        let passed = |f_hz: f64| scene.chain.power(f_hz, scene.rate_hz);
        let truth = grid.at(|f_hz| {
            let off = (f_hz - self.f_hz) / self.wander_hz;
            let shape = (-0.5 * off * off).exp() / (self.wander_hz * TAU.sqrt());
            let own = 0.25 * self.amplitudes[0].powi(2) * shape;
            scene.density(scene.target, f_hz) + own * passed(f_hz)
        });
        let trials = 10.0 * 0.5 * scene.rate_hz / self.wander_hz;
        let seen = contrast(&truth, &grid.base(scene, |_| 1.0), &grid);
        let coherent_s = self.coherent_s().min(scene.duration_s());
        let cells = scene.duration_s() / coherent_s;
        let noise = scene.seen_density(scene.target, self.f_hz);
        let energy = 0.25 * self.amplitudes[0].powi(2) * passed(self.f_hz) * coherent_s / noise;
        let choices = 8.5_f64.ln() + 0.5 * (2.0 * TAU * energy).ln().max(0.0);
        let followed = Contrast {
            mean: 2.0 * cells * (energy - choices),
            variance: 4.0 * cells * (2.0 * energy + 1.0),
        };
        Evidence {
            power: seen.power(4.0, trials),
            rival_error: followed.error(),
        }
    }

    /// It moves by 2 % at most: over that the chain is taken as even.
    fn tones(&self, scene: &Scene, draw: &mut Draw, gain: Gain<'_>) -> Option<Vec<f64>> {
        let amplitudes = [1.0, 2.0].map(|number| gain(number * self.f_hz));
        let amplitudes = [0, 1].map(|place| amplitudes[place] * self.amplitudes[place]);
        let decay = 1.0 / (self.wander_s * scene.rate_hz);
        let (keep, fresh) = ((-decay).exp(), (-(-2.0 * decay).exp_m1()).sqrt());
        let mut away = draw.normal();
        let mut turns = 0.0_f64;
        let samples = (0..scene.samples).map(|_| {
            let angles = [1.0, 2.0].map(|number| TAU * (number * turns).fract());
            let tones = angles.iter().zip(&self.phases).zip(&amplitudes);
            let value = tones.map(|((angle, phase), size)| size * (angle + phase).cos());
            let value = value.sum();
            turns = (turns + (self.f_hz + self.wander_hz * away) / scene.rate_hz).fract();
            away = keep * away + fresh * draw.normal();
            value
        });
        Some(samples.collect())
    }
}
