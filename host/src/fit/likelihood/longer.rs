//! How much longer a record would have to be to show a coefficient that this one does not.
//!
//! Planned with what the record itself suggests: a coefficient is taken to be what its best
//! estimate is, although that cannot be resolved from zero, and everything else as fitted. The answer
//! is the least length at which such a coefficient would be found in half of the records.

use super::components::SEEN;
use super::slope::{Slope, empty_blocks};
use super::{information, whittle};
use crate::fit::design::Design;
use crate::model::PerCoefficient;
use crate::numeric::bisect::bisect_ratio;
use crate::numeric::normal::{ONE_SIDED_95, TWO_SIDED_95};

/// Longest record that is considered, as a multiple of the present one.
const LONGEST: f64 = 1e4;

/// Relative accuracy of the answer.
const CLOSE: f64 = 0.01;

/// Factor in length that would show the term `index` of [`SEEN`]; `None` where its best estimate is
/// zero or no sensible length would do.
pub fn for_square(
    design: &Design,
    squares: &PerCoefficient<f64>,
    duration_s: f64,
    index: usize,
) -> Option<f64> {
    let square = *squares.get(SEEN[index]);
    least_factor(|factor| {
        let information = whittle::information(design, squares, factor * duration_s);
        let variance = information::inverse(&information)[(index, index)];
        square > 0.0 && square > ONE_SIDED_95 * variance.sqrt()
    })
}

/// Factor in length that would show a ramp of `per_s` under noise of the squares `squared`, in the
/// order of [`SEEN`].
pub fn for_slope(per_s: f64, squared: &[f64], duration_s: f64) -> Option<f64> {
    least_factor(|factor| {
        Slope::new(&empty_blocks(factor * duration_s), squared)
            .is_some_and(|slope| per_s.abs() > TWO_SIDED_95 * slope.variance(squared).sqrt())
    })
}

/// The least factor from one up for which `shows`, which longer records do not lose again.
fn least_factor(shows: impl Fn(f64) -> bool) -> Option<f64> {
    if !shows(LONGEST) {
        return None;
    }
    Some(bisect_ratio(1.0, LONGEST, CLOSE, |factor| !shows(factor)))
}
