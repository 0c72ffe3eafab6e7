//! Whether one may simulate with the model of an axis: measured against modelled at every averaging time.

use serde::Serialize;

use crate::diagnosis::result::views::AllanPoint;

/// Intervals from which an averaging time is judged: its deviation is known to some 16 %, and longer ones say
/// more of chance than of the model.
pub const LEAST_INTERVALS: u64 = 20;

/// Error of the Allan deviation up to which a model is good enough to simulate with, percent: what the source's own
/// simulation was off by, and a little (Pavlov and Petrov: 4 %).
pub const GOOD_PERCENT: f64 = 5.0;

/// Standard deviations of sampling by which a point may be further off.
const SIGMAS: f64 = 2.0;

/// What a model is good for.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Verdict {
    /// The longest stretch of averaging times at which the last model is within [`GOOD_PERCENT`] and what chance
    /// explains, seconds; `None` where there is no such time.
    pub good_s: Option<[f64; 2]>,
    /// Error of the last model's Allan deviation over all these points, root mean square less what sampling makes
    /// of it, percent; `None` where no point is judged.
    pub error_percent: Option<f64>,
    /// The same of the five terms as `inm analyze` fits them.
    pub five_terms_error_percent: Option<f64>,
    /// Every averaging time of [`LEAST_INTERVALS`] or more, ascending.
    pub points: Vec<JudgedPoint>,
}

/// One averaging time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JudgedPoint {
    /// Averaging time, seconds.
    pub tau_s: f64,
    /// What sampling makes of the measured deviation, one standard deviation in percent of it.
    pub sampling_percent: f64,
    /// How far the five terms alone are above the measured deviation, percent.
    pub five_terms_percent: f64,
    /// How far the last model is above it, percent.
    pub model_percent: f64,
}

impl JudgedPoint {
    /// Whether the last model is good enough here.
    pub fn is_good(&self) -> bool {
        self.model_percent.abs() <= GOOD_PERCENT + SIGMAS * self.sampling_percent
    }
}

impl Verdict {
    /// Of the points of a record.
    pub fn new(points: &[AllanPoint]) -> Self {
        let judged = |point: &AllanPoint| {
            let above = |model: f64| 100.0 * (model / point.adev - 1.0);
            JudgedPoint {
                tau_s: point.tau_s,
                sampling_percent: 100.0 / (2.0 * point.edf).sqrt(),
                five_terms_percent: above(point.before),
                model_percent: above(point.after),
            }
        };
        let enough = |point: &&AllanPoint| point.intervals >= LEAST_INTERVALS && point.adev > 0.0;
        let points: Vec<JudgedPoint> = points.iter().filter(enough).map(judged).collect();
        Self {
            good_s: good(&points),
            error_percent: error(&points, |one| one.model_percent),
            five_terms_error_percent: error(&points, |one| one.five_terms_percent),
            points,
        }
    }

    /// The point at which the last model is furthest off by more than chance explains.
    pub fn worst(&self) -> Option<&JudgedPoint> {
        let bad = self.points.iter().filter(|one| !one.is_good());
        bad.max_by(|a, b| a.model_percent.abs().total_cmp(&b.model_percent.abs()))
    }
}

/// Ends of the longest run of good points, by the logarithm of their times.
fn good(points: &[JudgedPoint]) -> Option<[f64; 2]> {
    let runs = points.chunk_by(|one, other| one.is_good() == other.is_good());
    let good = runs.filter(|run| run[0].is_good());
    let ends = good.map(|run| [run[0].tau_s, run[run.len() - 1].tau_s]);
    ends.max_by(|a, b| (a[1] / a[0]).total_cmp(&(b[1] / b[0])))
}

/// Root mean square of errors less that of sampling, percent.
fn error(points: &[JudgedPoint], of: impl Fn(&JudgedPoint) -> f64) -> Option<f64> {
    let squares = points
        .iter()
        .map(|one| of(one).powi(2) - one.sampling_percent.powi(2));
    let mean = squares.sum::<f64>() / points.len() as f64;
    mean.is_finite().then(|| mean.max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point of a record whose deviation is 1, with a model that is off by so many percent.
    fn point(m: u64, model_percent: f64) -> AllanPoint {
        AllanPoint {
            tau_s: m as f64,
            m,
            adev: 1.0,
            lo: 0.9,
            hi: 1.1,
            edf: 5000.0,
            intervals: 640 / m,
            before: 1.3,
            after: 1.0 + 0.01 * model_percent,
            simulated: None,
        }
    }

    #[test]
    fn says_from_where_to_where_a_model_is_good() {
        let errors = [1.0, -9.0, 2.0, 3.0, -1.0, 30.0, 0.0];
        let points: Vec<AllanPoint> = (0..7).map(|k| point(1 << k, errors[k])).collect();
        // The last one has fewer than twenty intervals.
        let verdict = Verdict::new(&points);
        assert_eq!(verdict.points.len(), 6);
        assert_eq!(verdict.good_s, Some([4.0, 16.0]));
        let worst = verdict.worst().expect("a bad point");
        assert_eq!(worst.tau_s, 32.0);
        // Sampling makes a square of one.
        let squares: f64 = errors[..6].iter().map(|one| one * one - 1.0).sum();
        let expected = (squares / 6.0).sqrt();
        let error = verdict.error_percent.expect("points");
        assert!((error - expected).abs() < 1e-9, "{error} {expected}");
    }

    #[test]
    fn a_record_too_short_for_any_point_has_none() {
        let verdict = Verdict::new(&[point(33, 0.0)]);
        assert_eq!(verdict, Verdict::default());
    }
}
