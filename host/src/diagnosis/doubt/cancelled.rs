//! Courses that what is left of the record cancels.
//!
//! A course that is there adds its Allan variance to that of the rest, but for what chance makes of their product. One
//! that was fitted to slow noise leaves its opposite behind: the rest and the course together have more than the
//! record. Data simulated from both would be louder than what was measured.

use super::{Doubt, Hearing};
use crate::bins::point::Point;
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::verdict::{GOOD_PERCENT, LEAST_INTERVALS};
use crate::diagnosis::statistic::allan_curve;
use crate::model::kind::Kind;
use crate::model::motion;

/// Standard deviations of the record's own variance by which the sum may be larger: the product of
/// two independent series strays by one.
const SIGMAS: f64 = 3.0;

/// Takes such courses back, the largest first. What they were named for is noise, with or without a name. No test:
/// every course was significant as what it is.
pub static DOUBT: Doubt = Doubt {
    tests: 0,
    why: "what is left cancels it",
    hear,
};

fn hear(hearing: &mut Hearing<'_>) -> Result<(), NoFit> {
    if levels_are_cancelled(hearing.axis) {
        // What moved the sensor did so, wherever it lay afterwards.
        hearing.axis.withdraw_levels();
        hearing.axis.refresh()?;
    }
    while let Some(kind) = most_cancelled(hearing.axis) {
        hearing.take_course_back(kind)?;
    }
    Ok(())
}

/// The kind whose courses are largest where the rest cancels most of them, if it does so anywhere.
fn most_cancelled(axis: &AxisState) -> Option<Kind> {
    // What stands in the place of what is no measurement is no course: it follows from the rest.
    let is_course = |wave: &&Wave| wave.replaced().is_none();
    let has_waves = |one: &&Explanation| one.waves().iter().any(|wave| is_course(&wave));
    axis.explanations().iter().find(has_waves)?;
    let left = axis.residual.values();
    let curve = |values: &mut [f64]| {
        // Only where all are there.
        for (value, left) in values.iter_mut().zip(left.iter()) {
            *value += 0.0 * left;
        }
        allan_curve::allan(values, axis.rate_hz)
    };
    let mut measured = axis.residual.whole().to_vec();
    let replaced = axis.residual.waves().iter().filter(|wave| !is_course(wave));
    replaced.for_each(|wave| wave.take_out(&mut measured));
    let measured = curve(&mut measured);
    let rest = allan_curve::allan(&left, axis.rate_hz);
    let course = |waves: &mut dyn Iterator<Item = &Wave>| {
        let mut values = vec![0.0; left.len()];
        waves.for_each(|wave| wave.take_out(&mut values));
        curve(&mut values)
    };
    let all = course(&mut axis.residual.waves().iter().filter(is_course));
    let most = (left.len() as u64) / LEAST_INTERVALS;
    let (m, worst) = loudest(&measured, [&rest, &all], most)?;
    if worst <= 1.0 {
        return None;
    }
    let sizes = axis.explanations().iter().filter(has_waves).map(|one| {
        let own = course(&mut one.waves().iter().filter(is_course));
        (one.kind(), at(&own, m))
    });
    let largest = sizes.max_by(|a, b| a.1.total_cmp(&b.1));
    largest.map(|(kind, _)| kind)
}

/// Whether the levels that stretches of motion leave are taken back by what is between the stretches: a sensor that
/// settles slowly to where it was.
fn levels_are_cancelled(axis: &AxisState) -> bool {
    let motions = axis.explanations().iter();
    let motions = motions.filter(|one| one.kind() == motion::KIND);
    let stays = |wave: &&Wave| matches!(wave, Wave::Steps(_));
    let waves: Vec<&Wave> = motions.flat_map(Explanation::waves).filter(stays).collect();
    if waves.is_empty() {
        return false;
    }
    let mut levels = vec![0.0; axis.filled.len()];
    // Taken out of nothing: what is put back, with the other sign.
    waves.iter().for_each(|wave| wave.take_out(&mut levels));
    let both: Vec<f64> = levels
        .iter()
        .zip(axis.filled.iter())
        .map(|(level, rest)| rest - level)
        .collect();
    let [both, rest, levels] =
        [&both, &*axis.filled, &levels].map(|values| allan_curve::allan(values, axis.rate_hz));
    let most = (axis.filled.len() as u64) / LEAST_INTERVALS;
    loudest(&both, [&rest, &levels], most).is_some_and(|(_, worst)| worst > 1.0)
}

/// Where two parts together are loudest beside what was measured, up to means over `most` samples, and how loud beside
/// what may be.
fn loudest(measured: &[Point], parts: [&[Point]; 2], most: u64) -> Option<(u64, f64)> {
    let points = measured.iter().filter(|point| point.m <= most);
    let beyond = points.map(|point| {
        let sum: f64 = parts.iter().map(|part| at(part, point.m)).sum();
        let allowed = (1.0 + GOOD_PERCENT / 100.0).powi(2) + SIGMAS * (2.0 / point.edf).sqrt();
        (point.m, sum / (allowed * point.variance))
    });
    beyond.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Variance of a curve at `m` samples; zero where it has no such point.
fn at(curve: &[Point], m: u64) -> f64 {
    let found = curve.iter().find(|point| point.m == m);
    found.map_or(0.0, |point| point.variance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::explanation::{Candidate, Change};
    use crate::diagnosis::loser::Loser;
    use crate::diagnosis::result::estimate::Estimate;
    use crate::diagnosis::result::value::Value;
    use crate::diagnosis::trial::{RATE_HZ, axis, heard, jump, line, no_course, short, take_in};
    use crate::model::{sinusoid, steps};

    /// Noise about a level that rises by 3 in the middle, with a step of this height taken out there.
    fn stepped(seed: u64, taken: f64) -> AxisState {
        let middle = short(seed) / 2;
        let mut axis = axis(seed, short(seed), |n, noise| {
            noise + if n < middle { 0.0 } else { 3.0 }
        });
        take_in(&mut axis, steps::KIND, jump(middle, taken).into());
        axis
    }

    #[test]
    fn a_step_that_is_there_stays() {
        let mut axis = stepped(1, 3.0);
        heard(&DOUBT, &mut axis, false);
        assert!(axis.has(steps::KIND), "seed 1");
    }

    #[test]
    fn of_two_courses_the_one_that_the_rest_takes_back_goes() {
        let mut axis = stepped(1, 6.0);
        take_in(&mut axis, sinusoid::KIND, line(50.0, 0.01).into());
        heard(&DOUBT, &mut axis, false);
        assert_eq!(axis.kinds(), [sinusoid::KIND], "seed 1");
    }

    #[test]
    fn the_first_course_that_goes_is_not_named_again() {
        let mut axis = stepped(1, 6.0);
        take_in(&mut axis, sinusoid::KIND, line(50.0, 0.01).into());
        let gone = no_course(&DOUBT, &mut axis);
        assert_eq!(gone, Some(Loser::course(steps::KIND)), "seed 1");
        // Of two that go it is one: the other may have been found for it.
        let mut axis = stepped(1, 6.0);
        take_in(&mut axis, sinusoid::KIND, line(50.0, 3.0).into());
        assert!(no_course(&DOUBT, &mut axis).is_some(), "seed 1");
        assert_eq!(axis.kinds(), [], "seed 1");
        let mut axis = stepped(1, 3.0);
        assert_eq!(no_course(&DOUBT, &mut axis), None, "seed 1: it stays");
    }

    #[test]
    fn levels_that_motion_leaves_stay_where_they_are_there() {
        for (taken, are_there) in [(3.0, true), (6.0, false)] {
            let middle = short(1) / 2;
            let mut axis = axis(1, short(1), |n, noise| {
                noise + if n < middle { 0.0 } else { 3.0 }
            });
            let row = [
                middle as f64 / RATE_HZ,
                0.01,
                taken,
                100.0,
                10.0,
                1.0,
                0.0,
                0.0,
            ];
            let change = Change::Happened {
                masked: vec![middle..middle + 10],
                waves: vec![jump(middle, taken)],
            };
            let effect = Estimate::new(motion::KIND, row.map(Value::exact));
            let candidate = Candidate::new(effect, 1e-9, 6.0, change);
            axis.accept(candidate).expect("a fit");
            heard(&DOUBT, &mut axis, false);
            // It happened, wherever the sensor lay afterwards.
            assert_eq!(axis.kinds(), [motion::KIND], "seed 1, {taken}");
            let waves = axis.explanations()[0].waves();
            assert_eq!(!waves.is_empty(), are_there, "seed 1, {taken}");
        }
    }

    #[test]
    fn means_over_most_of_the_record_say_nothing() {
        let point = |m: u64, variance: f64| Point {
            m,
            tau_s: m as f64,
            variance,
            terms: 1000,
            stride: 1,
            edf: 1000.0,
            lo: 0.0,
            hi: 0.0,
            bridged: false,
            white_bias: 1.0,
        };
        let measured = [point(1, 1.0), point(64, 1.0)];
        let rest = [point(1, 1.0), point(64, 9.0)];
        let (m, worst) = loudest(&measured, [&rest, &[]], 32).expect("a point");
        assert!(m == 1 && worst < 1.0, "{m}: {worst}");
        let (m, worst) = loudest(&measured, [&rest, &[]], 64).expect("a point");
        assert!(m == 64 && worst > 1.0, "{m}: {worst}");
    }

    #[test]
    fn a_step_that_the_rest_takes_back_goes() {
        let mut axis = stepped(1, 6.0);
        heard(&DOUBT, &mut axis, false);
        assert!(!axis.has(steps::KIND), "seed 1");
    }
}
