//! Drift: the level goes slowly and smoothly where nothing leads that is known.
//!
//! A walk goes anywhere, and rarely smoothly; what is smooth is no noise, and taken for a walk it is simulated far too loud
//! at all shorter times. Which of the two it is, a likelihood says that lets a smooth course pay for itself
//! ([`cosines`]).

mod cosines;
mod ends;
mod gaps;
#[cfg(test)]
mod tests;

use std::f64::consts::PI;
use std::sync::Arc;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::bridge::{block_means, bridge};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::drift::{Drift, KIND};
use crate::model::kind::Kind;
use crate::model::random::Generator;
use crate::model::{burst, steps, warmup};
use cosines::{Cosines, Fitted};

/// Means of the record that the course is sought in, at most: a choice, eight for each half-wave that is looked at.
const MEANS: usize = 1 << 13;

/// Distances in which a course is compared with the spline that stands for it; a power of two, for its levels are at
/// powers of two of them.
const GRID: usize = 512;

/// Distances between levels, at least and at most: choices. Four show an arch; in 128 a course of 64 half-waves has two
/// each.
const FEWEST: usize = 4;
const MOST: usize = 128;

/// Mean square by which the spline may miss the course, over that by which the course itself is not known.
const MISSED: f64 = 0.01;

/// A smooth course that is in the record.
pub struct Found {
    /// Gain in log-likelihood, nats.
    pub nats: f64,
    p_value: f64,
    course: Course,
    /// What was explained by others before, and by it as well.
    pub supersedes: Vec<Kind>,
}

/// A smooth course, and how well it is known.
struct Course {
    drift: Drift,
    /// Standard deviation of each level.
    levels_sd: Vec<f64>,
    /// Numbers that were fitted to the record for it.
    freedom: f64,
    /// Frequency below which it is larger than the noise, hertz.
    absorbs_hz: f64,
}

/// The course of an axis, if there is one that is not known yet.
pub fn find(look: &Look<'_>) -> Option<Found> {
    let axis = look.axis;
    if !look.is_open(KIND) || axis.has(KIND) {
        return None;
    }
    let cosines = cosines_beside(axis, &[]);
    let mut with = cosines.with()?;
    let nats = with.nats - cosines.without()?.nats;
    // Two numbers more than without: twice the gain follows chi-squared of two degrees of freedom.
    let p_value = (-nats).exp();
    if p_value >= look.level() {
        return None;
    }
    // Others may have been named for parts of it: without them it is as likely, but for what they cost.
    let mut best = (cosines, Vec::new());
    for kinds in [
        vec![steps::KIND],
        vec![warmup::KIND],
        vec![steps::KIND, warmup::KIND],
    ] {
        let Some(cost_nats) = cost_nats(axis, &kinds) else {
            continue;
        };
        let alone = cosines_beside(axis, &kinds);
        if let Some(fitted) = alone.with()
            && fitted.nats + cost_nats > with.nats
        {
            (with, best) = (fitted, (alone, kinds));
        }
    }
    let (cosines, supersedes) = best;
    Some(Found {
        nats,
        p_value,
        course: Course::new(&cosines, &with),
        supersedes,
    })
}

/// What is to be done about it.
pub fn proposal(look: &Look<'_>, found: Found) -> Proposal {
    let Course {
        drift,
        levels_sd,
        freedom,
        absorbs_hz,
    } = found.course;
    let levels = drift.levels.iter().zip(levels_sd);
    let levels = levels.map(|(level, sd)| Value::normal(*level, sd));
    let values = std::iter::once(Value::exact(drift.duration_s)).chain(levels);
    let mut supersedes = found.supersedes;
    if !supersedes.is_empty() && look.axis.has(burst::KIND) {
        // It may be where what stood for the course bends another way than this: what is there of it is found again.
        supersedes.push(burst::KIND);
    }
    let wave = Wave::Drift {
        rate_hz: look.axis.rate_hz,
        absorbs_hz,
        drift: Arc::new(drift.clone()),
    };
    Proposal::Explain(Box::new(Candidate {
        held_out_nats: Some(found.nats),
        supersedes,
        // For a walk, whose bends a course is, its wanderings are far from steady.
        readmits_bands: true,
        ..Candidate::new(
            Estimate::new(KIND, values),
            found.p_value,
            freedom,
            Change::Waves(vec![wave]),
        )
    }))
}

/// What the parameters of all explanations of some kinds cost, half of the logarithm of the number of means each
/// (G. Schwarz, Ann. Stat. 6, 1978); `None` where an axis lacks one of the kinds.
fn cost_nats(axis: &AxisState, kinds: &[Kind]) -> Option<f64> {
    let all_there = kinds.iter().all(|kind| axis.has(*kind));
    let own = axis.explanations().iter();
    let own = own.filter(|one| kinds.contains(&one.kind()));
    let freedom: f64 = own.map(|one| one.freedom).sum();
    all_there.then(|| 0.5 * freedom * (MEANS as f64).ln())
}

/// What is left of an axis, with all that some kinds take out of it.
fn cosines_beside(axis: &AxisState, kinds: &[Kind]) -> Cosines {
    let factor = axis.residual.len().div_ceil(MEANS).max(1);
    let mean_s = factor as f64 / axis.rate_hz;
    let cosines = |values: &[f64]| {
        let mut means = block_means(values, factor);
        gaps::cross(&mut means, axis.bridged(), factor);
        Cosines::new(axis, &means, mean_s)
    };
    if kinds.is_empty() {
        return cosines(&axis.filled);
    }
    let kept = axis.explanations().iter();
    let kept = kept.filter(|one| !kinds.contains(&one.kind()));
    let waves: Vec<Wave> = kept.flat_map(|one| one.waves().to_vec()).collect();
    let mut values = axis.residual.with(waves).values();
    bridge(Arc::make_mut(&mut values).as_mut_slice());
    cosines(&values)
}

impl Course {
    /// The mean of what is left to the course, given the record.
    fn new(cosines: &Cosines, fitted: &Fitted) -> Self {
        let share = |j: usize| {
            let (noise, course) = (fitted.noise[j - 1], fitted.course[j - 1]);
            course / (noise + course)
        };
        let all = 1..=cosines.coefficients.len();
        let mean: Vec<f64> = all
            .clone()
            .map(|j| {
                let (own, fixed) = (cosines.coefficients[j - 1], fitted.fixed[j - 1]);
                share(j) * own + (1.0 - share(j)) * fixed
            })
            .collect();
        // The cosine of each half-wave at a place of the grid.
        let unit = (2.0 / cosines.duration_s).sqrt();
        let cosine = |j: usize, place: usize| {
            let turns = (j * place) % (2 * GRID);
            unit * (PI * turns as f64 / GRID as f64).cos()
        };
        let levels: Vec<f64> = (0..=GRID)
            .map(|place| {
                let seen: f64 = all.clone().map(|j| mean[j - 1] * cosine(j, place)).sum();
                let angle = PI * place as f64 / GRID as f64;
                seen + unit * ends::beyond(&fitted.fixed, angle)
            })
            .collect();
        let variances: Vec<f64> = (0..=GRID)
            .map(|place| {
                let random = all
                    .clone()
                    .map(|j| share(j) * fitted.noise[j - 1] * cosine(j, place).powi(2));
                let fixed = all
                    .clone()
                    .map(|j| cosines.slopes(j) * ((1.0 - share(j)) * cosine(j, place)));
                let fixed = fixed.fold(nalgebra::DVector::zeros(2), |sum, one| sum + one);
                random.sum::<f64>() + fixed.dot(&(&fitted.slopes_covariance * &fixed))
            })
            .collect();
        let drift = few_levels(&levels, &variances, cosines.duration_s);
        let every = GRID / (drift.levels.len() - 1);
        Self {
            levels_sd: variances.iter().step_by(every).map(|v| v.sqrt()).collect(),
            drift,
            freedom: 2.0 + all.clone().map(share).sum::<f64>(),
            absorbs_hz: all
                .rev()
                .find(|&j| share(j) > 0.5)
                .map_or(0.0, |j| cosines.f_hz(j)),
        }
    }
}

/// The spline of fewest levels that stands for a course as well as the course is known.
fn few_levels(levels: &[f64], variances: &[f64], duration_s: f64) -> Drift {
    let spline = |intervals: usize| Drift {
        duration_s,
        levels: levels.iter().step_by(GRID / intervals).copied().collect(),
    };
    let known = variances.iter().sum::<f64>();
    let stands_for = |drift: &Drift| {
        let mut course = vec![0.0; levels.len()];
        drift.spline(GRID as f64 / duration_s).add_to(&mut course);
        let missed = course.iter().zip(levels).map(|(a, b)| (a - b).powi(2));
        missed.sum::<f64>() <= MISSED * known
    };
    let tried = std::iter::successors(Some(FEWEST), |intervals| Some(2 * intervals));
    let mut tried = tried.take_while(|intervals| *intervals < MOST).map(spline);
    tried.find(stands_for).unwrap_or_else(|| spline(MOST))
}
