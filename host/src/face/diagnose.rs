//! The diagnosis of a record: a source in, a plain result out. Reports only format it.

use crate::analyse::{SCHEMA, summary};
use crate::diagnosis::detect::held::Held;
use crate::diagnosis::detect::timebase::{clock, counted};
use crate::diagnosis::options::Options;
use crate::diagnosis::record::samples::Samples;
use crate::diagnosis::result::finding::{Diagnosis, Finding};
use crate::diagnosis::run as axes;
use crate::model::kind::Kind;
use crate::source::{Source, SourceError};

use crate::diagnosis::family::level_of_one_test;
pub use crate::diagnosis::refused::Refused;
pub use axes::{Progress, Step};

/// Probability of any finding where nothing is hidden, unless another level is given: one record in two
/// hundred is accused of something for nothing.
pub const FAMILY_LEVEL: f64 = 0.005;

/// What a diagnosis is given together with the record.
pub struct DiagnosisOptions<'a> {
    /// Probability at most of any finding or remark where nothing is hidden, between 0 and 1.
    pub family_level: f64,
    /// The temperature, one value a sample; gains are stated for one unit of it.
    pub temperature: Option<Vec<f64>>,
    /// Another record of the same axes: shows whether this one was taken at the rate that it says, where no clock
    /// has counted its samples.
    pub reference: Option<&'a mut dyn Source>,
    /// Kinds that are suspected, as [`find_kind`](crate::find_kind) gives them: of each that is not found it is told
    /// how near it comes to a name, and how large it may be. Nothing else depends on them.
    pub suspects: Vec<Kind>,
    /// Whether pictures are wanted, with a simulated record of the last model next to the measured
    /// one: text needs none.
    pub views: bool,
}

impl Default for DiagnosisOptions<'_> {
    /// The record alone at [`FAMILY_LEVEL`], with pictures.
    fn default() -> Self {
        Self {
            family_level: FAMILY_LEVEL,
            temperature: None,
            reference: None,
            suspects: Vec::new(),
            views: true,
        }
    }
}

/// Why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
pub enum DiagnosisError {
    /// A source ended early.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The record holds too little, or nothing that could be diagnosed.
    #[error(transparent)]
    Refused(#[from] Refused),
}

/// Reads `source` to its end and finds out what the five terms get wrong about it, why, and what
/// the extended model gains. `progress` is called with the name of an axis and what has come of it, by several
/// threads.
///
/// # Errors
/// [`DiagnosisError::Source`] where the source or the reference ends early,
/// [`DiagnosisError::Refused`] where an axis holds too little or nothing that can be fitted.
///
/// ```
/// use inm_host::{DiagnosisOptions, Model, diagnose, simulate};
///
/// // White noise, and a line of a hundredth of its deviation that the diagnosis does not know of.
/// let model = Model::from_json(
///     r#"{ "schema": 1, "rate_hz": 100, "axes": [ { "name": "X",
///          "coefficients": { "N": 1e-3 },
///          "effects": [ { "effect": "sinusoid",
///                         "parameters": { "f_hz": 7.3, "amplitude": 2e-3 } } ] } ] }"#,
/// )?;
/// let mut record = simulate(&model, 16_384, 1, None)?;
/// let diagnosis = diagnose(&mut record, DiagnosisOptions::default(), &|_, _| {})?;
/// let found = &diagnosis.axes[0].findings[0];
/// assert_eq!(found.effect.name(), "sinusoid");
/// let f_hz = found.parameters()["f_hz"];
/// assert!(f_hz.lo <= Some(7.3) && Some(7.3) <= f_hz.hi);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn diagnose(
    source: &mut dyn Source,
    options: DiagnosisOptions<'_>,
    progress: &Progress<'_>,
) -> Result<Diagnosis, DiagnosisError> {
    let reference = match options.reference {
        Some(reference) => Some(Samples::read(reference, |_| {})?.0),
        None => None,
    };
    let (mut samples, mut account) = Samples::read(source, |_| {})?;
    account.clocks = source.clocks();
    let family_level = options.family_level;
    let mut options = Options {
        family_level,
        covariate: options.temperature,
        suspects: options.suspects,
        views: options.views,
    };
    // Two ways to ask the same share the level.
    let ways = u32::from(reference.is_some()) + u32::from(account.clocks.is_some());
    let level = level_of_one_test(&options) / f64::from(ways.max(1));
    let mut clock = reference.map_or_else(Vec::new, |reference| clock(&samples, &reference, level));
    if let Some(clocks) = &account.clocks {
        let (nominal_hz, axes) = (samples.signal.rate_hz, samples.axes.len());
        clock = counted(clocks, nominal_hz, axes, level, clock);
    }
    at_clock(&mut samples, &clock);
    let signal = samples.signal.clone();
    let held = Held::of(&samples, level_of_one_test(&options))?;
    if let Some(held) = &held {
        samples = held.values(&samples);
        options.covariate = options.covariate.map(|column| held.beside(&column));
    }
    let mut diagnosed = axes::diagnose(samples, &options, progress)?;
    for (number, finding) in clock {
        diagnosed.axes[number].findings.push(finding);
    }
    for axis in &mut diagnosed.axes {
        if let Some(held) = &held {
            held.tell(axis, signal.rate_hz);
        }
        let found = |kind| axis.findings.iter().any(|one| one.effect == kind);
        axis.suspicions.retain(|one| !found(one.effect));
    }
    Ok(Diagnosis {
        schema: SCHEMA,
        source: summary(&signal, &account),
        family_level,
        axes: diagnosed.axes,
        correlation: diagnosed.correlation,
    })
}

/// A declared pole is where the record's own clock has it.
fn at_clock(samples: &mut Samples, clock: &[(usize, Finding)]) {
    if let Some(ratio) = clock.first().and_then(|(_, off)| off.estimate.values[0]) {
        for axis in &mut samples.signal.axes {
            axis.chain = axis.chain.as_ref().map(|chain| chain.at_clock(ratio.value));
        }
    }
}
