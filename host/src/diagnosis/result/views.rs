//! What a diagnosis looks like, as numbers: measured, modelled and simulated side by side.

use serde::Serialize;

use crate::model::kind::Kind;

/// The views of one axis; all of them empty where none were wanted.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Views {
    /// Points of the Allan deviation, by ascending time.
    pub allan: Vec<AllanPoint>,
    /// That of the held-out half, where it says how far the models are off.
    pub held_out: Vec<HeldPoint>,
    /// Points of the spectral density, by ascending frequency.
    pub spectrum: Vec<SpectrumPoint>,
    /// Growth of the velocity error.
    pub velocity_error: Vec<VelocityError>,
    /// Seed of the simulated record; `None` where the model makes none.
    pub simulation_seed: Option<u64>,
    /// The record in time; for pictures alone.
    #[serde(skip)]
    pub course: Course,
    /// Law of the whitened amplitudes; for pictures alone.
    #[serde(skip)]
    pub amplitudes: Amplitudes,
}

/// One averaging time. All deviations are in the unit of the signal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AllanPoint {
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// Averaging time, samples.
    pub m: u64,
    /// Measured deviation, in the unit of the signal.
    pub adev: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
    /// Equivalent degrees of freedom of the measured variance.
    pub edf: f64,
    /// How many times the averaging time fits into the record.
    pub intervals: u64,
    /// What the five terms alone expect.
    pub before: f64,
    /// What the extended model expects.
    pub after: f64,
    /// That of the simulated record.
    pub simulated: Option<f64>,
}

/// One averaging time of the held-out half. Deviations are in the unit of the signal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HeldPoint {
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// Averaging time, samples.
    pub m: u64,
    /// Measured deviation, in the unit of the signal.
    pub adev: f64,
    /// Equivalent degrees of freedom behind it, 1000 or more.
    pub edf: f64,
    /// What the five terms alone expect.
    pub before: f64,
    /// What the extended model expects.
    pub after: f64,
}

/// Neighbouring bins as one. Densities are two-sided, squared units of the signal per hertz.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SpectrumPoint {
    /// Mean frequency, hertz.
    pub f_hz: f64,
    /// Measured two-sided density, squared unit of the signal per hertz.
    pub psd: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
    /// Degrees of freedom behind it.
    pub edf: f64,
    /// What the five terms alone expect.
    pub before: f64,
    /// What the extended model expects.
    pub after: f64,
    /// That of the simulated record.
    pub simulated: Option<f64>,
}

/// Error of the integral after some time; unit of the signal times seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VelocityError {
    /// Time of integration, seconds.
    pub t_s: f64,
    /// Length of the alignment before it, seconds.
    pub alignment_s: f64,
    /// Root mean square over the windows.
    pub observed: f64,
    /// Lower end of its 95 % interval.
    pub lo: f64,
    /// Upper end of its 95 % interval.
    pub hi: f64,
    /// What the five terms alone predict, one standard deviation.
    pub before: f64,
    /// What the extended model predicts.
    pub after: f64,
}

/// The record in time, in columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Course {
    /// Length of a column, seconds.
    pub column_s: f64,
    /// The columns; values are about [`Course::mean`].
    pub columns: Vec<Column>,
    /// Mean of the record, in the unit of the signal.
    pub mean: f64,
    /// Moments and stretches that findings are about.
    pub marks: Vec<Mark>,
}

/// Some neighbouring samples; all NaN where all are missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// The record as it was measured.
    pub measured: Extent,
    /// The deterministic part of the model.
    pub modelled: Extent,
}

/// Extremes and mean of some samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Lowest value, in the unit of the signal.
    pub lo: f64,
    /// Mean of the values, in the unit of the signal.
    pub mean: f64,
    /// Highest value, in the unit of the signal.
    pub hi: f64,
}

/// A moment or a stretch of time that a finding is about.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Kind of the effect.
    pub effect: Kind,
    /// Begin, seconds into the record.
    pub from_s: f64,
    /// End, seconds; the same as the begin for a moment.
    pub to_s: f64,
    /// Whether it is a single sample.
    pub is_sample: bool,
}

/// The record before and after.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Amplitudes {
    /// The record as it was measured, whitened by the model of the five terms.
    pub before: Counts,
    /// With all that was found taken out, bad samples excluded.
    pub after: Counts,
}

/// Whitened samples by class.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Counts {
    /// Samples of each, from the lowest.
    pub counts: Vec<u64>,
}
