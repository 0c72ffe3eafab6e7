//! The loop about the search with attempts that are made up.

use std::cell::RefCell;

use super::*;
use crate::diagnosis::trial::{NOTHING, axis, jump, law, line, made_up, short, spike};
use crate::model::kind::Kind;
use crate::model::{burst, clipping, dropped, markov, outliers, rounding, sinusoid, steps};

const SEED: u64 = 1;

/// What comes of attempts on white noise, and the kinds that each of them was refused. Every one of them has to
/// begin with nothing.
fn tried<T>(
    attempt: impl Fn(&mut AxisState, &[Loser]) -> Result<Attempt<T>, Spoilt>,
) -> (Result<AxisState, Refused>, Vec<Vec<Loser>>) {
    let first = axis(SEED, short(SEED), |_, noise| noise);
    let again = first.clone();
    let all = RefCell::new(Vec::new());
    let outcome = without_losers(
        "X",
        first,
        || Ok(again.clone()),
        |axis, refused| {
            assert_eq!(
                axis.kinds(),
                [],
                "begun with something, refused {refused:?}"
            );
            all.borrow_mut().push(refused.to_vec());
            attempt(axis, refused)
        },
    );
    (outcome.map(|(axis, ..)| axis), all.into_inner())
}

fn is_out(refused: &[Loser], kind: Kind) -> bool {
    refused.iter().any(|one| one.is_all_of(kind))
}

fn all_of(kinds: &[Kind]) -> Vec<Loser> {
    kinds.iter().copied().map(Loser::all).collect()
}

/// An attempt in which nothing was taken back.
const DONE: Attempt<()> = Attempt {
    done: (),
    loser: None,
};

/// Takes in a statement that gains `nats`, unless its kind is refused.
fn state(axis: &mut AxisState, refused: &[Loser], kind: Kind, nats: f64) {
    if !is_out(refused, kind) {
        let mut one = made_up(kind, NOTHING);
        one.held_out_nats = Some(nats);
        axis.accept(one).expect("nothing changes");
    }
}

#[test]
fn what_gains_nothing_is_refused_and_the_search_begins_anew() {
    let (outcome, refused) = tried(|axis, refused| {
        state(axis, refused, steps::KIND, 5.0);
        state(axis, refused, outliers::KIND, -1.0);
        // Found in place of the other, and no better.
        if is_out(refused, outliers::KIND) {
            state(axis, refused, burst::KIND, 0.0);
        }
        Ok(DONE)
    });
    assert_eq!(outcome.map(|axis| axis.kinds()), Ok(vec![steps::KIND]));
    let (one, both) = ([outliers::KIND], [outliers::KIND, burst::KIND]);
    assert_eq!(refused, [vec![], all_of(&one), all_of(&both)]);
}

#[test]
fn what_was_taken_back_is_refused_and_the_search_begins_anew() {
    let weak = Loser::course(steps::KIND);
    let (outcome, refused) = tried(|axis, refused| {
        state(axis, refused, burst::KIND, 5.0);
        // Weak ones at first, then strong ones as well.
        let gone = !is_out(refused, steps::KIND);
        Ok(Attempt {
            done: (),
            loser: gone.then(|| weak.clone()),
        })
    });
    assert_eq!(outcome.map(|axis| axis.kinds()), Ok(vec![burst::KIND]));
    let all = Loser::all(steps::KIND);
    assert_eq!(refused, [vec![], vec![weak.clone()], vec![weak, all]]);
}

#[test]
fn a_fit_that_fails_costs_the_effect_that_was_taken_in_last() {
    let (outcome, refused) = tried(|axis, refused| {
        state(axis, refused, steps::KIND, 5.0);
        let latest = Some(burst::KIND).filter(|kind| !is_out(refused, *kind));
        latest.map_or(Ok(DONE), |_| Err(Spoilt { latest }))
    });
    assert_eq!(outcome.map(|axis| axis.kinds()), Ok(vec![steps::KIND]));
    assert_eq!(refused, [vec![], all_of(&[burst::KIND])]);
}

#[test]
fn a_fit_that_fails_with_nothing_taken_in_is_the_end() {
    let (outcome, refused) = tried(|_, _| Err::<Attempt<()>, _>(Spoilt { latest: None }));
    let unfitted = Refused::Unfitted { axis: "X".into() };
    assert_eq!(outcome.err(), Some(unfitted));
    assert_eq!(refused.len(), 1);
}

/// More kinds than may be refused.
const MANY: [Kind; 8] = [
    burst::KIND,
    clipping::KIND,
    dropped::KIND,
    markov::KIND,
    outliers::KIND,
    rounding::KIND,
    sinusoid::KIND,
    steps::KIND,
];

#[test]
fn after_some_refusals_the_rest_is_taken_as_it_is() {
    let (outcome, refused) = tried(|axis, refused| {
        let next = MANY.iter().find(|kind| !is_out(refused, **kind));
        state(axis, refused, *next.expect("one is left"), -1.0);
        Ok(DONE)
    });
    let last = MOST_REFUSALS;
    assert_eq!(outcome.map(|axis| axis.kinds()), Ok(vec![MANY[last]]));
    assert_eq!(refused.last(), Some(&all_of(&MANY[..last])));
}

#[test]
fn after_some_refusals_a_fit_that_fails_is_the_end() {
    let (outcome, refused) = tried(|_, refused| {
        let latest = Some(MANY[refused.len()]);
        Err::<Attempt<()>, _>(Spoilt { latest })
    });
    assert!(matches!(outcome, Err(Refused::Unfitted { .. })));
    assert_eq!(refused.len(), MOST_REFUSALS + 1);
}

#[test]
fn each_explanation_is_judged_by_the_way_that_fits_it() {
    let mut axis = axis(SEED, short(SEED), |n, noise| {
        let turn = std::f64::consts::TAU * 0.05 * n as f64;
        noise + 0.3 * turn.cos()
    });
    let mut measured = made_up(outliers::KIND, spike(6000, 0.1).into());
    measured.held_out_nats = Some(3.5);
    for one in [
        made_up(steps::KIND, NOTHING),
        measured,
        made_up(sinusoid::KIND, line(50.0, 0.3).into()),
        made_up(steps::KIND, jump(5000, 1.0).into()),
        made_up(markov::KIND, law(markov::KIND, &[1.0, 0.01])),
    ] {
        axis.accept(one).expect("a fit");
    }
    let nats = held_out(&axis);
    assert_eq!(nats[..2], [None, Some(3.5)], "seed {SEED}");
    let nats: Vec<f64> = nats[2..].iter().flatten().copied().collect();
    // A line of a hundred times the noise's power there gains hundreds of nats; a jump and a law that are not
    // there gain nothing.
    assert!(nats.len() == 3 && nats[0] > 100.0, "seed {SEED}: {nats:?}");
    assert!(nats[1] < 0.0 && nats[2] < 0.0, "seed {SEED}: {nats:?}");
    assert_eq!(
        Loser::among(axis.explanations(), &held_out(&axis)),
        all_of(&[steps::KIND, markov::KIND]),
        "seed {SEED}"
    );
}
