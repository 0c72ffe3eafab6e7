//! A shock as it is told and as the model has it.

#[cfg(test)]
mod tests;

use std::ops::Range;

use super::about::About;
use super::fit::Fitted;
use crate::fft;
use crate::model::shock::Shock;
use crate::numeric::bisect::bisect_ratio;
use crate::numeric::product::dot;

/// Share of what a course explains that may be left where it is said to be of this form: a choice.
const LEFT: f64 = 0.1;

/// A shock in samples, with what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Times in samples, frequency in cycles a sample.
    pub shock: Shock,
    /// Standard deviations of time and peak, and, relative, of duration, frequency and decay, where they are known.
    pub sd: [Option<f64>; 5],
    /// Samples in which it is.
    pub samples: Range<usize>,
    /// Gain in log-likelihood on every other error of prediction, fitted to the rest.
    pub nats: f64,
}

impl Course {
    /// The shock as a model has it of a record of so many samples a second.
    pub fn in_seconds(&self, rate_hz: f64) -> Shock {
        let shock = &self.shock;
        Shock {
            time_s: shock.time_s / rate_hz,
            peak: shock.peak,
            duration_s: shock.duration_s / rate_hz,
            f_hz: shock.f_hz * rate_hz,
            decay_s: shock.decay_s / rate_hz,
        }
    }
}

/// Whether a course explains most of what stands out in `samples`: of an exponential even a bump does.
pub fn is_most(about: &About, fitted: &Fitted, samples: &Range<usize>) -> bool {
    let errors = about.errors_in(samples);
    let square: f64 = errors.iter().map(|error| error * error).sum();
    2.0 * fitted.score > square - errors.len() as f64
}

/// The course that was fitted to `samples`; `None` where it leaves too much of them.
pub fn of_fit(about: &About, fitted: &Fitted, samples: &Range<usize>) -> Option<Course> {
    let course = about.of_shock(&fitted.shock);
    let region = about.means_of(samples);
    let left = |n: usize| (about.errors()[n] - course[n]).powi(2);
    let count = about.errors_in(samples).len() as f64;
    let square: f64 = region.map(left).sum();
    let excess = square - count;
    if excess > LEFT * fitted.score + 5.0 * (2.0 * count).sqrt() {
        return None;
    }
    let wide = (square / count).max(1.0).sqrt();
    let mut shock = fitted.shock;
    let rings = shock.f_hz > 0.0;
    if rings {
        // Until what is left of it does not count: a deviation of the whole is a nat's half.
        let seen = shock.decay_s * fitted.score.sqrt().ln().max(1.0);
        shock.duration_s = seen.max(samples.end as f64 - shock.time_s);
    }
    let from = (shock.time_s.max(0.0) as usize).min(samples.start);
    let to = ((shock.time_s + shock.duration_s).ceil() as usize).max(samples.end);
    // On the grid of a mean nothing is known better than within it.
    let place = wide * fitted.sd[0];
    let sd = if rings {
        [
            Some(place),
            Some(wide * fitted.sd[1]),
            None,
            Some(wide * fitted.sd[2]),
            Some(wide * fitted.sd[3]),
        ]
    } else {
        [
            Some(place),
            Some(wide * fitted.sd[1]),
            Some(wide * fitted.sd[2]),
            None,
            None,
        ]
    };
    shock.time_s = shock.time_s.max(0.0);
    Some(Course {
        shock,
        sd,
        samples: from..to,
        nats: of_course(about, &course),
    })
}

/// What can be told of a short stretch of no simple form: its ends; the frequency that is strongest, its highest point
/// and the decay with which the model's course has as much energy; or the bump that takes most out of it.
pub fn told(
    values: &[f64],
    samples: &Range<usize>,
    own: &Range<usize>,
    about: Option<&About>,
) -> Course {
    let deflection = deflection(values, samples, own);
    let length = samples.len() as f64;
    let peak = deflection.iter().fold(
        0.0,
        |most: f64, one| if one.abs() > most.abs() { *one } else { most },
    );
    let frequency = strongest(&deflection).filter(|frequency| frequency * length > 1.5);
    let energy: f64 = deflection.iter().map(|one| (one / peak).powi(2)).sum();
    let mut shock = Shock {
        time_s: samples.start as f64,
        peak,
        duration_s: length,
        f_hz: frequency.unwrap_or(0.0),
        decay_s: 0.0,
    };
    if shock.f_hz > 0.0 {
        let of_decay = |decay_s: f64| {
            let trial = Shock {
                decay_s,
                peak: 1.0,
                time_s: 0.0,
                ..shock
            };
            let mut course = vec![0.0; samples.len()];
            trial.add_to(0, &mut course, 1.0);
            course.iter().map(|one| one * one).sum::<f64>()
        };
        // As long as it lasts, it hardly falls.
        shock.decay_s = if of_decay(8.0 * length) > energy {
            bisect_ratio(0.25, 8.0 * length, 0.01, |decay| of_decay(decay) < energy)
        } else {
            0.0
        };
    }
    if shock.f_hz == 0.0 {
        let unit = Shock {
            peak: 1.0,
            time_s: 0.0,
            ..shock
        };
        let mut course = vec![0.0; samples.len()];
        unit.add_to(0, &mut course, 1.0);
        let square = dot(&course, &course);
        if square > 0.0 {
            shock.peak = dot(&course, &deflection) / square;
        }
    }
    Course {
        shock,
        sd: [None; 5],
        samples: samples.clone(),
        nats: about.map_or(1.0, |about| of_strength(about, samples)),
    }
}

/// What a stretch of values is over the line between the levels before and after it; nothing where samples are
/// missing.
pub fn deflection(values: &[f64], samples: &Range<usize>, own: &Range<usize>) -> Vec<f64> {
    let [before, after] = levels(values, samples, own);
    let (before, after) = (
        before.or(after).unwrap_or(0.0),
        after.or(before).unwrap_or(0.0),
    );
    let count = samples.len() as f64;
    let line = |n: usize| before + (after - before) * n as f64 / count;
    let part = values[samples.clone()].iter().enumerate();
    part.map(|(n, value)| {
        if value.is_finite() {
            value - line(n)
        } else {
            0.0
        }
    })
    .collect()
}

/// The level before and after some samples, where there is room for one.
pub fn levels(values: &[f64], samples: &Range<usize>, own: &Range<usize>) -> [Option<f64>; 2] {
    /// Samples that a level rests on: a choice.
    const FEWEST: usize = 8;
    const MOST: usize = 1024;
    let reach = samples.len().clamp(2 * FEWEST, MOST);
    let before = samples.start.saturating_sub(reach).max(own.start)..samples.start;
    let after = samples.end..(samples.end + reach).min(own.end);
    [before, after].map(|part| {
        (part.len() >= FEWEST).then(|| {
            let count = part.len() as f64;
            values[part].iter().sum::<f64>() / count
        })
    })
}

/// Whether some samples go from one level to another, and not far beyond either.
pub fn is_between_levels(values: &[f64], samples: &Range<usize>, own: &Range<usize>) -> bool {
    /// Difference of the levels over all that they span: a choice. A converter's filter goes beyond a jump by a tenth
    /// of it on either side.
    const MOST_OF_IT: f64 = 0.6;
    let [Some(before), Some(after)] = levels(values, samples, own) else {
        return false;
    };
    let there = values[samples.clone()]
        .iter()
        .copied()
        .filter(|value| value.is_finite());
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = there.fold(ends, |(low, high), value| (value.min(low), value.max(high)));
    (after - before).abs() > MOST_OF_IT * (high - low)
}

/// The sample of some that is furthest from the middle of its neighbours.
pub fn largest(values: &[f64], samples: &Range<usize>) -> Option<usize> {
    let far = |n: usize| {
        let near = &values[n.saturating_sub(2)..(n + 3).min(values.len())];
        let mut near = near.to_vec();
        near.sort_by(f64::total_cmp);
        (values[n] - near[near.len() / 2]).abs()
    };
    samples.clone().max_by(|&a, &b| far(a).total_cmp(&far(b)))
}

/// The frequency at which a course has most power, cycles a sample.
fn strongest(course: &[f64]) -> Option<f64> {
    let len = (2 * course.len()).next_power_of_two();
    let fft = fft::real_forward(len);
    let (mut values, mut ordinates) = (fft.make_input_vec(), fft.make_output_vec());
    values[..course.len()].copy_from_slice(course);
    fft.process(&mut values, &mut ordinates).ok()?;
    let powers = ordinates[..len / 2].iter().map(|one| one.norm_sqr());
    let (highest, _) = powers.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (highest > 0).then_some(highest as f64 / len as f64)
}

/// Gain of a whitened course whose size is fitted to every other error, on the rest.
fn of_course(about: &About, course: &[f64]) -> f64 {
    let half = |parity: usize| {
        let both = about.errors().iter().zip(course).skip(parity).step_by(2);
        both.fold((0.0, 0.0), |(product, square), (error, course)| {
            (product + error * course, square + course * course)
        })
    };
    let ((even, even_square), (odd, odd_square)) = (half(0), half(1));
    let size = if even_square > 0.0 {
        even / even_square
    } else {
        0.0
    };
    size * odd - 0.5 * size * size * odd_square
}

/// Gain of strengths that are fitted to every other error of a few neighbours, on the rest.
pub fn of_strength(about: &About, samples: &Range<usize>) -> f64 {
    /// Errors that have one strength: a choice.
    const NEIGHBOURS: usize = 16;
    let errors = about.errors_in(samples);
    let gain = |part: &[f64]| {
        let half = |parity: usize| part.iter().skip(parity).step_by(2).map(|one| one * one);
        // As if one more of the usual strength had been seen.
        let variance = (half(0).sum::<f64>() + 1.0) / (half(0).count() as f64 + 1.0);
        let score = |square: f64| 0.5 * (square - square / variance - variance.ln());
        half(1).map(score).sum::<f64>()
    };
    errors.chunks(NEIGHBOURS).map(gain).sum()
}
