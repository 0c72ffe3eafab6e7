//! What follows a covariate, and what belongs to it.

use super::*;
use crate::diagnosis::detect::again;
use crate::diagnosis::detect::trial::{self, Trial, noise};
use crate::diagnosis::record::wave::Wave;
use crate::model::follows::{Follows, Leader};
use crate::model::random::{Gaussian, Seed};

/// Noise that follows a covariate with a gain.
fn following(seed: u64, gain: f64) -> Trial {
    let mut values = noise(seed);
    let covariate = trial::covariate(values.len());
    for (value, covariate) in values.iter_mut().zip(&covariate) {
        *value += gain * covariate;
    }
    let mut trial = Trial::new(values);
    trial.covariate = Some(Reading::exact(covariate));
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
    refused.refuse(KIND);
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

/// A covariate as the record has it, and noise that follows it behind a lag of so many seconds; before the record the covariate was
/// higher by `start` for long. It is read with noise of a deviation.
fn lagging(seed: u64, [gain, lag_s, start]: [f64; 3], reading: f64) -> Trial {
    let mut values = noise(seed);
    let mut covariate = trial::covariate(values.len());
    let follows = Follows {
        leader: Leader::Temperature,
        gain,
        lag_s,
    };
    let mut follower = follows.follower(trial::RATE_HZ, 0.0);
    // One sample of what was there before it.
    follower.add_to(&[covariate[0] + start], &mut [0.0]);
    follower.add_to(&covariate, &mut values);
    if reading > 0.0 {
        let mut normal = Gaussian::new(Seed { seed, stream: 7 }, reading);
        covariate
            .iter_mut()
            .for_each(|value| *value += normal.draw());
    }
    let mut trial = Trial::new(values);
    trial.covariate = Some(if reading > 0.0 {
        Reading::of(&covariate)
    } else {
        Reading::exact(covariate)
    });
    trial
}

/// What is found beside walk, taken in.
fn taken_in(trial: &mut Trial) -> Candidate {
    let found = trial.look(|look| find(look, Noise::Anew));
    let found = found.and_then(proposal).into_iter().collect();
    let found = trial::candidate(found).expect("what follows");
    trial.accept(found.clone());
    found
}

#[test]
fn where_the_column_was_before_the_record_does_not_change_the_lag() {
    for (seed, start) in (30..).zip([0.0, 0.5, -0.5]) {
        let (gain, lag_s) = (100.0, 8.0);
        let mut trial = lagging(seed, [gain, lag_s, start], 0.0);
        taken_in(&mut trial);
        while let Some(better) = trial::candidate(trial.look(again::proposals)) {
            trial.accept(better);
        }
        let effect = &trial.axis.explanations()[0].effect;
        for (value, is) in effect.values.iter().zip([gain, lag_s]) {
            let value = value.expect("a number");
            let half = value.hi.expect("its end") - value.value;
            // Three intervals of 95 %, six deviations. At rest as the record begins the lag would be off by a tenth.
            assert!(
                (value.value - is).abs() < 3.0 * half,
                "seed {seed}: {value:?}, {is}"
            );
            assert!(half < 0.01 * is, "seed {seed}: {value:?}");
        }
        let Some(Wave::WarmUp { amplitude, .. }) = trial.axis.explanations()[0].waves().get(1)
        else {
            panic!("seed {seed}: it does not settle");
        };
        // A hundred samples of noise of deviation 1 know it to a tenth.
        assert!(
            (amplitude - gain * start).abs() < 0.6,
            "seed {seed}: {amplitude}"
        );
    }
}

#[test]
fn noise_of_the_reading_that_is_louder_than_the_signals_is_left_out() {
    let seed = 34;
    let absorbs = |reading: f64| {
        let mut trial = lagging(seed, [1000.0, 0.0, 0.0], reading);
        taken_in(&mut trial);
        while let Some(better) = trial::candidate(trial.look(again::proposals)) {
            trial.accept(better);
        }
        trial.axis.absorbed_hz()
    };
    assert_eq!(absorbs(0.0), None, "seed {seed}");
    // Ten times as loud as the signal's own: out to where the column is smoothed, some fifty times its three waves a record.
    let band = absorbs(0.01).expect("a band");
    let wave_hz = 3.0 * trial::RATE_HZ / noise(seed).len() as f64;
    assert!(
        band.end > wave_hz && band.end < 50.0 * wave_hz,
        "seed {seed}: {band:?}"
    );
    assert_eq!(absorbs(1e-4), None, "seed {seed}: a tenth");
}

#[test]
fn what_walk_was_taken_for_is_found_beside_it() {
    let trial = following(5, 0.1);
    let found = |noise| trial.look(|look| find(look, noise).is_some());
    assert!(!found(Noise::Fitted), "seed 5");
    assert!(found(Noise::Anew), "seed 5");
}
