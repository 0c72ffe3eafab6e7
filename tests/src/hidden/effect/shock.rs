//! Short transients: some ring and die away, some are bare bumps.

use std::f64::consts::{PI, TAU};

use super::{Effect, Evidence, Scene, Truth};
use crate::hidden::draw::Draw;
use crate::hidden::ideal::detector::power;
use crate::hidden::ideal::matched::energy;

/// One transient of height 1.
#[derive(Clone, Copy)]
enum Form {
    Rings { f_hz: f64, decay_s: f64 },
    Bump { length_s: f64 },
}

#[derive(Clone, Copy)]
struct Blow {
    at_s: f64,
    peak: f64,
    form: Form,
}

struct Shock {
    blows: Vec<Blow>,
    /// Non-centrality of the weakest, each by itself, at these heights.
    weakest: f64,
}

/// Shortest and longest decay, or bump, seconds.
const SHORTEST_S: f64 = 5e-3;
const LONGEST_S: f64 = 2.0;

/// Decays after which less is left than a millionth.
const LASTING: f64 = 14.0;

/// One to four anywhere in the record, its ends included, a fiftieth of it apart; each as plain as the others within
/// a factor of two. Three in four ring: from two thirds of a turn in a decay on, and twenty samples a decay at least.
pub fn draw(scene: &Scene, draw: &mut Draw) -> Box<dyn Effect> {
    let count = 1 + draw.index(4);
    let duration_s = scene.duration_s();
    let mut blows: Vec<Blow> = Vec::new();
    while blows.len() < count {
        let form = drawn(scene, draw);
        let at_s = draw.uniform(0.0, duration_s - form.seen_s());
        if blows
            .iter()
            .any(|other| (other.at_s - at_s).abs() < duration_s / 50.0)
        {
            continue;
        }
        let one = Blow {
            at_s,
            peak: 1.0,
            form,
        };
        let plain = energy(&course(&[one], scene), scene, scene.target).sqrt();
        let peak = draw.sign() * draw.log_uniform(1.0, 2.0) / plain;
        blows.push(Blow { peak, ..one });
    }
    blows.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    let weakest = blows
        .iter()
        .map(|blow| energy(&course(&[*blow], scene), scene, scene.target))
        .fold(f64::INFINITY, f64::min);
    Box::new(Shock { blows, weakest })
}

fn drawn(scene: &Scene, draw: &mut Draw) -> Form {
    let rate_hz = scene.rate_hz;
    let shortest_s = SHORTEST_S.max(20.0 / rate_hz);
    let time_s = draw.log_uniform(shortest_s, LONGEST_S.max(2.0 * shortest_s));
    if draw.chance(0.25) {
        return Form::Bump { length_s: time_s };
    }
    loop {
        let f_hz = draw.log_uniform(2.0 / (3.0 * time_s), 0.4 * rate_hz);
        if scene.passes(f_hz) {
            return Form::Rings {
                f_hz,
                decay_s: time_s,
            };
        }
    }
}

impl Form {
    /// Height `t_s` after its beginning, not scaled.
    fn at(self, t_s: f64) -> f64 {
        match self {
            Self::Rings { f_hz, decay_s } => (-t_s / decay_s).exp() * (TAU * f_hz * t_s).sin(),
            Self::Bump { length_s } => (PI * t_s / length_s).sin(),
        }
    }

    /// The largest of these heights. Ringing is highest where its slope is zero: `tan wt = w decay`.
    fn highest(self) -> f64 {
        match self {
            Self::Rings { f_hz, decay_s } => {
                let turn = TAU * f_hz * decay_s;
                (-turn.atan() / turn).exp() * turn / 1.0_f64.hypot(turn)
            }
            Self::Bump { .. } => 1.0,
        }
    }

    /// Seconds in which most of it happens.
    fn seen_s(self) -> f64 {
        match self {
            Self::Rings { decay_s, .. } => decay_s,
            Self::Bump { length_s } => length_s,
        }
    }

    /// Seconds after which nothing is left.
    fn length_s(self) -> f64 {
        match self {
            Self::Rings { decay_s, .. } => LASTING * decay_s,
            Self::Bump { length_s } => length_s,
        }
    }
}

fn course(blows: &[Blow], scene: &Scene) -> Vec<f64> {
    let mut samples = vec![0.0; scene.samples];
    for blow in blows {
        let size = blow.peak / blow.form.highest();
        let first = (blow.at_s * scene.rate_hz).ceil() as usize;
        let count = (blow.form.length_s() * scene.rate_hz) as usize;
        for (i, sample) in samples.iter_mut().enumerate().skip(first).take(count) {
            let t_s = i as f64 / scene.rate_hz - blow.at_s;
            *sample += size * blow.form.at(t_s);
        }
    }
    samples
}

impl Effect for Shock {
    fn truths(&self) -> Vec<Truth> {
        let mut parameters = Vec::new();
        for (number, blow) in (1..).zip(&self.blows) {
            let mut say = |name: &str, value| parameters.push((format!("{name}_{number}"), value));
            say("time_s", blow.at_s);
            say("peak", blow.peak);
            match blow.form {
                Form::Rings { f_hz, decay_s } => {
                    say("f_hz", f_hz);
                    say("decay_s", decay_s);
                }
                Form::Bump { length_s } => say("duration_s", length_s),
            }
        }
        vec![Truth {
            effect: "shock",
            parameters,
        }]
    }

    fn scaled(&self, factor: f64) -> Box<dyn Effect> {
        let blows = self.blows.iter().map(|blow| Blow {
            peak: blow.peak * factor,
            ..*blow
        });
        Box::new(Self {
            blows: blows.collect(),
            weakest: self.weakest * factor * factor,
        })
    }

    /// Each by itself, mean and ramp fitted too. Trials: all moments and frequencies together are as many places as
    /// there are samples for one decay; six octaves of decays.
    fn evidence(&self, scene: &Scene) -> Evidence {
        Evidence::power(power(self.weakest, 3.0, 6.0 * scene.samples as f64))
    }

    fn waveform(&self, scene: &Scene, _axis: usize, _draw: &mut Draw) -> Option<Vec<f64>> {
        Some(course(&self.blows, scene))
    }
}
