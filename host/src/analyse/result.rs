//! What an analysis finds out, as plain data: what `--json` writes (schema 1).

use serde::Serialize;

use crate::bins::record::Overlap;
use crate::clocks::Clocks;
use crate::fit::result::Fits;
use crate::navigate::Growth;
use crate::signal::Unit;

/// Everything that was found out about a record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// Version of this structure.
    pub schema: u32,
    /// What was analysed.
    pub source: SourceSummary,
    /// The axes.
    pub axes: Vec<AxisAnalysis>,
}

/// What was analysed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SourceSummary {
    /// File, port or the like.
    pub file: String,
    /// Samples a second.
    pub rate_hz: f64,
    /// Samples a second by the stamps of the board that recorded; `None` for other records, and for
    /// less than a second.
    pub measured_rate_hz: Option<f64>,
    /// The same with its uncertainty, and by the clock of the host that recorded, where it noted that down; as
    /// `measured_rate_hz`, but left out where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clocks: Option<Clocks>,
    /// Unit of the first axis.
    pub unit: Option<Unit>,
    /// Samples an axis that arrived.
    pub samples: u64,
    /// Time that they and the gaps of known length cover, seconds.
    pub duration_s: f64,
    /// Samples known to be missing from all axes.
    pub lost_samples: u64,
    /// Gaps in all axes.
    pub gaps: Vec<GapSummary>,
    /// What does not count of one axis alone, for each axis that has any.
    pub unusable: Vec<UnusableSummary>,
    /// What else was noticed while reading, in words, oldest first.
    pub news: Vec<String>,
    /// Signal chain of the first axis.
    pub chain: Option<String>,
}

/// Samples missing from all axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GapSummary {
    /// Time of the first missing sample since the start, seconds.
    pub from_s: f64,
    /// Length in seconds, where it is known.
    pub duration_s: Option<f64>,
    /// Missing samples, where the number is known.
    pub samples: Option<u64>,
    /// Why, in words.
    pub cause: String,
}

/// Samples of one axis alone that do not count: no numbers, infinite, clipped or torn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnusableSummary {
    /// Name of the axis.
    pub axis: String,
    /// How many.
    pub samples: u64,
    /// Stretches that they lie in.
    pub stretches: u64,
    /// Time of the first since the start, seconds.
    pub first_s: f64,
    /// Length of the longest stretch, seconds.
    pub longest_s: f64,
}

/// One axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisAnalysis {
    /// Its name.
    pub name: String,
    /// Unit of the signal.
    pub unit: Unit,
    /// Its signal chain, as for `--chain`.
    pub chain: Option<String>,
    /// Mean of the signal.
    pub mean: Option<f64>,
    /// Samples that count.
    pub samples: u64,
    /// Samples of this axis alone that were left out (clipped, torn, not a number).
    pub invalid_samples: u64,
    /// Which overlap the estimates have.
    pub overlap: Overlap,
    /// Allan deviation.
    pub allan: Vec<CurvePoint>,
    /// Modified Allan deviation.
    pub modified: Vec<CurvePoint>,
    /// Hadamard deviation.
    pub hadamard: Vec<CurvePoint>,
    /// Spectral density, by ascending frequency.
    pub spectrum: Vec<SpectrumPoint>,
    /// The fits.
    pub fits: Fits,
    /// Predicted growth of the integral's error; `None` where it was not computed.
    pub velocity_error: Option<Vec<Growth>>,
    /// The fitted curves, for plots; they follow from the coefficients and are not in the JSON.
    #[serde(skip)]
    pub curves: Vec<CurveModel>,
}

/// What the fits say of one point of the Allan curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveModel {
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// Deviation that the likelihood fit expects, or the weighted fit where there is none; chain and
    /// sampling included.
    pub fitted: Option<f64>,
    /// Deviation of the published fit's curve; `None` where its square is negative.
    pub published: Option<f64>,
}

/// One point of a deviation curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// Averaging time, data periods.
    pub m: u64,
    /// The deviation, in the unit of the signal.
    pub adev: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
    /// Equivalent degrees of freedom.
    pub edf: f64,
    /// Whether it is made from block means across gaps, for want of whole differences.
    pub bridged: bool,
    /// How many times too large the square of `adev` comes out for white noise; 1 unless bridged.
    pub white_bias: f64,
}

/// One bin of the spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SpectrumPoint {
    /// Mean frequency, hertz.
    pub f_hz: f64,
    /// Two-sided density, squared unit of the signal per hertz.
    pub psd: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
    /// Degrees of freedom behind it.
    pub edf: f64,
}
