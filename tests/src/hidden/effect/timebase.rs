//! A record taken faster or slower than it says, beside a reference with the same lines.

use std::f64::consts::TAU;

use super::tone::{Tone, frequency, trials};
use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::power;

struct Timebase {
    /// True rate over the rate it says: lines appear at their frequency over this.
    ratio: f64,
    /// At their true frequencies.
    lines: Vec<Tone>,
}

/// A rate off by 0.2 to 5 %, two or three lines at no simple ratio.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let ratio = 1.0 + draw.sign() * draw.log_uniform(0.002, 0.05);
    let count = 2 + draw.index(2);
    let mut lines: Vec<Tone> = Vec::new();
    while lines.len() < count {
        let f_hz = frequency(scene, draw);
        let apart = |other: &Tone| {
            let (low, high) = (f_hz.min(other.f_hz), f_hz.max(other.f_hz));
            let multiple = high / low;
            (multiple - multiple.round()).abs() > 0.12 && multiple > 1.2
        };
        if f_hz < 0.35 * scene.rate_hz && lines.iter().all(apart) {
            lines.push(Tone {
                f_hz,
                amplitude: Tone::amplitude_for(f_hz, 100.0, scene),
                phase: draw.uniform(0.0, TAU),
            });
        }
    }
    Box::new(Timebase { ratio, lines })
}

impl Timebase {
    fn apparent(&self) -> impl Iterator<Item = Tone> + '_ {
        self.lines.iter().map(|line| Tone {
            f_hz: line.f_hz / self.ratio,
            ..*line
        })
    }
}

/// The lines alone, as the reference holds them.
struct Lines(Vec<Tone>);

impl Effect for Lines {
    fn truths(&self) -> Vec<Truth> {
        let line = |tone: &Tone| {
            let parameters = [("f_hz", tone.f_hz), ("amplitude", tone.amplitude)];
            Truth::new("sinusoid", &parameters)
        };
        self.0.iter().map(line).collect()
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self(
            self.0.iter().map(|line| line.scaled(factor)).collect(),
        ))
    }

    /// The weakest line.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let least = self.0.iter().map(|line| line.energy(scene));
        let least = least.fold(f64::INFINITY, f64::min);
        Evidence::power(power(least, 2.0, trials(scene.samples)))
    }

    fn waveform(&self, scene: &Scene, _axis: usize, _draw: &mut Draw) -> Option<Vec<f64>> {
        let mut samples = vec![0.0; scene.samples];
        for line in &self.0 {
            line.add_to(&mut samples, scene.rate_hz);
        }
        Some(samples)
    }
}

impl Effect for Timebase {
    /// The lines as they appear, and the ratio.
    fn truths(&self) -> Vec<Truth> {
        let mut truths = Lines(self.apparent().collect()).truths();
        truths.push(Truth::new("timebase", &[("ratio", self.ratio)]));
        truths
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        Box::new(Self {
            ratio: self.ratio,
            lines: self.lines.iter().map(|line| line.scaled(factor)).collect(),
        })
    }

    /// The lines must be seen in both records. Where they are, a shift of more than one cell of
    /// the spectrum (1/T) is a matter of course: 0.2 % is a fifth of one at the lowest line, and
    /// dozens at the others.
    fn evidence(&self, scene: &Scene) -> Evidence {
        let here = Lines(self.apparent().collect()).evidence(scene);
        here.and(Lines(self.lines.clone()).evidence(scene))
    }

    /// In true time.
    fn waveform(&self, scene: &Scene, axis: usize, draw: &mut Draw) -> Option<Vec<f64>> {
        Lines(self.lines.clone()).waveform(scene, axis, draw)
    }

    fn clock(&self) -> f64 {
        self.ratio
    }

    fn in_reference(&self) -> Option<Box<dyn Effect>> {
        Some(Box::new(Lines(self.lines.clone())))
    }
}
