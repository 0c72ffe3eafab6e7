//! One axis of a record: what it is made of, its samples, and the Allan variance to expect of them.

use super::draw::Draw;
use super::effect::{Distorts, Effect};
use super::noise::allan;
use super::noise::chain::filter;
use super::noise::gaussian::gaussian;
use super::scene::Scene;

/// One axis with what is hidden in it.
pub struct Axis<'a> {
    /// In true time: everything happens in it, whatever rate the record says.
    scene: Scene,
    axis: usize,
    effects: &'a [&'a dyn Effect],
    seed: u64,
    record: &'a str,
}

impl<'a> Axis<'a> {
    /// Number `axis` of a scene with these effects in it. The `record`'s name and `seed` name its
    /// random numbers.
    pub fn new(
        scene: &Scene,
        axis: usize,
        effects: &'a [&'a dyn Effect],
        seed: u64,
        record: &'a str,
    ) -> Self {
        let clock: f64 = effects.iter().map(|effect| effect.clock()).product();
        Self {
            scene: Scene {
                rate_hz: scene.rate_hz * clock,
                ..scene.clone()
            },
            axis,
            effects,
            seed,
            record,
        }
    }

    /// Gaussian parts in one transform, waveforms through the chain, then what acts on finished
    /// samples, whose late parameters come back in the order of the effects.
    pub fn samples(&self) -> (Vec<f64>, Vec<Vec<(String, f64)>>) {
        let mut samples = self.undistorted();
        let settled = (0..self.effects.len()).map(|i| self.distort(i, &mut samples));
        let settled = settled.collect();
        (samples, settled)
    }

    /// Expected Allan variances of the samples for averages over each of `ms` of them: of the laws of
    /// all noise, and of courses and bad samples as they are in this very record. None where an effect
    /// changes the samples in a way that has no such law.
    pub fn allan_variances(&self, ms: &[u64]) -> Option<Vec<f64>> {
        let distorts: Vec<Distorts> = self
            .effects
            .iter()
            .map(|e| e.distorts(&self.scene))
            .collect();
        if distorts.contains(&Distorts::Beyond) {
            return None;
        }
        let mut course = self.waveform();
        for (i, value) in course.iter_mut().enumerate() {
            *value += self.ramp(i);
        }
        let adds = distorts.contains(&Distorts::Adds);
        let mut samples = adds.then(|| self.undistorted());
        for (i, distorts) in distorts.iter().enumerate() {
            let before = samples.clone();
            if let Some(samples) = &mut samples {
                self.distort(i, samples);
            }
            match (distorts, before, &samples) {
                (Distorts::Adds, Some(before), Some(after)) => {
                    let added = after
                        .iter()
                        .zip(&before)
                        .map(|(after, before)| after - before);
                    course
                        .iter_mut()
                        .zip(added)
                        .for_each(|(value, added)| *value += added);
                }
                _ => {
                    self.distort(i, &mut course);
                }
            }
        }
        let strength = self.envelope().map(|factors| mean_square(&factors));
        let noise = allan::of_law(self.scene.rate_hz, ms, |f_hz| match strength {
            Some(strength) => self.slow(f_hz) + strength * self.short(f_hz),
            None => self.law(f_hz),
        });
        let course = allan::of_course(&course, ms);
        Some(noise.iter().zip(course).map(|(a, b)| a + b).collect())
    }

    fn undistorted(&self) -> Vec<f64> {
        let mut samples = self.noise();
        for (sample, value) in samples.iter_mut().zip(self.waveform()) {
            *sample += value;
        }
        let mean = self.scene.axes[self.axis].mean;
        for (i, sample) in samples.iter_mut().enumerate() {
            *sample += mean + self.ramp(i);
        }
        samples
    }

    fn distort(&self, effect: usize, samples: &mut Vec<f64>) -> Vec<(String, f64)> {
        let mut draw = self.stream(&format!("distortion {effect}"));
        self.effects[effect].distort(samples, &self.scene, &mut draw)
    }

    fn ramp(&self, index: usize) -> f64 {
        self.scene.axes[self.axis].r * index as f64 / self.scene.rate_hz
    }

    fn noise(&self) -> Vec<f64> {
        let (count, rate_hz) = (self.scene.samples, self.scene.rate_hz);
        let Some(envelope) = self.envelope() else {
            return gaussian(
                count,
                rate_hz,
                |f_hz| self.law(f_hz),
                &mut self.stream("noise"),
            );
        };
        let slow = &mut self.stream("slow");
        let mut samples = gaussian(count, rate_hz, |f_hz| self.slow(f_hz), slow);
        // Strength changes in the sensor: what passes is smoothed behind it.
        let ahead = |f_hz: f64| self.scene.short_ahead(self.axis, f_hz);
        let mut short = gaussian(count, rate_hz, ahead, &mut self.stream("short"));
        // The level that a synthesis starts at is no noise.
        let level = short.iter().sum::<f64>() / count as f64;
        for (sample, factor) in short.iter_mut().zip(&envelope) {
            *sample = factor * (*sample - level);
        }
        self.pass(&mut short);
        add_all(&mut samples, [short].into_iter());
        samples
    }

    /// All that is added ahead of the chain, behind it.
    fn waveform(&self) -> Vec<f64> {
        let scene = &self.scene;
        // The same for all axes.
        let draw = |i: usize| Draw::new(self.seed, &format!("{} waveform {i}", self.record));
        let effects = || self.effects.iter().enumerate();
        let waveforms =
            effects().filter_map(|(i, one)| one.waveform(scene, self.axis, &mut draw(i)));
        let mut sum = vec![0.0; scene.samples];
        let any = add_all(&mut sum, waveforms);
        if any {
            self.pass(&mut sum);
        }
        let gain = |f_hz: f64| self.passed(f_hz).sqrt();
        add_all(
            &mut sum,
            effects().filter_map(|(i, one)| one.tones(scene, &mut draw(i), &gain)),
        );
        sum
    }

    fn envelope(&self) -> Option<Vec<f64>> {
        self.effects.iter().enumerate().find_map(|(i, effect)| {
            let mut draw = self.stream(&format!("envelope {i}"));
            effect.envelope(&self.scene, &mut draw)
        })
    }

    /// Two-sided density of all Gaussian parts without an envelope, per hertz.
    fn law(&self, f_hz: f64) -> f64 {
        let scene = &self.scene;
        let own: f64 = self.effects.iter().map(|e| e.density(f_hz, scene)).sum();
        let own = own * scene.chain.power(f_hz, scene.rate_hz);
        (scene.density(self.axis, f_hz) + own) * self.power(f_hz)
    }

    /// The part of it that an envelope multiplies.
    fn short(&self, f_hz: f64) -> f64 {
        self.scene.short_density(self.axis, f_hz) * self.power(f_hz)
    }

    /// Lets through what the chain and the effects let through.
    fn pass(&self, samples: &mut [f64]) {
        let scene = &self.scene;
        if self.power(0.5 * scene.rate_hz) != 1.0 || !scene.chain.is_none() {
            filter(samples, scene.rate_hz, |f_hz| self.passed(f_hz));
        }
    }

    /// Power of the chain and of all effects together.
    fn passed(&self, f_hz: f64) -> f64 {
        self.scene.chain.power(f_hz, self.scene.rate_hz) * self.power(f_hz)
    }

    /// The rest.
    fn slow(&self, f_hz: f64) -> f64 {
        (self.law(f_hz) - self.short(f_hz)).max(0.0)
    }

    /// Factor of all effects on the spectrum.
    fn power(&self, f_hz: f64) -> f64 {
        self.effects
            .iter()
            .map(|effect| effect.power(f_hz))
            .product()
    }

    fn stream(&self, name: &str) -> Draw {
        Draw::new(self.seed, &format!("{} {} {name}", self.record, self.axis))
    }
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64
}

/// Adds series of samples to a sum; whether there are any.
fn add_all(sum: &mut [f64], all: impl Iterator<Item = Vec<f64>>) -> bool {
    let mut any = false;
    for one in all {
        any = true;
        sum.iter_mut()
            .zip(one)
            .for_each(|(sum, value)| *sum += value);
    }
    any
}
