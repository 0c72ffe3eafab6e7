//! A record with something hidden in it, and the truth about it.

use std::io;
use std::path::{Path, PathBuf};

use super::axis::Axis;
use super::draw::Draw;
use super::effect::{Effect, Kind};
use super::ideal::detector::Evidence;
use super::npy;
use super::outside::Place;
use super::scene::Scene;
use super::strength::{Strength, unit};
use super::truth::Truth;
use super::wide;
use super::wide::form::Form;

/// What to hide.
#[derive(Clone)]
pub struct Plan {
    /// Kinds, each in the same record; none for a clean one.
    pub kinds: Vec<&'static Kind>,
    /// How strong each.
    pub strength: Strength,
    /// Samples in the record; with [`Strength::Any`] those of the longest.
    pub samples: usize,
}

/// Effects as they are hidden, and how strong each is.
type Hidden = (Vec<Box<dyn Effect>>, Vec<f64>);

impl Plan {
    /// What is hidden in this scene. None where a kind cannot be seen at any strength, or at the one drawn: a pole that
    /// is lowered until it undoes what rises towards high frequencies leaves nothing to see.
    fn hide(&self, scene: &Scene, draw: &mut Draw, strength_draw: &mut Draw) -> Option<Hidden> {
        let mut units = Vec::new();
        for kind in &self.kinds {
            units.push(unit((kind.draw)(scene, draw).as_ref(), scene)?);
        }
        let mut strengths = Vec::new();
        for (effect, kind) in units.iter().zip(&self.kinds) {
            strengths.push(match self.strength {
                Strength::At(strength) => strength,
                Strength::Between(lo, hi) => strength_draw.log_uniform(lo, hi),
                Strength::Any => {
                    let cap = wide::limits::cap(kind.name, effect.as_ref(), scene);
                    strength_draw.log_uniform(1.0, cap)
                }
            });
        }
        let scaled = units.iter().zip(&strengths);
        let hidden: Vec<_> = scaled.map(|(effect, &at)| effect.scaled(at)).collect();
        let seen = hidden
            .iter()
            .map(|effect| effect.evidence(scene).suffices());
        seen.zip(&strengths)
            .all(|(seen, &at)| seen || at <= 1.0)
            .then_some((hidden, strengths))
    }

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
    /// How it is written.
    pub form: Form,
    /// Scenes that were drawn in vain before this one.
    pub redrawn: usize,
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
    /// Size of a code, where it holds codes.
    step: Option<f64>,
    hidden: Vec<Box<dyn Effect>>,
    name: String,
}

/// The files of a case, and how the program is told of them.
pub struct Files {
    /// The record.
    pub record: PathBuf,
    /// Arguments behind the record's name.
    pub arguments: Vec<String>,
}

impl Case {
    /// Mean square of the factor on the white and quantisation terms all along the record.
    pub fn swell(&self) -> f64 {
        self.hidden.iter().map(|effect| effect.swell()).product()
    }

    /// Draws the case of this seed. Scenes in which a kind cannot be seen at any strength or at the one drawn, or not be
    /// told from its rival, are drawn again.
    pub fn draw(plan: &Plan, seed: u64) -> Self {
        // Every kind has its own noise, or all rows of a study would share their luck.
        let name = plan.name();
        let axes = plan.kinds.iter().map(|kind| kind.axes).max().unwrap_or(1);
        let mut draw = Draw::new(seed, &format!("{name} scene"));
        let any = plan.strength == Strength::Any;
        let form = match any {
            true => Form::draw(plan, seed),
            false => Form::default(),
        };
        let mut strength_draw = Draw::new(seed, &format!("{name} strength"));
        let mut redrawn = 0;
        let (scene, hidden, strengths) = loop {
            let mut scene = match any {
                true => wide::scene::draw(&plan.kinds, plan.samples, axes, &mut draw),
                false => Scene::draw(plan.samples, axes, &mut draw),
            };
            scene.missing = form.missing_at_random(scene.samples);
            scene.code = form.code_over_differences();
            if let Some((hidden, strengths)) = plan.hide(&scene, &mut draw, &mut strength_draw) {
                break (scene, hidden, strengths);
            }
            redrawn += 1;
        };
        let mut case = Self {
            seed,
            form,
            redrawn,
            columns: Vec::new(),
            temperature: None,
            reference: None,
            truths: hidden.iter().flat_map(|effect| effect.truths()).collect(),
            strength: strengths.first().copied(),
            ideal: hidden.first().map(|effect| effect.evidence(&scene)),
            place: hidden.iter().find_map(|effect| effect.place()),
            scene,
            step: None,
            hidden,
            name,
        };
        case.fill();
        let sample = |at_s: f64| (at_s * case.scene.rate_hz).round() as usize;
        let happened = case.hidden.iter().filter_map(|effect| effect.happens_s());
        let happened: Vec<_> = happened
            .map(|one| sample(one.start)..sample(one.end))
            .collect();
        case.step = case.form.settle(&mut case.columns, &happened, seed);
        case
    }

    /// Size of a code, where its numbers are multiples of one and it does not say so.
    pub fn code(&self) -> Option<f64> {
        self.step
            .filter(|_| !self.form.is_integer() || self.temperature.is_some())
    }

    /// White noise that rounding to codes adds, units of a sample times the root of a second: a twelfth of a code's square
    /// in each sample (W. R. Bennett, Bell Syst. Tech. J. 27 (1948) 446).
    pub fn rounding_n(&self) -> f64 {
        self.step.unwrap_or(0.0) / (12.0 * self.scene.rate_hz).sqrt()
    }

    fn fill(&mut self) {
        for axis in 0..self.scene.axes.len() {
            let here = self.effects(axis);
            let (samples, settled) = self.axis(axis, &here).samples();
            let names = here.iter().map(|effect| effect.truths().pop());
            let late: Vec<_> = names.zip(settled).collect();
            self.columns.push(samples);
            for (named, parameters) in late {
                let name = named.map(|truth| truth.effect);
                let truth = self.truths.iter_mut().find(|t| Some(t.effect) == name);
                if let Some(truth) = truth {
                    truth.parameters.extend(parameters);
                }
            }
        }
        let temperature = self.hidden.iter().find_map(|effect| effect.temperature());
        self.temperature = temperature.map(<[f64]>::to_vec);
        let reference = self.hidden.iter().find_map(|effect| effect.in_reference());
        self.reference = reference.map(|effect| {
            let name = format!("{} reference", self.name);
            let one =
                |axis| Axis::new(&self.scene, axis, &[effect.as_ref()], self.seed, &name).samples();
            (0..self.scene.axes.len()).map(|axis| one(axis).0).collect()
        });
    }

    /// What is hidden in an axis.
    fn effects(&self, axis: usize) -> Vec<&dyn Effect> {
        let here = |effect: &&dyn Effect| effect.in_all_axes() || axis == self.scene.target;
        self.hidden.iter().map(AsRef::as_ref).filter(here).collect()
    }

    fn axis<'a>(&'a self, axis: usize, effects: &'a [&'a dyn Effect]) -> Axis<'a> {
        Axis::new(&self.scene, axis, effects, self.seed, &self.name)
    }

    /// Expected Allan variances of the target's samples for averages over each of `ms` samples; see
    /// [`Axis::allan_variances`].
    pub fn allan_variances(&self, ms: &[u64]) -> Option<Vec<f64>> {
        let effects = self.effects(self.scene.target);
        self.axis(self.scene.target, &effects).allan_variances(ms)
    }

    /// How the program is told of the record: rate, unit, chain, and which column of the file is
    /// what. The temperature is the last column.
    pub fn arguments(&self) -> Vec<String> {
        let mut arguments = vec![
            "--rate".to_owned(),
            self.scene.rate_hz.to_string(),
            "--unit".to_owned(),
            "m/s^2".to_owned(),
        ];
        if let Some(chain) = self.scene.chain.declared().filter(|_| self.scene.declared) {
            arguments.extend(["--chain".to_owned(), chain]);
        }
        if self.temperature.is_some() {
            let axes = self.columns.len();
            let columns: Vec<String> = (0..axes).map(|axis| axis.to_string()).collect();
            arguments.extend(["--columns".to_owned(), columns.join(",")]);
            arguments.extend(["--temperature".to_owned(), axes.to_string()]);
        }
        arguments
    }

    /// Writes the files into `folder`, under names that tell nothing.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<Files> {
        let record = folder.join("record.npy");
        let columns = self.columns.iter().chain(&self.temperature);
        let columns: Vec<&[f64]> = columns.map(Vec::as_slice).collect();
        let mut arguments = self.arguments();
        match self
            .step
            .filter(|_| self.form.is_integer() && self.temperature.is_none())
        {
            Some(step) => {
                let code = |value: &f64| (value / step).round() as i32;
                let codes = self.columns.iter();
                let codes: Vec<Vec<i32>> = codes
                    .map(|column| column.iter().map(code).collect())
                    .collect();
                let codes: Vec<&[i32]> = codes.iter().map(Vec::as_slice).collect();
                npy::write(&record, &codes)?;
                arguments.extend(["--scale".to_owned(), step.to_string()]);
            }
            None => npy::write(&record, &columns)?,
        }
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
