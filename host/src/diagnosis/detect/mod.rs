//! What each effect looks like in a record: one file an effect, and the table of their detectors.
//!
//! A [`Detector`] looks at an axis and proposes what to do; it changes nothing. Their order is that of a
//! round of the [search](crate::diagnosis::search).

mod again;
pub mod burst;
pub mod clipping;
pub mod coarse_grid;
pub mod common_mode;
pub mod cyclic;
pub mod drift;
pub mod dropped;
pub mod held;
pub mod level;
pub mod lines;
pub mod look;
pub mod outliers;
pub mod plain;
pub mod shock;
pub mod slow_change;
pub mod spectral;
pub mod stale;
pub mod steps;
pub mod strength;
pub mod telegraph;
pub mod thermal;
pub mod timebase;
#[cfg(test)]
pub(in crate::diagnosis) mod trial;
pub mod unsteady_band;
pub mod wandering_line;
pub mod warmup;

use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::model::{self, kind::Kind};

/// Looks for one thing.
pub struct Detector {
    /// Tests that it makes: its share of the family's level.
    pub tests: u32,
    /// Looks at an axis; what it proposes is done in its order.
    pub look: fn(&Look<'_>) -> Result<Vec<Proposal>, NoFit>,
}

/// What the values themselves say, and what happened, before any model. A flat stretch of repeats is no event, but what comes
/// to a limit may be one, unless much of the record is there.
pub static BEFORE_ROUNDS: &[&Detector] = &[
    &stale::DETECTOR,
    // What a level goes through that switches all the time is no event.
    &telegraph::path::DETECTOR,
    // Nor is what comes again and again, nor how it settles from the start.
    &plain::DETECTOR,
    &warmup::plain::DETECTOR,
    &clipping::OF_MUCH,
    &shock::DETECTOR,
    &clipping::DETECTOR,
    &coarse_grid::DETECTOR,
];

/// A round, from the most local to the most general.
pub static ROUND: &[&Detector] = &[
    // A level that switches all the time looks like bad samples and bursts until its law is there.
    &spectral::OF_SWITCHING,
    // Where samples are lost the noise is cut: no bad samples, no burst.
    &dropped::DETECTOR,
    &outliers::DETECTOR,
    // What wanders is no steady line.
    &wandering_line::DETECTOR,
    &lines::DETECTOR,
    &level::IN_FITTED_NOISE,
    // Noise that swings is louder in stretches, in every band.
    &cyclic::DETECTOR,
    &unsteady_band::DETECTOR,
    &burst::DETECTOR,
    &strength::DETECTOR,
    &spectral::DETECTOR,
    // Beside others, another may be in the place of the first.
    &spectral::exchange::DETECTOR,
    // What is left may be hidden by the walk that it was taken for.
    &level::IN_NOISE_ANEW,
    &lines::WANDERING,
];

/// Kinds that are found against the noise as it is fitted at the time, and are no part of that.
pub const IN_NOISE: [Kind; 7] = [
    model::outliers::KIND,
    model::sinusoid::KIND,
    model::hum::KIND,
    model::steps::KIND,
    model::drift::KIND,
    model::warmup::KIND,
    model::burst::KIND,
];

/// Who finds those.
pub static OF_KINDS_IN_NOISE: &[&Detector] = &[
    &outliers::DETECTOR,
    &lines::DETECTOR,
    &level::IN_FITTED_NOISE,
    &burst::DETECTOR,
    &level::IN_NOISE_ANEW,
];

/// Tests of the whole record: what its axes share, its clock, and whether its samples are values of their own.
pub const OF_THE_RECORD: u32 = common_mode::TESTS + timebase::TESTS + held::TESTS;
