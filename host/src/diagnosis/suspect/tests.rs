//! Limits against drawn records, and odds against what was hidden.

use rayon::prelude::*;

use super::*;
use crate::diagnosis::trial::{LEVEL, RATE_HZ, axis, short};
use crate::model::effect::Part;
use crate::model::random::Seed;
use crate::model::{powerlaw, resonance, rolloff, steps};

/// Drawn records, seeds from 0: a share of 95 % of them is known to 0.7 %, and three of that are allowed.
const RECORDS: u64 = 1000;
const TOLERANCE: f64 = 0.021;

/// Correlation time of what is hidden, seconds: between the corners of the walk and the white noise.
const TIME_S: f64 = 0.02;

/// Standard deviation that a limit can resolve from zero, and that no search would name; that of the white noise is 1.
const WEAK: f64 = 0.1;

/// A drawn axis with something of a kind in it, of the spectrum of Markov noise of this deviation.
fn hiding(seed: u64, kind: Kind, deviation: f64, time_s: f64) -> AxisState {
    let Part::Term(term) = kind.part(&as_of(kind, vec![deviation, time_s])) else {
        panic!("{kind} adds nothing");
    };
    let mut hidden = vec![0.0; short(seed)];
    let mut drawn = term.generator(RATE_HZ, Seed { seed, stream: 8 });
    drawn.add_to(&mut hidden);
    axis(seed, short(seed), |n, noise| noise + hidden[n])
}

fn suspicion(axis: &AxisState, kind: Kind) -> Suspicion {
    suspicions(axis, &[kind], LEVEL).remove(0)
}

/// In which share of drawn records the limit is no less than what is hidden.
fn covered(kind: Kind) -> f64 {
    let law = Law {
        effect: markov::KIND,
        values: vec![1.0, TIME_S],
    };
    let is_below = |&seed: &u64| {
        let axis = hiding(seed, kind, WEAK, TIME_S);
        upper(&axis, &law).is_none_or(|upper| upper >= WEAK)
    };
    let seeds = (0..RECORDS).into_par_iter();
    seeds.filter(is_below).count() as f64 / RECORDS as f64
}

#[test]
fn what_is_there_is_below_its_limit_in_95_records_of_100() {
    for kind in [markov::KIND, telegraph::KIND] {
        let share = covered(kind);
        assert!((share - 0.95).abs() < TOLERANCE, "{kind}: {share}");
    }
}

/// The bounds of all shapes where nothing is hidden and the record is `factor` times itself.
fn bounds(factor: f64) -> Vec<f64> {
    let measured = hiding(1, markov::KIND, 0.0, TIME_S).filled;
    let larger = measured.iter().map(|value| factor * value).collect();
    let axis = AxisState::new(std::sync::Arc::new(larger), RATE_HZ, None).expect("a fit");
    let limits = suspicion(&axis, markov::KIND).limits.into_iter();
    limits.filter_map(|one| one.upper).collect()
}

/// The search for an end of a profile stops within a ten-thousandth of the fall, so of the size within as much.
#[test]
fn limits_are_in_the_unit_of_the_signal() {
    let (as_it_is, larger) = (bounds(1.0), bounds(1e3));
    assert!(as_it_is.len() > 5, "{as_it_is:?}");
    assert_eq!(as_it_is.len(), larger.len());
    for (one, other) in as_it_is.iter().zip(&larger) {
        assert!((1e-3 * other / one - 1.0).abs() < 1e-3, "{one} {other}");
    }
}

#[test]
fn a_gain_reaches_what_a_name_needs_where_it_is_as_rare_as_that() {
    let mut named = 0;
    for (seed, deviation) in [(1, 0.0), (2, 0.05), (3, 0.2), (4, 0.3), (5, 0.5)] {
        let axis = hiding(seed, markov::KIND, deviation, TIME_S);
        let best = suspicion(&axis, markov::KIND).best.expect("a candidate");
        let enough = best.gain_nats >= best.needed_nats;
        assert_eq!(enough, best.p_value <= LEVEL, "seed {seed}: {best:?}");
        named += u32::from(enough);
    }
    assert!((1..=4).contains(&named), "{named} of 5");
}

#[test]
fn the_odds_tell_two_levels_from_a_wander() {
    for (hidden, sign) in [(telegraph::KIND, 1.0), (markov::KIND, -1.0)] {
        let axis = hiding(7, hidden, 2.0, TIME_S);
        let best = suspicion(&axis, telegraph::KIND).best.expect("a candidate");
        let [Rival { effect, log_odds }] = best.rivals[..] else {
            panic!("one rival: {best:?}");
        };
        assert_eq!(effect, markov::KIND);
        assert!(sign * log_odds > 0.0, "seed 7, {hidden}: {log_odds}");
        // Twice the deviation apart, each kept for twice the correlation time.
        assert!(
            (best.parameters["height"] / 4.0 - 1.0).abs() < 0.2,
            "{best:?}"
        );
        assert!(
            (best.parameters["dwell_s"] / (2.0 * TIME_S) - 1.0).abs() < 0.2,
            "{best:?}"
        );
    }
}

#[test]
fn only_kinds_with_one_shape_have_limits_and_only_laws_have_odds() {
    let axis = hiding(1, markov::KIND, 0.0, TIME_S);
    for (kind, odds, limits) in [
        (powerlaw::KIND, true, true),
        (resonance::KIND, true, false),
        (rolloff::KIND, true, false),
        (steps::KIND, false, false),
    ] {
        let one = suspicion(&axis, kind);
        let found = (one.best.is_some(), !one.limits.is_empty());
        assert_eq!(found, (odds, limits), "{one:?}");
    }
}
