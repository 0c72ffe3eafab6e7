//! A record with something hidden in it, and the truth about it.

use std::io;
use std::path::{Path, PathBuf};

use super::draw::Draw;
use super::effect::{Effect, Kind};
use super::ideal::detector::Evidence;
use super::noise::chain::filter;
use super::noise::gaussian::gaussian;
use super::npy;
use super::outside::Place;
use super::scene::Scene;
use super::strength::{Strength, unit};
use super::truth::Truth;

/// What to hide.
#[derive(Clone)]
pub struct Plan {
    /// Kinds, each in the same record; none for a clean one.
    pub kinds: Vec<&'static Kind>,
    /// How strong each.
    pub strength: Strength,
    /// Samples in the record.
    pub samples: usize,
}

impl Plan {
    /// The kinds' names, joined by `+`, or `clean`.
    pub fn name(&self) -> String {
        if self.kinds.is_empty() {
            return "clean".to_owned();
        }
        let names: Vec<&str> = self.kinds.iter().map(|kind| kind.name).collect();
        names.join("+")
    }
}

/// A record as it goes to disk.
pub struct Case {
    /// What settles it, with the plan.
    pub seed: u64,
    /// Its samples: a column an axis.
    pub columns: Vec<Vec<f64>>,
    /// Temperature, degrees Celsius.
    pub temperature: Option<Vec<f64>>,
    /// A reference record.
    pub reference: Option<Vec<Vec<f64>>>,
    /// Rate, noise and chain.
    pub scene: Scene,
    /// What is hidden. Empty for a clean record.
    pub truths: Vec<Truth>,
    /// Strength of the first kind, in multiples of strength 1.
    pub strength: Option<f64>,
    /// What the ideal detector achieves, of the first kind.
    pub ideal: Option<Evidence>,
    /// Where it shows, of what has no name.
    pub place: Option<Place>,
}

/// The files of a case, and how the program is told of them.
pub struct Files {
    /// The record.
    pub record: PathBuf,
    /// Arguments behind the record's name.
    pub arguments: Vec<String>,
}

impl Case {
    /// Draws the case of this seed. Scenes in which a kind cannot be seen at any strength, or
    /// not be told from its rival, are drawn again.
    pub fn draw(plan: &Plan, seed: u64) -> Self {
        // Every kind has its own noise, or all rows of a study would share their luck.
        let name = plan.name();
        let axes = plan.kinds.iter().map(|kind| kind.axes).max().unwrap_or(1);
        let mut draw = Draw::new(seed, &format!("{name} scene"));
        let (scene, hidden) = loop {
            let scene = Scene::draw(plan.samples, axes, &mut draw);
            let units: Option<Vec<_>> = plan
                .kinds
                .iter()
                .map(|kind| unit((kind.draw)(&scene, &mut draw).as_ref(), &scene))
                .collect();
            if let Some(units) = units {
                break (scene, units);
            }
        };
        let mut draw = Draw::new(seed, &format!("{name} strength"));
        let strengths: Vec<f64> = hidden
            .iter()
            .map(|_| match plan.strength {
                Strength::At(strength) => strength,
                Strength::Between(lo, hi) => draw.log_uniform(lo, hi),
            })
            .collect();
        let hidden: Vec<Box<dyn Effect>> = hidden
            .iter()
            .zip(&strengths)
            .map(|(effect, strength)| effect.scaled(*strength))
            .collect();
        let mut case = Self {
            seed,
            columns: Vec::new(),
            temperature: None,
            reference: None,
            truths: hidden.iter().flat_map(|effect| effect.truths()).collect(),
            strength: strengths.first().copied(),
            ideal: hidden.first().map(|effect| effect.evidence(&scene)),
            place: hidden.iter().find_map(|effect| effect.place()),
            scene,
        };
        case.fill(&hidden, &name);
        case
    }

    fn fill(&mut self, hidden: &[Box<dyn Effect>], name: &str) {
        let seed = self.seed;
        let reference = format!("{name} reference");
        for axis in 0..self.scene.axes.len() {
            let here: Vec<&dyn Effect> = hidden
                .iter()
                .map(AsRef::as_ref)
                .filter(|effect| effect.in_all_axes() || axis == self.scene.target)
                .collect();
            let (samples, settled) = axis_samples(&self.scene, axis, &here, seed, name);
            self.columns.push(samples);
            for (effect, parameters) in here.iter().zip(settled) {
                let name = effect.truths().last().map(|truth| truth.effect);
                let truth = self.truths.iter_mut().find(|t| Some(t.effect) == name);
                if let Some(truth) = truth {
                    truth.parameters.extend(parameters);
                }
            }
        }
        let temperature = hidden.iter().find_map(|effect| effect.temperature());
        self.temperature = temperature.map(<[f64]>::to_vec);
        self.reference = hidden.iter().find_map(|e| e.in_reference()).map(|effect| {
            (0..self.scene.axes.len())
                .map(|axis| axis_samples(&self.scene, axis, &[effect.as_ref()], seed, &reference).0)
                .collect()
        });
    }

    /// Writes the files into `folder`, under names that tell nothing.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<Files> {
        let record = folder.join("record.npy");
        let mut columns: Vec<&[f64]> = self.columns.iter().map(Vec::as_slice).collect();
        let mut arguments = vec![
            "--rate".to_owned(),
            self.scene.rate_hz.to_string(),
            "--unit".to_owned(),
            "m/s^2".to_owned(),
        ];
        if let Some(chain) = self.scene.chain.declared() {
            arguments.extend(["--chain".to_owned(), chain]);
        }
        if let Some(temperature) = &self.temperature {
            let axes: Vec<String> = (0..columns.len()).map(|axis| axis.to_string()).collect();
            arguments.extend(["--columns".to_owned(), axes.join(",")]);
            arguments.extend(["--temperature".to_owned(), columns.len().to_string()]);
            columns.push(temperature);
        }
        npy::write(&record, &columns)?;
        if let Some(reference) = &self.reference {
            let other = folder.join("other.npy");
            let columns: Vec<&[f64]> = reference.iter().map(Vec::as_slice).collect();
            npy::write(&other, &columns)?;
            let other = other.to_str().ok_or(io::ErrorKind::InvalidFilename)?;
            arguments.extend(["--reference".to_owned(), other.to_owned()]);
        }
        Ok(Files { record, arguments })
    }
}

/// One axis: Gaussian parts in one transform, waveforms through the chain, then what acts on
/// finished samples, whose late parameters come back in the order of `effects`. The `record`'s
/// name and `seed` name its random numbers.
pub fn axis_samples(
    scene: &Scene,
    axis: usize,
    effects: &[&dyn Effect],
    seed: u64,
    record: &str,
) -> (Vec<f64>, Vec<Vec<(String, f64)>>) {
    let stream = |name: &str| Draw::new(seed, &format!("{record} {axis} {name}"));
    // Everything happens in true time.
    let clock: f64 = effects.iter().map(|effect| effect.clock()).product();
    let scene = &Scene {
        rate_hz: scene.rate_hz * clock,
        ..scene.clone()
    };
    let count = scene.samples;
    let power = |f_hz: f64| -> f64 { effects.iter().map(|effect| effect.power(f_hz)).product() };
    let added = |f_hz: f64| -> f64 {
        let sum: f64 = effects.iter().map(|e| e.density(f_hz, scene)).sum();
        sum * scene.chain.power(f_hz, scene.rate_hz)
    };
    let envelope = effects
        .iter()
        .enumerate()
        .find_map(|(i, effect)| effect.envelope(scene, &mut stream(&format!("envelope {i}"))));
    let mut samples = if let Some(envelope) = envelope {
        let slow = |f_hz: f64| {
            let rest = scene.density(axis, f_hz) - scene.short_density(axis, f_hz);
            (rest.max(0.0) + added(f_hz)) * power(f_hz)
        };
        let short = |f_hz: f64| scene.short_density(axis, f_hz) * power(f_hz);
        let mut samples = gaussian(count, scene.rate_hz, slow, &mut stream("slow"));
        let short = gaussian(count, scene.rate_hz, short, &mut stream("short"));
        // The level that a synthesis starts at is no noise.
        let level = short.iter().sum::<f64>() / count as f64;
        for ((sample, short), factor) in samples.iter_mut().zip(&short).zip(&envelope) {
            *sample += factor * (short - level);
        }
        samples
    } else {
        let law = |f_hz: f64| (scene.density(axis, f_hz) + added(f_hz)) * power(f_hz);
        gaussian(count, scene.rate_hz, law, &mut stream("noise"))
    };
    let waveforms = effects.iter().enumerate().filter_map(|(i, effect)| {
        // The same for all axes.
        let mut draw = Draw::new(seed, &format!("{record} waveform {i}"));
        effect.waveform(scene, axis, &mut draw)
    });
    let waveform = waveforms.reduce(|mut sum, other| {
        for (a, b) in sum.iter_mut().zip(other) {
            *a += b;
        }
        sum
    });
    if let Some(mut waveform) = waveform {
        let filters = effects
            .iter()
            .any(|effect| effect.power(0.5 * scene.rate_hz) != 1.0);
        if filters || !scene.chain.is_none() {
            filter(&mut waveform, scene.rate_hz, |f_hz| {
                scene.chain.power(f_hz, scene.rate_hz) * power(f_hz)
            });
        }
        for (sample, value) in samples.iter_mut().zip(waveform) {
            *sample += value;
        }
    }
    let base = &scene.axes[axis];
    for (i, sample) in samples.iter_mut().enumerate() {
        *sample += base.mean + base.r * i as f64 / scene.rate_hz;
    }
    let settled = effects
        .iter()
        .enumerate()
        .map(|(i, e)| e.distort(&mut samples, scene, &mut stream(&format!("distortion {i}"))))
        .collect();
    (samples, settled)
}
