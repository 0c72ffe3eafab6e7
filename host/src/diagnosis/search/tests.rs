//! The search with detectors that are made up.

use std::sync::Mutex;

use super::*;
use crate::diagnosis::detect::look::Lesson;
use crate::diagnosis::explanation::Change;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::trial::{
    LEVEL, axis, excluded, jump, law, line, made_up, short, spike, take_in,
};
use crate::diagnosis::values::ValueFindings;
use crate::model::{burst, markov, outliers, resonance, sinusoid, steps};
use crate::spectrum::Line;

/// What was learnt and the last kind, or none of both.
type Outcome = Result<(Character, Option<Kind>), Spoilt>;

/// What comes of a search by detectors that are made up, `refused` kinds aside, and what was told of it.
fn search(
    axis: &mut AxisState,
    refused: &[Loser],
    before_rounds: &[&Detector],
    round: &[&Detector],
) -> (Outcome, Vec<Kind>) {
    let told = Mutex::new(Vec::new());
    let decided = |decision| {
        if let Decision::Taken { kind, .. } = decision {
            told.lock().expect("no panic").push(kind);
        }
    };
    let values = ValueFindings::default();
    let context = Context {
        level: LEVEL,
        covariate: None,
        values: &values,
        refused,
        decided: &decided,
    };
    let plan = Plan {
        before_rounds,
        round,
        again: round,
    };
    let done = Search::new(axis, &context).follow_plan(&plan);
    (done, told.into_inner().expect("no panic"))
}

fn noise(seed: u64) -> AxisState {
    axis(seed, short(seed), |_, noise| noise)
}

fn explain(kind: Kind, change: Change) -> Vec<Proposal> {
    vec![Proposal::Explain(Box::new(made_up(kind, change)))]
}

/// Two things one after the other, which it sees.
const EAGER: Detector = Detector {
    tests: 0,
    look: |look| {
        Ok(match look.axis.explanations().len() {
            0 => explain(steps::KIND, jump(5000, 0.1).into()),
            1 => explain(outliers::KIND, spike(6000, 0.1).into()),
            _ => Vec::new(),
        })
    },
};

/// A line, once.
const PATIENT: Detector = Detector {
    tests: 0,
    look: |look| {
        let is_new = look.is_open(sinusoid::KIND) && !look.axis.has(sinusoid::KIND);
        let line = || explain(sinusoid::KIND, line(50.0, 0.1).into());
        Ok(if is_new { line() } else { Vec::new() })
    },
};

/// One that does not ask what is refused.
const STUBBORN: Detector = Detector {
    tests: 0,
    look: |_| Ok(explain(burst::KIND, Change::Mask(vec![100..200]))),
};

/// Leaves nothing of a record.
const GREEDY: Detector = Detector {
    tests: 0,
    look: |look| {
        let all = 0..look.axis.residual.len();
        Ok(explain(burst::KIND, Change::Mask(vec![all])))
    },
};

/// A step that is higher than any value, once.
const BOUNDLESS: Detector = Detector {
    tests: 0,
    look: |look| {
        let mut high = made_up(steps::KIND, jump(5000, 0.1).into());
        high.effect = Estimate::new(steps::KIND, [1.0, 1e6].map(Value::exact));
        let is_new = !look.axis.has(steps::KIND);
        let proposal = is_new.then(|| Proposal::Explain(Box::new(high)));
        Ok(proposal.into_iter().collect())
    },
};

/// A weak burst, as long as there is no line.
const WAVERING: Detector = Detector {
    tests: 0,
    look: |look| {
        let mut weak = made_up(burst::KIND, Change::Mask(vec![100..200]));
        weak.p_value = 10.0 * LEVEL.powi(2);
        let kinds = [burst::KIND, sinusoid::KIND];
        let is_new = !kinds.iter().any(|kind| look.axis.has(*kind));
        let proposal = is_new.then(|| Proposal::Explain(Box::new(weak)));
        Ok(proposal.into_iter().collect())
    },
};

#[test]
fn what_is_weak_has_to_be_found_again_beside_all_that_was_found_since() {
    let mut axis = noise(10);
    let (done, told) = search(&mut axis, &[], &[], &[&WAVERING]);
    assert!(done.is_ok(), "seed 10");
    assert_eq!(told, [burst::KIND], "seed 10");
    assert_eq!(axis.kinds(), [burst::KIND], "seed 10");
    let mut axis = noise(10);
    let (done, told) = search(&mut axis, &[], &[], &[&WAVERING, &PATIENT]);
    assert!(done.is_ok(), "seed 10");
    assert_eq!(told, [burst::KIND, sinusoid::KIND], "seed 10");
    assert_eq!(axis.kinds(), [sinusoid::KIND], "seed 10");
}

#[test]
fn what_the_record_has_no_room_for_is_not_taken_in() {
    let mut axis = noise(9);
    let (done, told) = search(&mut axis, &[], &[], &[&BOUNDLESS, &PATIENT]);
    assert_eq!(told, [sinusoid::KIND], "seed 9");
    assert_eq!(axis.kinds(), told, "seed 9");
    assert!(done.is_ok(), "seed 9");
}

#[test]
fn a_round_ends_with_the_first_change() {
    let mut axis = noise(1);
    let (done, told) = search(&mut axis, &[], &[], &[&EAGER, &PATIENT]);
    // The first detector is asked again before the second one is.
    assert_eq!(
        told,
        [steps::KIND, outliers::KIND, sinusoid::KIND],
        "seed 1"
    );
    assert_eq!(axis.kinds(), told, "seed 1");
    assert_eq!(done.map(|(_, latest)| latest), Ok(Some(sinusoid::KIND)));
}

#[test]
fn who_found_a_law_looks_for_more_of_them_first() {
    /// A law, then another.
    const GENERAL: Detector = Detector {
        tests: 0,
        look: |look| {
            Ok(match look.axis.laws.len() {
                0 => explain(markov::KIND, law(markov::KIND, &[1.0, 0.1])),
                1 => explain(resonance::KIND, law(resonance::KIND, &[100.0, 10.0, 1.0])),
                _ => Vec::new(),
            })
        },
    };
    /// A line, once there is a law.
    const AFTER_LAWS: Detector = Detector {
        tests: 0,
        look: |look| {
            let is_new = !look.axis.laws.is_empty() && !look.axis.has(sinusoid::KIND);
            let line = || explain(sinusoid::KIND, line(50.0, 0.1).into());
            Ok(if is_new { line() } else { Vec::new() })
        },
    };
    let mut axis = noise(10);
    let (done, told) = search(&mut axis, &[], &[], &[&AFTER_LAWS, &GENERAL]);
    assert!(done.is_ok(), "seed 10: {done:?}");
    assert_eq!(told, [markov::KIND, resonance::KIND, sinusoid::KIND]);
}

#[test]
fn what_the_values_say_is_asked_before_all_rounds_until_nothing_is_new() {
    let mut axis = noise(2);
    let (_, told) = search(&mut axis, &[], &[&EAGER], &[&PATIENT]);
    assert_eq!(
        told,
        [steps::KIND, outliers::KIND, sinusoid::KIND],
        "seed 2"
    );
}

#[test]
fn a_kind_that_is_refused_is_not_taken_in() {
    let mut axis = noise(3);
    let refused = [Loser::all(burst::KIND)];
    let (done, told) = search(&mut axis, &refused, &[], &[&STUBBORN, &PATIENT]);
    assert_eq!(axis.kinds(), [sinusoid::KIND], "seed 3");
    assert_eq!(told, [sinusoid::KIND], "seed 3");
    assert!(done.is_ok(), "seed 3: {done:?}");
}

#[test]
fn a_search_that_is_spoilt_names_what_was_taken_in_last() {
    let mut axis = noise(4);
    let (done, told) = search(&mut axis, &[], &[&PATIENT], &[&GREEDY]);
    let latest = Some(burst::KIND);
    assert_eq!(done.err(), Some(Spoilt { latest }), "seed 4");
    assert_eq!(told, [sinusoid::KIND, burst::KIND], "seed 4");
}

#[test]
fn what_amends_is_no_effect_of_its_own() {
    /// The first explanation once more, as long as it is the only one.
    const AMENDING: Detector = Detector {
        tests: 0,
        look: |look| {
            let mut one = made_up(steps::KIND, jump(5000, 0.2).into());
            one.amends = Some(0);
            let is_done = look.axis.explanations()[0].effect.values.is_empty();
            one.effect.values.clear();
            let amending = vec![Proposal::Explain(Box::new(one))];
            Ok(if is_done { Vec::new() } else { amending })
        },
    };
    let mut axis = noise(5);
    take_in(&mut axis, steps::KIND, jump(5000, 0.1).into());
    let (done, told) = search(&mut axis, &[], &[], &[&AMENDING]);
    assert_eq!(told, [], "seed 5");
    assert_eq!(done.map(|(_, latest)| latest), Ok(None), "seed 5");
    assert_eq!(*axis.residual.waves(), [jump(5000, 0.2)], "seed 5");
}

/// A line, as one may be remembered.
const A_LINE: Line = Line {
    frequency_hz: 50.0,
    frequency_sd_hz: 0.01,
    amplitude: 0.1,
    ratio: 40.0,
    false_alarm: 1e-9,
};

#[test]
fn lessons_are_learnt_and_change_nothing() {
    const TEACHING: Detector = Detector {
        tests: 0,
        look: |_| {
            // The second detector sees what the first one said in the same round.
            Ok(vec![
                Proposal::Learn(Lesson::LevelSwitches),
                Proposal::Learn(Lesson::LargeSamplesInGroups(2)),
                Proposal::Learn(Lesson::StrengthMoves),
                Proposal::Learn(Lesson::OutliersSoughtAmong(3)),
                Proposal::Learn(Lesson::LinesWithoutLoss(vec![A_LINE])),
            ])
        },
    };
    const TAUGHT: Detector = Detector {
        tests: 0,
        look: |look| {
            let knows = look.character.strength_moves && !look.axis.has(sinusoid::KIND);
            let line = || explain(sinusoid::KIND, line(50.0, 0.1).into());
            Ok(if knows { line() } else { Vec::new() })
        },
    };
    let mut axis = noise(6);
    let (done, told) = search(&mut axis, &[], &[], &[&TEACHING, &TAUGHT]);
    let expected = Character {
        level_switches: true,
        large_samples_in_groups: Some(2),
        strength_moves: true,
        outliers_sought_among: 3,
        lines_without_loss: vec![A_LINE],
    };
    assert_eq!(done, Ok((expected, Some(sinusoid::KIND))), "seed 6");
    assert_eq!(told, [sinusoid::KIND], "seed 6");
}

#[test]
fn a_band_is_excluded_with_all_laws_and_the_kinds_that_were_found_for_it() {
    const EXCLUDING: Detector = Detector {
        tests: 0,
        look: |look| {
            let exclude = || {
                vec![
                    Proposal::Learn(Lesson::LevelSwitches),
                    Proposal::Exclude(excluded(100.0, 150.0), vec![outliers::KIND]),
                ]
            };
            let is_done = !look.axis.excluded().is_empty();
            Ok(if is_done { Vec::new() } else { exclude() })
        },
    };
    let mut axis = noise(7);
    take_in(&mut axis, markov::KIND, law(markov::KIND, &[1.0, 0.1]));
    take_in(&mut axis, outliers::KIND, spike(6000, 0.1).into());
    take_in(&mut axis, sinusoid::KIND, line(50.0, 0.1).into());
    let (done, _) = search(&mut axis, &[], &[], &[&EXCLUDING]);
    assert_eq!(axis.kinds(), [sinusoid::KIND], "seed 7");
    assert!(axis.laws.is_empty(), "seed 7: {:?}", axis.laws);
    assert_eq!(axis.excluded_hz(), [100.0..150.0], "seed 7");
    // What was learnt of the band while it was in does not count.
    let (character, _) = done.expect("a fit");
    assert_eq!(character, Character::default(), "seed 7");
}

#[test]
fn a_line_is_excluded_by_itself() {
    const EXCLUDING: Detector = Detector {
        tests: 0,
        look: |look| {
            let count = look.axis.excluded().len() as f64;
            let line = || Proposal::ExcludeLine(excluded(100.0 + count, 101.0 + count));
            Ok(if count < 2.0 {
                vec![line()]
            } else {
                Vec::new()
            })
        },
    };
    let mut axis = noise(8);
    let ringing = law(resonance::KIND, &[100.0, 10.0, 1.0]);
    take_in(&mut axis, resonance::KIND, ringing);
    let (done, _) = search(&mut axis, &[], &[], &[&EXCLUDING]);
    assert!(done.is_ok(), "seed 8: {done:?}");
    assert_eq!(axis.excluded_hz(), [100.0..101.0, 101.0..102.0], "seed 8");
    assert_eq!(axis.kinds(), [resonance::KIND], "seed 8");
}

#[test]
fn what_is_withdrawn_is_looked_for_again() {
    const WITHDRAWING: Detector = Detector {
        tests: 0,
        look: |_| Ok(vec![Proposal::Withdraw(vec![steps::KIND])]),
    };
    let mut axis = noise(9);
    take_in(&mut axis, steps::KIND, jump(5000, 0.1).into());
    let (done, told) = search(&mut axis, &[], &[], &[&WITHDRAWING, &PATIENT]);
    // Where there is none of it any more the round goes on.
    assert_eq!(told, [sinusoid::KIND], "seed 9: {done:?}");
    assert_eq!(axis.kinds(), [sinusoid::KIND], "seed 9");
    assert_eq!(*axis.residual.waves(), [line(50.0, 0.1)], "seed 9");
}
