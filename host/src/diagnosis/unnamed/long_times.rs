//! Noise that a record has at long averaging times and that its spectrum does not show.
//!
//! What comes now and then, for minutes, in no form that has a name, is a small part of the record: a spectrum that is the mean
//! of many stretches, and a fit that leaves out what happened, hold less of it than the Allan deviation does. Where the model
//! is quieter than the record there, by more than chance explains, bands of noise about zero are added until it is not: whoever
//! simulates with it gets data that drift as the record did, if not when it did. Sizes are those that suit the Allan
//! variances best, none below zero, one band after the other as long as it gains more than it costs.

use nalgebra::{DMatrix, DVector};

use super::dictionary::Band;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws;
use crate::diagnosis::result::verdict::{GOOD_PERCENT, LEAST_INTERVALS};
use crate::diagnosis::result::views::AllanPoint;
use crate::diagnosis::statistic::p_value::chi_squared;
use crate::fit::least_squares::solve_non_negative;
use crate::model::Term;

/// Bands, at most: a choice. Every subset of them is tried for sizes that are not below zero, 64 at most.
const MOST: usize = 6;

/// Widths that are tried an octave, from that whose noise is slower than the longest averages to that which turns once in the
/// shortest that lack anything: a choice, as many as of the shelves that a spectrum is held against. Faster noise would
/// fill what is quiet between the lines of a record, which the Allan deviation of its short averages, theirs, does not show.
const PER_OCTAVE: f64 = 2.0;

/// Standard deviations, tolerance included, from which a variance lacks something by itself: a choice, 5 % of the deviation
/// where sampling is no matter.
const LACKS: f64 = 2.0;

/// Probability of a band too many where something is missing.
const NEEDLESS: f64 = 0.05;

/// What an Allan variance may be off by beside chance: 1 % of the deviation, as models are compared.
const TOLERANCE: f64 = 0.02;

/// What a model lacks.
pub struct Lacking {
    /// Bands, with the square of their amplitude.
    bands: Vec<(Band, f64)>,
    /// Probability of as much by chance.
    pub p_value: f64,
}

impl Lacking {
    /// Adds it to the model of an axis.
    pub fn add_to(&self, axis: &mut AxisState) {
        for (band, squared) in &self.bands {
            let expected = band.component(&laws::behind(&axis.bins, &axis.laws));
            axis.add_law(band.law(), *squared, expected);
        }
    }
}

/// What the last model lacks at the `points` of an Allan deviation; `None` where chance makes as much at that `level`.
pub fn lacking(points: &[AllanPoint], rate_hz: f64, level: f64) -> Option<Lacking> {
    let points = octaves(points);
    let p_value = by_chance(&points, 1.0, |point| Some(point.after))?;
    if p_value >= level {
        return None;
    }
    let bands = Pursuit::new(&points, rate_hz).bands();
    (!bands.is_empty()).then_some(Lacking { bands, p_value })
}

/// Whether the model is quieter than the record at some of the `points` as it is simulated, too, or is not simulated: the law of
/// what happens to the samples may be rough where numbers are coarse, and then nothing is missing.
pub fn is_simulated_so(points: &[AllanPoint], level: f64) -> bool {
    // Both scatter.
    let p_value = by_chance(&octaves(points), 0.5, |point| point.simulated);
    p_value.is_none_or(|p_value| p_value < level)
}

/// Probability that chance, with a `share` of each point's degrees of freedom, makes any record as much louder than a model; `None`
/// without a point that has a deviation of that model.
fn by_chance(
    points: &[&AllanPoint],
    share: f64,
    of_model: impl Fn(&AllanPoint) -> Option<f64>,
) -> Option<f64> {
    let beyond = points.iter().filter_map(|point| {
        let allowed = of_model(point)? * (1.0 + GOOD_PERCENT / 100.0);
        let freedom = share * point.edf;
        Some(chi_squared(
            freedom * (point.adev / allowed).powi(2),
            freedom,
        ))
    });
    Some(points.len() as f64 * beyond.reduce(f64::min)?)
}

/// The points that are judged, an octave or more apart: nearer ones say the same.
fn octaves(points: &[AllanPoint]) -> Vec<&AllanPoint> {
    let mut chosen: Vec<&AllanPoint> = Vec::new();
    for point in points {
        let is_judged = point.intervals >= LEAST_INTERVALS && point.adev > 0.0;
        let is_next = chosen.last().is_none_or(|last| point.m >= 2 * last.m);
        if is_judged && is_next {
            chosen.push(point);
        }
    }
    chosen
}

/// The search for bands.
struct Pursuit {
    /// What is missing of each variance, in its standard deviations.
    missing: DVector<f64>,
    /// All bands, and what each adds for an amplitude of 1, in the same.
    dictionary: Vec<(Band, DVector<f64>)>,
}

impl Pursuit {
    fn new(points: &[&AllanPoint], rate_hz: f64) -> Self {
        let deviation = |point: &AllanPoint| {
            let variance = point.adev.max(point.after).powi(2);
            variance * (2.0 / point.edf).sqrt().hypot(TOLERANCE)
        };
        let missing: Vec<f64> = points
            .iter()
            .map(|point| (point.adev.powi(2) - point.after.powi(2)) / deviation(point))
            .collect();
        let mut pairs = points.iter().zip(&missing);
        let first = pairs.find(|(_, missing)| **missing > LACKS);
        let half_hz = 0.5 * rate_hz;
        let fastest_hz = first.map_or(half_hz, |(point, _)| half_hz.min(point.tau_s.recip()));
        let longest_s = points.last().map_or(0.0, |point| point.tau_s);
        // A twentieth of its turn passes within the longest average: over all of them its variance still grows.
        let slowest_hz = 0.05 / longest_s;
        let steps = ((fastest_hz / slowest_hz).log2() * PER_OCTAVE).max(0.0) as usize;
        let entry = |step: usize| {
            let band = Band {
                f_hz: 0.0,
                width_hz: slowest_hz * (step as f64 / PER_OCTAVE).exp2(),
            };
            let term = band.term();
            let adds = points
                .iter()
                .map(|point| term.allan_variance(point.m, rate_hz) / deviation(point));
            (band, DVector::from_iterator(points.len(), adds))
        };
        Self {
            missing: DVector::from_vec(missing),
            dictionary: (0..=steps).map(entry).collect(),
        }
    }

    /// The bands that are worth their cost, each with the square of its amplitude.
    fn bands(&self) -> Vec<(Band, f64)> {
        let cost_nats = (self.dictionary.len() as f64 / NEEDLESS).ln();
        let mut chosen: Vec<usize> = Vec::new();
        let (mut squared, mut misfit) = (DVector::zeros(0), self.missing.norm_squared());
        while chosen.len() < MOST {
            let others = (0..self.dictionary.len()).filter(|one| !chosen.contains(one));
            let fits = others.map(|one| (one, self.fitted(&[chosen.as_slice(), &[one]].concat())));
            let Some((one, (next, left))) = fits.min_by(|a, b| a.1.1.total_cmp(&b.1.1)) else {
                break;
            };
            if 0.5 * (misfit - left) <= cost_nats {
                break;
            }
            chosen.push(one);
            (squared, misfit) = (next, left);
        }
        let both = chosen.into_iter().zip(squared.iter().copied());
        both.filter(|(_, squared)| *squared > 0.0)
            .map(|(one, squared)| (self.dictionary[one].0, squared))
            .collect()
    }

    /// Squares of the amplitudes of some bands, and what they leave.
    fn fitted(&self, chosen: &[usize]) -> (DVector<f64>, f64) {
        let columns: Vec<DVector<f64>> = chosen
            .iter()
            .map(|&one| self.dictionary[one].1.clone())
            .collect();
        let a = DMatrix::from_columns(&columns);
        let squared = solve_non_negative(&a, &self.missing);
        let left = (&a * &squared - &self.missing).norm_squared();
        (squared, left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 100.0;
    const LEVEL: f64 = 1e-4;

    /// Points of a record whose deviation is `factor` of tau in seconds times that of white noise of density 1.
    fn points(factor: impl Fn(f64) -> f64) -> Vec<AllanPoint> {
        const SAMPLES: u64 = 200_000;
        (0..40)
            .map(|step| (f64::from(step) / 2.0).exp2().round() as u64)
            .take_while(|m| SAMPLES / m >= 10)
            .map(|m| {
                let tau_s = m as f64 / RATE_HZ;
                let white = tau_s.powf(-0.5);
                AllanPoint {
                    tau_s,
                    m,
                    adev: factor(tau_s) * white,
                    lo: 0.0,
                    hi: 0.0,
                    edf: 1.5 * (SAMPLES / m) as f64,
                    intervals: SAMPLES / m,
                    before: white,
                    after: white,
                    simulated: None,
                }
            })
            .collect()
    }

    #[test]
    fn what_chance_makes_is_not_missing() {
        // Two deviations of each variance upwards, and a model that is a little too loud.
        let chance = points(|tau_s| {
            let edf = 1.5 * 200_000.0 / (tau_s * RATE_HZ);
            (1.0 + 2.0 * (2.0 / edf).sqrt()).sqrt()
        });
        assert!(lacking(&chance, RATE_HZ, LEVEL).is_none());
        assert!(lacking(&points(|_| 0.5), RATE_HZ, LEVEL).is_none());
    }

    #[test]
    fn what_the_simulation_has_is_not_missing() {
        let mut louder = points(|tau_s| if tau_s > 4.0 { 2.0 } else { 1.0 });
        assert!(is_simulated_so(&louder, LEVEL), "not simulated");
        let simulated = |points: &mut [AllanPoint], share: f64| {
            points
                .iter_mut()
                .for_each(|point| point.simulated = Some(share * point.adev));
        };
        simulated(&mut louder, 0.97);
        assert!(!is_simulated_so(&louder, LEVEL));
        simulated(&mut louder, 0.5);
        assert!(is_simulated_so(&louder, LEVEL));
    }

    #[test]
    fn what_is_missing_at_long_times_is_added_and_short_ones_stay() {
        let quiet = points(|tau_s| {
            if tau_s > 4.0 {
                1.0 + 0.3 * (tau_s / 4.0).log2()
            } else {
                1.0
            }
        });
        let found = lacking(&quiet, RATE_HZ, LEVEL).expect("bands");
        assert!(found.p_value < LEVEL);
        for point in octaves(&quiet) {
            let added = |(band, squared): &(Band, f64)| {
                squared * band.term().allan_variance(point.m, RATE_HZ)
            };
            let added: f64 = found.bands.iter().map(added).sum();
            let ratio = (point.after.powi(2) + added).sqrt() / point.adev;
            // Three deviations of sampling, beside the tolerance.
            let allowed = 3.0 * (0.5 / point.edf).sqrt() + TOLERANCE;
            assert!(
                (ratio - 1.0).abs() < allowed,
                "{}: {ratio}, allowed {allowed}",
                point.tau_s
            );
        }
    }

    #[test]
    fn what_is_missing_from_a_time_on_is_no_faster_than_that() {
        // A line makes the short times a hundred times as loud as what is missing.
        let mut beside_a_line = points(|tau_s| if tau_s > 4.0 { 1.5 } else { 1.0 });
        for point in &mut beside_a_line {
            let line = 1e4 * (-point.tau_s).exp();
            point.adev = point.adev.hypot(line.sqrt());
            point.after = point.after.hypot(line.sqrt());
        }
        let found = lacking(&beside_a_line, RATE_HZ, LEVEL).expect("bands");
        let first_s = octaves(&beside_a_line)
            .into_iter()
            .find(|point| point.tau_s > 4.0 && point.adev > 1.05 * point.after)
            .expect("it is missing somewhere")
            .tau_s;
        for (band, _) in &found.bands {
            assert!(band.width_hz <= 1.0 / first_s, "{band:?}, {first_s} s");
        }
    }

    #[test]
    fn means_over_most_of_the_record_are_not_looked_at() {
        // Sixteen intervals and fewer.
        let few = points(|tau_s| if tau_s > 110.0 { 30.0 } else { 1.0 });
        assert!(few.iter().any(|point| point.adev > point.after));
        assert!(lacking(&few, RATE_HZ, LEVEL).is_none());
    }
}
