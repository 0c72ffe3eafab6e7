//! What follows a covariate, and what belongs to it.

use super::*;
use crate::diagnosis::detect::trial::{self, Trial, noise};
use crate::diagnosis::detect::warmup;

/// Noise that follows a covariate with a gain.
fn following(seed: u64, gain: f64) -> Trial {
    let mut values = noise(seed);
    let covariate = trial::covariate(values.len());
    for (value, covariate) in values.iter_mut().zip(&covariate) {
        *value += gain * covariate;
    }
    let mut trial = Trial::new(values);
    trial.covariate = Some(covariate);
    trial
}

#[test]
fn what_follows_a_covariate_is_found_once() {
    let mut trial = following(0, 2.0);
    let find = |trial: &Trial| trial.look(|look| super::find(look, Noise::Anew));
    let found = find(&trial).and_then(proposal).into_iter().collect();
    let found = trial::candidate(found).expect("twice the noise");
    let gain = found.effect.values[0].expect("a gain");
    // Three intervals of 95 %: six deviations.
    let half = gain.hi.expect("its end") - gain.value;
    assert!((gain.value - 2.0).abs() < 3.0 * half, "seed 0: {gain:?}");
    trial.accept(found);
    assert!(find(&trial).is_none(), "seed 0: found again");
    assert!(
        find(&following(0, 0.0)).is_none(),
        "seed 0: follows nothing"
    );
    let mut refused = following(0, 2.0);
    refused.refused.push(KIND);
    assert!(find(&refused).is_none(), "seed 0: refused");
    let mut alone = following(0, 2.0);
    alone.covariate = None;
    assert!(find(&alone).is_none(), "seed 0: no covariate");
}

#[test]
fn a_second_one_is_not_looked_for() {
    let mut trial = following(3, 3.0);
    let found = |trial: &Trial| trial.look(|look| find(look, Noise::Anew)).is_some();
    assert!(found(&trial), "seed 3");
    // Known, but nothing of it was taken out.
    trial.know(KIND, [0.0, 1.0], Change::Grid { decides: false });
    assert!(!found(&trial), "seed 3");
}

#[test]
fn a_settling_as_slow_as_the_lag_belongs_to_what_follows_the_covariate() {
    let mut trial = following(1, 0.0);
    trial.know(KIND, [2.0, 30.0], Change::Waves(Vec::new()));
    for (time_s, belongs) in [(10.0, false), (20.0, true), (45.0, true), (90.0, false)] {
        let change = SlowChange {
            wave: trial::settling(4.0, time_s),
            z: 20.0,
            gain_nats: 200.0,
            size_sd: 0.1,
            time_log_sd: 0.1,
            p_value: 1e-9,
            nats: 100.0,
        };
        let proposal = trial.look(|look| warmup::proposal(look, change));
        let found = trial::candidate(proposal.into_iter().collect()).expect("a settling");
        assert_eq!(found.amends, belongs.then_some(0), "{time_s} s");
        assert_eq!(found.effect.kind == KIND, belongs, "{time_s} s");
    }
}

#[test]
fn what_walk_was_taken_for_is_found_beside_it() {
    let trial = following(5, 0.1);
    let found = |noise| trial.look(|look| find(look, noise).is_some());
    assert!(!found(Noise::Fitted), "seed 5");
    assert!(found(Noise::Anew), "seed 5");
}
