//! Noise that a record has at long averaging times and that its spectrum does not show.
//!
//! What comes now and then, for minutes, in no form that has a name, is a small part of the record: a spectrum that is the mean
//! of many stretches, and a fit that leaves out what happened, hold less of it than the Allan deviation does. Where the model
//! is quieter than the record there, by more than chance explains, bands of noise about zero are added until it is not: whoever
//! simulates with it gets data that drift as the record did, if not when it did. Sizes are those that suit the Allan
//! variances best, none below zero, one band after the other as long as it gains more than it costs.

mod pursuit;

use super::dictionary::Band;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws;
use crate::diagnosis::result::verdict::LEAST_INTERVALS;
use crate::diagnosis::result::views::{AllanPoint, SpectrumPoint};
use pursuit::{Found, NEEDLESS, Pursuit, TOLERANCE, by_gain};

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

/// What the last model lacks at the `points` of an Allan deviation, as far as the `spectrum` of all of the record has room for
/// it; `None` where chance makes as much at that `level`, or at [`NEEDLESS`] where the five terms by themselves do better.
pub fn lacking(
    points: &[AllanPoint],
    rate_hz: f64,
    level: f64,
    spectrum: impl FnOnce() -> Vec<SpectrumPoint>,
) -> Option<Lacking> {
    let points = octaves(points);
    // That something is missing is known where the five terms by themselves do better.
    let level = if points.iter().any(|point| is_worse(point)) {
        NEEDLESS
    } else {
        level
    };
    let pursuit = Pursuit::new(&points, rate_hz);
    let known = |found: &Found| found.p_value(pursuit.dictionary.len()) < level;
    let all = pursuit.bands(pursuit.dictionary.len(), level);
    if !known(&all) {
        return None;
    }
    let spectrum = spectrum();
    let net = |found: &Found| found.nats + found.room_nats(&spectrum, rate_hz);
    // Slower ones only, where the faster ones fill what is quiet.
    let slower = (1..pursuit.dictionary.len()).map(|entries| pursuit.bands(entries, level));
    let found = std::iter::once(all).chain(slower).filter(known);
    let (found, nats) = found
        .map(|found| {
            let nats = net(&found);
            (found, nats)
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let p_value = by_gain(nats, pursuit.dictionary.len());
    let bands = found.bands;
    (p_value < level && !bands.is_empty()).then_some(Lacking { bands, p_value })
}

/// Whether the simulated model is what its law says at the `points` rather than what the record is, or is not simulated: the law
/// of what happens to the samples may be rough where numbers are coarse, and then nothing is missing.
pub fn is_simulated_so(points: &[AllanPoint]) -> bool {
    let odds = octaves(points).into_iter().filter_map(|point| {
        let simulated = point.simulated?;
        let nats = |other: f64, variance: f64| {
            let variance = variance + (0.5 * TOLERANCE).powi(2);
            -0.5 * ((simulated / other).ln().powi(2) / variance + variance.ln())
        };
        // The logarithm of a deviation has the variance 1 / (2 edf); of two of them both scatter.
        let as_expected = nats(point.after, 0.5 / point.edf);
        Some(as_expected - nats(point.adev, point.edf.recip()))
    });
    odds.sum::<f64>() >= 0.0
}

/// Whether the model is quieter than the record at a point, and farther from it than the five terms are, by more than sampling
/// and what models may be off by.
fn is_worse(point: &AllanPoint) -> bool {
    let off = |model: f64| (model / point.adev - 1.0).abs();
    let sampling = (0.5 / point.edf).sqrt();
    point.after < point.adev && off(point.after) > off(point.before) + sampling + 0.5 * TOLERANCE
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Term;

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
        assert!(lacking(&chance, RATE_HZ, LEVEL, Vec::new).is_none());
        assert!(lacking(&points(|_| 0.5), RATE_HZ, LEVEL, Vec::new).is_none());
    }

    #[test]
    fn what_the_simulation_has_is_not_missing() {
        let mut louder = points(|tau_s| if tau_s > 4.0 { 2.0 } else { 1.0 });
        assert!(is_simulated_so(&louder), "not simulated");
        // What models may be off by.
        for point in &mut louder {
            point.simulated = Some(0.99 * point.adev);
        }
        assert!(!is_simulated_so(&louder));
        for point in &mut louder {
            point.simulated = Some(1.01 * point.after);
        }
        assert!(is_simulated_so(&louder));
    }

    #[test]
    fn what_the_five_terms_have_is_missing_at_a_lower_level() {
        // Three variances lack a third: three, two and one and a half standard deviations.
        let mut quiet = points(|tau_s| if tau_s > 20.0 { 1.25 } else { 1.0 });
        assert!(lacking(&quiet, RATE_HZ, LEVEL, Vec::new).is_none());
        for point in &mut quiet {
            point.before = point.adev;
        }
        let found = lacking(&quiet, RATE_HZ, LEVEL, Vec::new).expect("bands");
        assert!(found.p_value > LEVEL, "{}", found.p_value);
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
        let found = lacking(&quiet, RATE_HZ, LEVEL, Vec::new).expect("bands");
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
        let found = lacking(&beside_a_line, RATE_HZ, LEVEL, Vec::new).expect("bands");
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
        assert!(lacking(&few, RATE_HZ, LEVEL, Vec::new).is_none());
    }
}
