//! Whether events belong to a band that is excluded.
//!
//! A tone that is switched begins and ends with a jump of its slope, which the whitening of noise that
//! rises with the frequency sums up to what a single bad sample would be; a shock that rings is large
//! in other bands too. Both give themselves away by their moments.

use std::ops::Range;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::steady::noise;

/// How many times the average a band's power is where events are its own: a choice. A band of
/// steady noise has as much at one moment in 20.
const SEVERAL: f64 = 3.0;

/// Moments up to which the largest of an event counts, and not their mean: a choice.
const LARGEST_MOMENTS: usize = 3;

/// Moments before and after which a band's power is compared: a choice. More would miss short
/// tones, the power at a single one scatters as much as it is.
const EACH_SIDE: usize = 3;

/// Probability below which events do not stand by chance where a band's power changes: a choice. It
/// decides about a name that was found, not about a finding.
const AT_EDGES: f64 = 0.01;

/// Whether what happens at `samples` belongs to a band that is excluded.
pub fn is_of_excluded(axis: &AxisState, samples: &[Range<usize>]) -> bool {
    is_of_band(axis, &axis.excluded_hz(), samples)
}

/// Whether what happens at `samples` belongs to one of the `bands_hz`: its power is several times as large
/// there as on average, or it changes there more than elsewhere.
pub fn is_of_band(axis: &AxisState, bands_hz: &[Range<f64>], samples: &[Range<usize>]) -> bool {
    let length = axis.ring_len() as f64;
    bands_hz.iter().any(|band| {
        let course = noise::course(axis, band);
        if course.is_empty() || samples.is_empty() {
            return false;
        }
        let moment = |sample: usize| {
            let at = sample as f64 / length * course.len() as f64;
            (at as usize).min(course.len() - 1)
        };
        let moments: Vec<_> = samples
            .iter()
            .map(|range| moment(range.start)..moment(range.end) + 1)
            .collect();
        power_at(&course, &moments) > SEVERAL || at_edges(&course, &moments) < AT_EDGES
    })
}

/// Mean power of a course over the events at `moments`.
fn power_at(course: &[f64], moments: &[Range<usize>]) -> f64 {
    let powers = moments.iter().map(|range| {
        let near = &course[range.start.saturating_sub(1)..range.end];
        if near.len() > LARGEST_MOMENTS {
            near.iter().sum::<f64>() / near.len() as f64
        } else {
            // An event's largest power is near, but not always at its first moment.
            near.iter().copied().fold(0.0, f64::max)
        }
    });
    powers.sum::<f64>() / moments.len() as f64
}

/// Probability that events at `moments` stand by chance where a course changes as much as it does
/// there: by the rank of each change among all, put together after R. A. Fisher (*Statistical Methods
/// for Research Workers*, 1932).
fn at_edges(course: &[f64], moments: &[Range<usize>]) -> f64 {
    let count = course.len();
    if count < 64 * EACH_SIDE {
        return 1.0;
    }
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(course.iter().scan(0.0, |sum, power| {
            *sum += power;
            Some(*sum)
        }))
        .collect();
    let change = |moment: usize| {
        let moment = moment.clamp(EACH_SIDE, count - EACH_SIDE - 1);
        let before = sums[moment] - sums[moment - EACH_SIDE];
        let after = sums[moment + 1 + EACH_SIDE] - sums[moment + 1];
        (after / before).ln().abs()
    };
    let mut all: Vec<f64> = (0..count).map(change).collect();
    all.sort_by(f64::total_cmp);
    let rank = |range: &Range<usize>| {
        let here = change(range.start);
        let larger = count - all.partition_point(|one| *one < here);
        larger.max(1) as f64 / count as f64
    };
    let fisher: f64 = moments.iter().map(|range| -2.0 * rank(range).ln()).sum();
    p_value::chi_squared(fisher, 2.0 * moments.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Power 9 for 20 moments of each 100, with a ripple that makes no two moments alike.
    fn switched() -> Vec<f64> {
        (0..2000_i32)
            .map(|n| {
                let ripple = 1.0 + 0.3 * f64::from(n * 7919 % 1009) / 1009.0;
                ripple * if n % 100 < 20 { 9.0 } else { 1.0 }
            })
            .collect()
    }

    #[test]
    fn events_at_edges_are_told_from_events_anywhere() {
        let at = |places: &[usize]| -> Vec<Range<usize>> {
            places.iter().map(|&place| place..place + 1).collect()
        };
        let edges = at_edges(&switched(), &at(&[300, 720, 1300]));
        assert!(edges < 1e-3, "{edges}");
        let anywhere = at_edges(&switched(), &at(&[350, 710, 1377]));
        assert!(anywhere > 0.05, "{anywhere}");
    }
}
