//! The strength of the noise over time: where it moves all the time, no stretch of it is a burst.

use super::Detector;
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::look::{Lesson, Look, Proposal};
use crate::diagnosis::steady;
use crate::model::burst::Burst;
use crate::model::kind::Kind;
use crate::model::{burst, outliers, rounding};

/// Looks whether it moves, in a cycle or slowly; the test for a cycle is counted with its detector.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    // On a coarse grid noise seems to change wherever its level lies within a step.
    if look.character.strength_moves || look.axis.has(rounding::KIND) {
        return Ok(Vec::new());
    }
    let wander = steady::strength::wander(&look.axis.powers());
    let known_sd = look.axis.known_movement();
    let both = wander.iter().flat_map(|one| [one.cyclic, one.slow]);
    let counted = both.filter(|one| one.counts(look.level(), known_sd));
    let Some(sd) = counted.map(|one| one.sd).max_by(f64::total_cmp) else {
        return Ok(Vec::new());
    };
    Ok(if bursts_stand_out(look.axis, sd) {
        moves_without(vec![outliers::KIND])
    } else {
        moves()
    })
}

/// Whether any known stretch is far louder than noise whose power moves by this standard deviation, over its mean, makes it.
pub fn bursts_stand_out(axis: &AxisState, sd: f64) -> bool {
    /// Deviations that no movement reaches: a choice. The power of noise that feeds on itself goes as far as some ten.
    const FAR: f64 = 30.0;
    let mut bursts = axis.explanations().iter();
    bursts.any(|one| {
        let is_far = || Burst::of(&one.effect.plain()).factor.powi(2) - 1.0 > FAR * sd;
        one.kind() == burst::KIND && is_far()
    })
}

/// What is to be done where it moves: single stretches are no causes, and samples are outliers only against the
/// noise about them.
pub fn moves() -> Vec<Proposal> {
    moves_without(vec![burst::KIND, outliers::KIND])
}

fn moves_without(kinds: Vec<Kind>) -> Vec<Proposal> {
    vec![
        Proposal::Learn(Lesson::StrengthMoves),
        Proposal::Withdraw(kinds),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::explanation::Change;

    #[test]
    fn a_stretch_far_louder_than_the_movement_stays() {
        use std::f64::consts::TAU;
        // A movement of a twentieth, and one stretch.
        let is_back = |factor: f64| {
            let values = noise(1).into_iter().enumerate();
            let moving = values.map(|(n, value)| {
                let loud = if (9000..9600).contains(&n) {
                    factor
                } else {
                    1.0
                };
                value * loud * (1.0 + 0.2 * (TAU * n as f64 / 3333.0).sin())
            });
            let mut trial = Trial::new(moving.collect());
            let change = Change::Happened {
                masked: vec![9000..9600],
                waves: Vec::new(),
            };
            trial.know(burst::KIND, [90.0, 96.0, factor, 0.0], change);
            let proposals = trial.ask(&DETECTOR);
            assert!(trial::teaches(&proposals, &Lesson::StrengthMoves), "seed 1");
            assert!(trial::withdraws(&proposals, outliers::KIND), "seed 1");
            trial::withdraws(&proposals, burst::KIND)
        };
        assert!(is_back(1.5), "seed 1: as movements are");
        assert!(!is_back(10.0), "seed 1: as none is");
    }

    #[test]
    fn strength_that_moves_is_learnt_once_and_not_on_a_grid() {
        use std::f64::consts::TAU;
        let values = noise(0).into_iter().enumerate();
        let moving = values.map(|(n, value)| value * (1.0 + 0.5 * (TAU * n as f64 / 3333.0).sin()));
        let mut trial = Trial::new(moving.collect());
        let proposals = trial.ask(&DETECTOR);
        assert!(trial::teaches(&proposals, &Lesson::StrengthMoves), "seed 0");
        for kind in [burst::KIND, outliers::KIND] {
            assert!(trial::withdraws(&proposals, kind), "seed 0: {kind}");
        }
        trial.character.strength_moves = true;
        assert!(trial.ask(&DETECTOR).is_empty(), "seed 0: again");
        trial.character.strength_moves = false;
        trial.know(rounding::KIND, [1.0], Change::Grid { decides: false });
        assert!(trial.ask(&DETECTOR).is_empty(), "seed 0: on a grid");
        assert!(
            Trial::new(noise(0)).ask(&DETECTOR).is_empty(),
            "seed 0: steady"
        );
    }
}
