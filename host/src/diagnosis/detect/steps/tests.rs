//! What looks like a jump and is none, and what jumps become.

use std::sync::Arc;

use super::*;
use crate::chain::Chain;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::level;
use crate::diagnosis::detect::trial::{self, Trial, noise};
use crate::diagnosis::loser::Loser;
use crate::diagnosis::statistic::matched_filter::{Match, Step, Transformer, matched};
use crate::model::random::{Gaussian, Seed};

/// Noise with jumps.
fn values(seed: u64, jumps: &[Jump]) -> Vec<f64> {
    let mut values = noise(seed);
    trial::add(&mut values, &Wave::Steps(jumps.to_vec()));
    values
}

/// The jump that is found in noise as it was fitted.
fn found(trial: &Trial) -> Option<Jump> {
    trial.look(|look| find(look, Noise::Fitted))
}

/// What becomes of all jumps that are found.
fn named(seed: u64, jumps: &[Jump]) -> Candidate {
    let trial = Trial::new(values(seed, jumps));
    trial::candidate(trial.ask(&level::IN_FITTED_NOISE))
        .unwrap_or_else(|| panic!("seed {seed}: nothing"))
}

#[test]
fn jumps_are_named_where_they_are() {
    let jumps = [trial::jump(6000, 4.0), trial::jump(12_000, 3.0)];
    let found = named(0, &jumps);
    assert_eq!(found.effect.kind, KIND, "seed 0");
    let rows = found.effect.plain();
    for (found, jump) in rows.chunks(2).zip(jumps) {
        // Placed to within a few samples, the height to 5 of its deviations in 6000 samples of a weak walk.
        assert!(
            (found[0] - jump.index as f64 / trial::RATE_HZ).abs() < 0.1,
            "seed 0: {rows:?}"
        );
        assert!(
            (found[1] / jump.height).ln().abs() < 0.1,
            "seed 0: {rows:?}"
        );
    }
    assert_eq!(rows.len(), 4, "seed 0: {rows:?}");
    assert!(self::found(&Trial::new(noise(0))).is_none(), "seed 0");
}

#[test]
fn where_the_level_switches_no_jump_is_one_by_itself() {
    let mut trial = Trial::new(values(1, &[trial::jump(9000, 4.0)]));
    assert!(found(&trial).is_some(), "seed 1");
    trial.character.level_switches = true;
    assert!(found(&trial).is_none(), "seed 1");
}

#[test]
fn a_jump_within_a_plainer_burst_is_a_part_of_it() {
    for (factor, is_found) in [(1.0, true), (4.0, false)] {
        let mut values = values(2, &[trial::jump(9000, 1.5)]);
        values[8000..10_000]
            .iter_mut()
            .for_each(|one| *one *= factor);
        let trial = Trial::new(values);
        let filter = trial.axis.whitened();
        let jump = filter::largest_jump(&trial.axis, &filter.transform, &filter.density, |n| {
            trial.axis.usable(n)
        });
        let jump = jump.expect("a record longer than its margins");
        assert!(
            jump.p_value < trial::LEVEL,
            "seed 2, factor {factor}: {jump:?}"
        );
        assert_eq!(found(&trial).is_some(), is_found, "seed 2, factor {factor}");
    }
}

#[test]
fn what_is_left_of_a_jump_is_the_same_again() {
    // Of a jump by 4, 3 were taken out; another stands by itself.
    let mut trial = Trial::new(values(
        3,
        &[trial::jump(6000, 4.0), trial::jump(12_000, 3.0)],
    ));
    let known = [trial::jump(6000, 3.0), trial::jump(12_000, 3.0)];
    trial.know(KIND, [60.0, 3.0, 120.0, 3.0], trial::steps(&known));
    let again = trial.look(|look| proposals(look, trial::jump(6002, 1.0)));
    let again = trial::candidate(again).expect("the rest of it");
    assert_eq!(again.amends, Some(0), "seed 3");
    assert!(again.reopens.is_empty(), "seed 3");
    let Change::Waves(waves) = &again.change else {
        panic!("seed 3: {:?}", again.change);
    };
    let [Wave::Steps(jumps)] = waves.as_slice() else {
        panic!("seed 3: {waves:?}");
    };
    let heights: Vec<f64> = jumps.iter().map(|one| one.height).collect();
    assert_eq!(heights, [4.0, 3.0], "seed 3");
}

#[test]
fn the_first_jumps_reopen_what_is_slower() {
    let reopens = named(4, &[trial::jump(9000, 4.0)]).reopens;
    assert_eq!(reopens, [warmup::KIND, thermal::KIND], "seed 4");
}

#[test]
fn jumps_to_and_fro_by_as_much_are_two_levels() {
    let at = |heights: &[f64]| {
        let places = [
            3000, 5100, 6500, 8200, 9900, 11_700, 13_100, 15_400, 17_000, 18_300,
        ];
        let jumps = places.into_iter().zip(heights.iter().copied());
        let jumps: Vec<Jump> = jumps
            .map(|(index, height)| trial::jump(index, height))
            .collect();
        named(5, &jumps).effect.kind
    };
    let to_and_fro = [4.0, -4.0, 4.0, -4.0, 4.0, -4.0, 4.0, -4.0];
    assert_eq!(at(&to_and_fro), crate::model::telegraph::KIND, "seed 5");
    // Some that stay, and so few that chance turns each.
    let others = [4.0, 4.0, -4.0, -4.0, 4.0, 4.0, -4.0, -4.0];
    assert_eq!(at(&others), KIND, "seed 5");
    assert_eq!(at(&to_and_fro[..6]), KIND, "seed 5");
}

#[test]
fn more_jumps_than_can_be_named_are_a_level_that_switches() {
    let jumps = |count: usize| -> Vec<Jump> {
        let height = |place: usize| if place.is_multiple_of(3) { -4.0 } else { 4.0 };
        let places = (0..count).map(|place| (2000 + 100 * place, height(place)));
        places
            .map(|(index, height)| trial::jump(index, height))
            .collect()
    };
    for (known, is_more) in [(MOST_JUMPS - 1, false), (MOST_JUMPS, true)] {
        let all = jumps(known + 1);
        let mut trial = Trial::new(values(6, &all));
        trial.know(KIND, [0.0; 2], trial::steps(&all[..known]));
        let proposals = trial.look(|look| proposals(look, all[known]));
        let learnt = trial::teaches(&proposals, &Lesson::LevelSwitches);
        assert_eq!(learnt, is_more, "seed 6, {known} known");
        assert_eq!(
            trial::withdraws(&proposals, KIND),
            is_more,
            "seed 6, {known} known"
        );
    }
}

#[test]
fn of_weak_jumps_that_were_refused_the_strong_one_is_left() {
    // In noise whose walk they raise the first is some ten deviations high, the other forty.
    let jumps = [trial::jump(5000, 1.8), trial::jump(9000, 8.0)];
    let places = |loser: Option<Loser>| -> Vec<usize> {
        let mut trial = Trial::new(values(8, &jumps));
        trial.refused.extend(loser);
        let first = found(&trial).expect("a plain jump");
        let proposed = trial.look(|look| proposals(look, first));
        let named = trial::candidate(proposed).expect("a plain jump");
        let Change::Waves(waves) = named.change else {
            panic!("no waves");
        };
        let jumps = waves.iter().flat_map(|wave| match wave {
            Wave::Steps(jumps) => jumps.clone(),
            _ => Vec::new(),
        });
        jumps.map(|jump| jump.index.div_ceil(1000)).collect()
    };
    assert_eq!(places(None), [5, 9], "seed 8");
    assert_eq!(places(Some(Loser::course(KIND))), [9], "seed 8");
}

#[test]
fn refused_jumps_are_not_named_again() {
    let mut trial = Trial::new(values(7, &[trial::jump(9000, 4.0)]));
    trial.refuse(KIND);
    assert!(trial.ask(&level::IN_FITTED_NOISE).is_empty(), "seed 7");
}

#[test]
fn a_jump_is_of_a_loud_stretch_that_is_long_and_plainer_and_holds_it() {
    let is_part = |length: usize, index: usize, z: f64| {
        let mut values = noise(8);
        values[8000..8000 + length]
            .iter_mut()
            .for_each(|one| *one *= 4.0);
        let jump = Jump {
            z,
            ..trial::jump(index, 1.5)
        };
        Trial::new(values).look(|look| is_of_burst(look, &jump, index))
    };
    assert!(is_part(2000, 9000, 20.0), "seed 8");
    assert!(!is_part(2000, 15_000, 20.0), "seed 8: elsewhere");
    assert!(!is_part(2000, 9000, 60.0), "seed 8: a plainer jump");
    assert!(!is_part(600, 8300, 20.0), "seed 8: a short stretch");
}

#[test]
fn levels_that_a_stretch_of_motion_leaves_are_its_own() {
    let mut trial = Trial::new(values(9, &[trial::jump(12_000, 4.0)]));
    let change = Change::Happened {
        masked: vec![6000..6500],
        waves: vec![Wave::Steps(vec![trial::jump(6000, 0.1)])],
    };
    trial.know(crate::model::motion::KIND, [0.0; 8], change);
    let found = trial.look(|look| proposals(look, trial::jump(12_000, 4.0)));
    let found = trial::candidate(found).expect("a jump");
    assert_eq!(found.amends, None, "seed 9");
    assert_eq!(found.effect.values.len(), 2, "seed 9: {:?}", found.effect);
}

#[test]
fn what_a_filter_shuts_out_says_nothing_of_jumps() {
    let seed = 10;
    let chain: Chain = "ads1281:linear".parse().expect("a chain");
    let axis = AxisState::new(Arc::new(noise(seed)), trial::RATE_HZ, Some(&chain));
    let axis = axis.expect("a spectrum");
    let ring = Transformer::new(1 << 14);
    let law = |floor: f64| -> Vec<f64> {
        let f_hz = |k: usize| k as f64 * trial::RATE_HZ / ring.len() as f64;
        let power = |k: usize| chain.power(f_hz(k), trial::RATE_HZ);
        (0..=ring.len() / 2).map(|k| power(k) + floor).collect()
    };
    // In the band that the filter shuts out there is ten times as much as is known.
    let mut normal = Gaussian::new(Seed { seed, stream: 5 }, 1.0);
    let values = ring.noise(&law(1e-4), trial::RATE_HZ, || normal.draw());
    let (whole, density) = (ring.transform_ring(values, trial::RATE_HZ), law(1e-5));
    let largest = |filter: &Match| filter.z.iter().fold(0.0, |most: f64, z| most.max(z.abs()));
    let ahead = largest(&filter::statistic(&axis, &whole, &density));
    let behind = largest(&matched(&whole, &density, &Step));
    // Of 16 000 normal numbers one lies beyond 6 in 30 000 records.
    assert!(
        ahead < 6.0 && behind > 8.0,
        "{ahead}, {behind}, seed {seed}"
    );
}

#[test]
fn a_strong_jump_is_measured_again_in_the_noise_that_is_left() {
    // The weak one is a few deviations high: it raised no noise.
    for (seed, height, is_again) in [(70, 400.0, true), (71, 0.1, false)] {
        let known = 1.02;
        let mut trial = Trial::new(values(seed, &[trial::jump(9000, height)]));
        let jump = Jump {
            height_sd: 30.0,
            ..trial::jump(9000, known * height)
        };
        let time_s = 9000.0 / trial::RATE_HZ;
        trial.know(KIND, [time_s, known * height], trial::steps(&[jump]));
        let again = trial.look(measured_again);
        assert_eq!(again.is_some(), is_again, "seed {seed}");
        let Some(Proposal::Explain(better)) = again else {
            continue;
        };
        assert_eq!(better.amends, Some(0), "seed {seed}");
        // Half a dozen deviations in the weak walk of the trial's noise.
        let off = better.effect.plain()[1] / height - 1.0;
        assert!(off.abs() < 2e-3, "seed {seed}: {off}");
    }
}
