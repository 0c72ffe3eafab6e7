//! How far a model's Allan deviation is off: from the truth, and from what was measured.

use super::answer::Views;
use crate::hidden::case::Case;

/// Degrees of freedom of the held-out part from which an averaging time is judged.
const LEAST_EDF: f64 = 1000.0;

/// The models of one answer at one averaging time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelError {
    /// Averaging time, samples.
    pub m: u64,
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// Whole record, over the law that it was made by; none where that has no Allan variance in closed
    /// form.
    pub truth: Option<Sides>,
    /// Held-out part, over what was measured there.
    pub held_out: Sides,
}

/// Errors of the five terms alone and of the last model, percent of the deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides {
    /// Five terms alone.
    pub before: f64,
    /// Last model.
    pub after: f64,
}

impl Sides {
    fn over(before: f64, after: f64, deviation: f64) -> Self {
        let percent = |said: f64| 100.0 * (said / deviation - 1.0);
        Self {
            before: percent(before),
            after: percent(after),
        }
    }
}

/// At every averaging time that the held-out part knows well.
pub fn errors(case: &Case, views: &Views) -> Vec<ModelError> {
    let sure: Vec<_> = views
        .held_out
        .iter()
        .filter(|held| held.edf >= LEAST_EDF)
        .collect();
    let ms: Vec<u64> = sure.iter().map(|held| held.models.m).collect();
    let truth = case.allan_variances(&ms);
    let of_truth = |place: usize| {
        let whole = views.allan.iter().find(|point| point.m == ms[place])?;
        let deviation = truth.as_ref()?[place].sqrt();
        Some(Sides::over(whole.before, whole.after, deviation))
    };
    let one = |(place, held): (usize, &&super::answer::Held)| ModelError {
        m: ms[place],
        tau_s: held.tau_s,
        truth: of_truth(place),
        held_out: Sides::over(held.models.before, held.models.after, held.adev),
    };
    sure.iter().enumerate().map(one).collect()
}
