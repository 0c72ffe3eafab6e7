//! A stretch of a real record with one effect in it.

use std::io;
use std::path::Path;

use super::stretch::Stretch;
use crate::hidden::case::Files;
use crate::hidden::draw::Draw;
use crate::hidden::effect::{Effect, KINDS, Kind};
use crate::hidden::noise::chain::filter;
use crate::hidden::noise::gaussian::gaussian;
use crate::hidden::npy;
use crate::hidden::strength::unit;
use crate::hidden::truth::Truth;
use crate::hidden::wide::limits;

/// Kinds that need what a bare axis does not have: other axes, a temperature, a record of the same sensor at a known
/// rate.
const NEED_MORE: [&str; 3] = ["common_mode", "thermal", "timebase"];

/// What codes have already: values that come again.
const OF_CODES: [&str; 3] = ["quantisation", "stale", "clipping"];

/// What filters do: of a stretch that has gone through one, another is no finding of its own.
const FILTERS: [&str; 3] = ["rolloff", "averaging", "converter"];

/// Share that rounding to codes has of what is fastest, at most, where a filter is added ahead of it: with more it is
/// rounding that is seen behind the filter.
const ROUNDED: f64 = 0.1;

/// What a stretch with repeats is called.
const REPEATS: [&str; 2] = ["stale", "held"];

/// Strengths, in multiples of what an ideal detector needs in the stretch's own law.
const STRENGTHS: (f64, f64) = (2.0, 100.0);

/// Effects that are drawn until an ideal detector can see one.
const TRIES: usize = 20;

/// A stretch with something in it.
pub struct Case {
    /// What was added.
    pub kind: &'static Kind,
    /// How strong, in multiples of strength 1.
    pub strength: f64,
    /// The truth about it.
    pub truths: Vec<Truth>,
    /// The stretch, and the effect.
    pub samples: Vec<f64>,
}

/// Kinds that have room in the stretch and are none of the names `held` that it has already, in an order of its own.
pub fn kinds(stretch: &Stretch, held: &[String]) -> Vec<&'static Kind> {
    let has_room = |kind: &&Kind| {
        limits::of(kind.name).is_none_or(|limit| {
            stretch.samples.len() >= limit.samples && stretch.scene.rate_hz >= limit.rate_hz
        })
    };
    let is_there = |name: &str| held.iter().any(|other| other == name);
    let is_of_codes = |name: &str| stretch.code.is_some() && OF_CODES.contains(&name);
    let filtered = FILTERS.into_iter().any(is_there) || stretch.rounding() > ROUNDED;
    let is_out = |name: &str| {
        NEED_MORE.contains(&name) || is_of_codes(name) || filtered && FILTERS.contains(&name)
    };
    let is_wanted = |kind: &&Kind| !is_there(kind.name) && !is_out(kind.name);
    let all = KINDS.iter().filter(has_room).filter(is_wanted);
    let mut all: Vec<&Kind> = all.collect();
    let mut draw = Draw::new(stretch.seed, "kinds");
    for last in (1..all.len()).rev() {
        all.swap(last, draw.index(last + 1));
    }
    all
}

impl Case {
    /// Adds an effect of this kind to a stretch that has the names `held` already. None where an ideal detector sees none
    /// of them at any strength.
    pub fn draw(stretch: &Stretch, held: &[String], kind: &'static Kind) -> Option<Self> {
        let scene = &stretch.scene;
        let mut draw = Draw::new(stretch.seed, &format!("{} added", kind.name));
        let effect =
            (0..TRIES).find_map(|_| unit((kind.draw)(scene, &mut draw).as_ref(), scene))?;
        let (least, most) = STRENGTHS;
        let most = limits::cap(kind.name, effect.as_ref(), scene).clamp(least, most);
        let strength = draw.log_uniform(least, most);
        let effect = effect.scaled(strength);
        let mut truths = effect.truths();
        let repeats = held.iter().any(|name| REPEATS.contains(&name.as_str()));
        let (samples, late) = add(stretch, effect.as_ref(), repeats, &mut draw);
        if let Some(truth) = truths.last_mut() {
            truth.parameters.extend(late);
        }
        Some(Self {
            kind,
            strength,
            truths,
            samples,
        })
    }
}

/// The stretch with the effect in it, on the grid of its codes, repeating itself where it did, and parameters that only
/// the samples settle.
fn add(
    stretch: &Stretch,
    effect: &dyn Effect,
    repeats: bool,
    draw: &mut Draw,
) -> (Vec<f64>, Vec<(String, f64)>) {
    let scene = &stretch.scene;
    let mut samples = stretch.samples.clone();
    if effect.power(0.5 * scene.rate_hz) != 1.0 {
        filter(&mut samples, scene.rate_hz, |f_hz| effect.power(f_hz));
    }
    if let Some(envelope) = effect.envelope(scene, draw) {
        stretch.unround(&mut samples, &envelope, draw);
        multiply(&mut samples, &envelope, stretch);
    }
    let noise = has_law(effect, stretch).then(|| {
        let law = |f_hz: f64| effect.density(f_hz, scene);
        gaussian(samples.len(), scene.rate_hz, law, draw)
    });
    let waveform = effect.waveform(scene, 0, draw);
    let tones = effect.tones(scene, draw, &|_| 1.0);
    for added in noise.iter().chain(&waveform).chain(&tones) {
        samples
            .iter_mut()
            .zip(added)
            .for_each(|(sample, added)| *sample += added);
    }
    if repeats {
        stretch.repeat(&mut samples);
    }
    let late = effect.distort(&mut samples, scene, draw);
    stretch.round(&mut samples);
    (samples, late)
}

/// Whether the effect adds noise.
fn has_law(effect: &dyn Effect, stretch: &Stretch) -> bool {
    let scene = &stretch.scene;
    let mut places = (1..64).map(|place| 0.5 * scene.rate_hz * f64::from(place) / 64.0);
    places.any(|f_hz| effect.density(f_hz, scene) > 0.0)
}

/// Multiplies what is fast of the samples.
fn multiply(samples: &mut [f64], envelope: &[f64], stretch: &Stretch) {
    let Some(law) = &stretch.scene.measured else {
        return;
    };
    let mut fast = samples.to_vec();
    let level = fast.iter().sum::<f64>() / fast.len() as f64;
    fast.iter_mut().for_each(|sample| *sample -= level);
    // The filter takes powers: what it leaves of an amplitude is the share.
    filter(&mut fast, stretch.scene.rate_hz, |f_hz| match f_hz > 0.0 {
        true => law.short(f_hz).powi(2),
        false => 0.0,
    });
    for ((sample, fast), factor) in samples.iter_mut().zip(&fast).zip(envelope) {
        *sample += (factor - 1.0) * fast;
    }
}

/// Writes `samples` of a stretch as a record into `folder`, under a name that tells nothing: codes as integers.
///
/// # Errors
/// If it cannot be written.
pub fn write(samples: &[f64], stretch: &Stretch, folder: &Path) -> io::Result<Files> {
    let record = folder.join("record.npy");
    let rate_hz = stretch.scene.rate_hz.to_string();
    let mut arguments = ["--rate", &rate_hz, "--unit", "m/s^2"]
        .map(str::to_owned)
        .to_vec();
    match stretch.code {
        Some(code) => {
            let codes: Vec<i32> = samples
                .iter()
                .map(|sample| (sample / code).round() as i32)
                .collect();
            npy::write(&record, &[&codes[..]])?;
            arguments.extend(["--scale".to_owned(), code.to_string()]);
        }
        None => npy::write(&record, &[samples])?,
    }
    Ok(Files { record, arguments })
}
