//! The strength of the noise over time: where it moves all the time, no stretch of it is a burst.

use super::Detector;
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::look::{Lesson, Look, Proposal};
use crate::diagnosis::steady;
use crate::diagnosis::steady::strength::Movement;
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
    let counts = |one: &Movement| one.counts(look.level(), known_sd);
    Ok(
        if wander.is_some_and(|one| counts(&one.cyclic) || counts(&one.slow)) {
            moves()
        } else {
            Vec::new()
        },
    )
}

/// What is to be done where it moves: single stretches are no causes, and samples are outliers only against the
/// noise about them.
pub fn moves() -> Vec<Proposal> {
    vec![
        Proposal::Learn(Lesson::StrengthMoves),
        Proposal::Withdraw(vec![burst::KIND, outliers::KIND]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::explanation::Change;

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
