//! Narrow lines of a recorded file: the transform of the whole record, in bounded passes.
//!
//! The record is replayed a fixed number of times. The first replay yields trend and noise floor
//! ([`floor`](super::floor)). The next ones fold the record so that one short transform gives every
//! `R`-th frequency of the long one (decimation in frequency; Cooley and Tukey 1965): for
//! `k = R q + r`, `N = R L`,
//! `X_k = sum_{n<L} e^{-2 pi i q n / L} [ e^{-2 pi i r n / N} sum_{m<R} x_{n + L m} e^{-2 pi i r m / R} ]`,
//! exactly, whatever the record's length. `N` is at least 1.5 times the length; what comes near
//! the threshold is evaluated between the grid's points in a last replay.
//!
//! **Level.** Family-wise over continuous frequency between the lowest searched and half the
//! rate: by Rice's formula the power over the floor exceeds `z` somewhere with probability at
//! most `2 sqrt(z lambda / 2 pi) e^{-z}` times the band, `lambda` = half the variance of
//! `2 pi t` over the record (for the untapered: `T sqrt(pi z / 3) e^{-z}` a hertz), averaged over
//! the floor's own error; a tenth of the level belongs to slow lines (`slow_floor`), down to 64
//! cycles a record. The ends are tapered over 5 % each so that wander does not leak,
//! which costs 1.9 % of amplitude.

mod between;
mod grid;
mod replay;
mod survey;

use std::f64::consts::PI;

use survey::{Survey, TAPER};

use super::slow_floor;

pub use between::Line;
pub use replay::Replay;

/// Cycles a record of the slowest line that is searched.
pub const LEAST_CYCLES: f64 = slow_floor::LOWEST as f64;

/// What scalloping between the grid's points leaves of a line's power, at least.
const SCALLOPING: f64 = 0.68;

/// Samples of the shortest record that is searched: an eighth of it is a segment of a thousand, which has lines to either
/// side to take the floor from.
pub(super) const LEAST_SAMPLES: u64 = 1 << 13;

/// Candidates that are evaluated between the grid's points; the strongest if there are more.
const CANDIDATES: usize = 64;

/// Lines of a record sampled at `rate_hz`, by frequency, at a family-wise `level`. None in a
/// record of fewer than [`LEAST_SAMPLES`]: it has no floor to compare with.
///
/// # Errors
/// What a replay fails with.
pub fn search<R: Replay + ?Sized>(
    record: &R,
    rate_hz: f64,
    level: f64,
) -> Result<Vec<Line>, R::Error> {
    let Some(mut survey) = Survey::take(record, rate_hz)? else {
        return Ok(Vec::new());
    };
    survey.look_slow(record)?;
    let threshold = survey.threshold(level);
    let mut candidates = survey.grid(record, threshold * SCALLOPING)?;
    candidates.sort_by(|one, other| other.1.total_cmp(&one.1));
    candidates.truncate(CANDIDATES);
    let mut lines = survey.refine(record, &candidates)?;
    lines.retain(|line| line.false_alarm < level);
    lines.sort_by(|one, other| other.amplitude.total_cmp(&one.amplitude));
    let mut kept: Vec<Line> = Vec::new();
    for line in lines {
        let hidden = kept.iter().any(|strong| {
            let distance = (line.frequency_hz - strong.frequency_hz).abs() * survey.duration_s();
            let share = (line.amplitude / strong.amplitude).powi(2);
            distance < 1.5 || share < 4.0 * (side_lobe(distance) + survey.missing * survey.missing)
        });
        if !hidden {
            kept.push(line);
        }
    }
    kept.sort_by(|one, other| one.frequency_hz.total_cmp(&other.frequency_hz));
    Ok(kept)
}

/// Power of the taper's side lobes at a distance in `1 / T`, relative to its peak, from above:
/// those of the untapered window until the taper of the ends takes over.
fn side_lobe(distance: f64) -> f64 {
    let untapered = (PI * distance).powi(-2);
    let knee = 1.0 / TAPER;
    untapered * (knee / distance).min(1.0).powi(4)
}
