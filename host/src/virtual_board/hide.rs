//! What a demonstration hides in the virtual board: one effect on one axis, drawn from the seed.
//!
//! Sizes are drawn in standard deviations of a detector that knows the noise: plain in the spectrum
//! or the level, far below what the eye sees among the samples.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use super::Hidden;
use crate::model::axis::ModelEffect;
use crate::model::published::{PublishedAxis, RATE_HZ};
use crate::model::random::random;
use crate::model::{PerCoefficient, Seed};

/// Stream of random numbers, another than those of the noise.
const STREAM: u64 = 2 << 48;

/// Kinds that can act on a sensor.
const KINDS: [Draw; 6] = [warm_up, sinusoid, resonance, markov, steps, hum];

/// Draws the parameters of one kind.
type Draw = fn(&mut Scene) -> (&'static str, Vec<(&'static str, f64)>);

/// Draws an effect for a record of `duration_s` seconds.
///
/// # Errors
/// In words, if the catalogue does not know what was drawn.
pub fn draw(seed: u64, duration_s: f64) -> Result<Hidden, String> {
    let stream = STREAM;
    let mut random = random(Seed { seed, stream });
    let axis = pick(&mut random, PublishedAxis::ALL.len());
    let kind = pick(&mut random, KINDS.len());
    let mut scene = Scene {
        noise: PublishedAxis::ALL[axis].coefficients(),
        duration_s,
        random,
    };
    let (name, parameters) = KINDS[kind](&mut scene);
    let parameters: BTreeMap<String, f64> = parameters
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect();
    Ok(Hidden {
        axis,
        effect: ModelEffect::new(name, &parameters)?,
        seed,
    })
}

fn pick(random: &mut Pcg64, count: usize) -> usize {
    let share = Uniform::new(0.0, 1.0).map_or(0.0, |law| law.sample(random));
    ((share * count as f64) as usize).min(count - 1)
}

/// Where an effect is hidden.
struct Scene {
    noise: PerCoefficient<f64>,
    duration_s: f64,
    random: Pcg64,
}

impl Scene {
    /// A number between two others, above zero, uniform in the logarithm.
    fn between(&mut self, from: f64, to: f64) -> f64 {
        let share: f64 = Uniform::new(0.0, 1.0).map_or(0.5, |law| law.sample(&mut self.random));
        from * (to / from).powf(share)
    }

    /// Two-sided density of the noise, ahead of the converter.
    fn density(&self, f_hz: f64) -> f64 {
        let PerCoefficient { n, q, .. } = self.noise;
        n * n + (TAU * f_hz * q).powi(2) / RATE_HZ
    }

    /// Amplitude of a line of some hundred standard deviations.
    fn line(&mut self, f_hz: f64) -> f64 {
        let deviation = (4.0 * self.density(f_hz) / self.duration_s).sqrt();
        self.between(100.0, 300.0) * deviation
    }
}

fn hum(scene: &mut Scene) -> (&'static str, Vec<(&'static str, f64)>) {
    let base_hz = [50.0, 60.0][pick(&mut scene.random, 2)] * scene.between(0.9995, 1.0005);
    let parameters = vec![
        ("f_hz", base_hz),
        ("amplitude_1", scene.line(base_hz)),
        ("amplitude_2", scene.line(2.0 * base_hz)),
    ];
    ("hum", parameters)
}

fn sinusoid(scene: &mut Scene) -> (&'static str, Vec<(&'static str, f64)>) {
    let f_hz = scene.between(0.5, 45.0);
    let amplitude = scene.line(f_hz);
    ("sinusoid", vec![("f_hz", f_hz), ("amplitude", amplitude)])
}

fn resonance(scene: &mut Scene) -> (&'static str, Vec<(&'static str, f64)>) {
    let f_hz = scene.between(10.0, 80.0);
    let width_hz = f_hz / scene.between(10.0, 40.0);
    // Its peak has the density amplitude^2 / (pi width).
    let peak = scene.between(1.0, 5.0) * scene.density(f_hz);
    let amplitude = (PI * width_hz * peak).sqrt();
    let parameters = vec![
        ("f_hz", f_hz),
        ("width_hz", width_hz),
        ("amplitude", amplitude),
    ];
    ("resonance", parameters)
}

fn markov(scene: &mut Scene) -> (&'static str, Vec<(&'static str, f64)>) {
    let time_s = scene.between(0.1, 0.5);
    // At low frequencies it has the density 2 amplitude^2 time.
    let shelf = scene.between(1.0, 4.0) * scene.noise.n.powi(2);
    let amplitude = (0.5 * shelf / time_s).sqrt();
    ("markov", vec![("time_s", time_s), ("amplitude", amplitude)])
}

/// Standard deviation of the height of a step that is fitted by itself: white noise is averaged
/// until the walk has gone as far.
fn level_deviation(noise: &PerCoefficient<f64>) -> f64 {
    (2.0 * noise.n * noise.k).sqrt()
}

fn steps(scene: &mut Scene) -> (&'static str, Vec<(&'static str, f64)>) {
    let height = scene.between(20.0, 60.0) * level_deviation(&scene.noise);
    let time_s = scene.between(0.3, 0.7) * scene.duration_s;
    ("steps", vec![("time_s_1", time_s), ("height_1", height)])
}

fn warm_up(scene: &mut Scene) -> (&'static str, Vec<(&'static str, f64)>) {
    // A slow change is known as well as the walk lets it.
    let time_s = scene.between(0.01, 0.04) * scene.duration_s;
    let amplitude = scene.between(15.0, 40.0) * scene.noise.k * time_s.sqrt();
    ("warmup", vec![("amplitude", amplitude), ("time_s", time_s)])
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_kind_and_axis_is_drawn_and_can_act_on_a_sensor() {
        let mut seen = BTreeSet::new();
        for seed in 1..=100 {
            let hidden = draw(seed, 3600.0).expect("the catalogue knows it");
            assert!(
                matches!(hidden.effect.part(), crate::model::effect::Part::Term(_)),
                "seed {seed}: {:?} adds nothing to the signal",
                hidden.effect
            );
            seen.insert((hidden.axis, hidden.effect.kind().name()));
        }
        assert_eq!(seen.len(), 3 * KINDS.len());
    }
}
