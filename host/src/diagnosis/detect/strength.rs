//! The strength of the noise over time: where it moves all the time, no stretch of it is a burst.

use super::Detector;
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::look::{Lesson, Look, Proposal};
use crate::diagnosis::steady;
use crate::model::{burst, outliers, rounding};

/// Looks whether it moves, in a cycle or slowly: two tests.
pub static DETECTOR: Detector = Detector { tests: 2, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    // On a coarse grid noise seems to change wherever its level lies within a step.
    if look.character.strength_moves || look.axis.has(rounding::KIND) {
        return Ok(Vec::new());
    }
    let wander = steady::strength::wander(&look.axis.powers());
    let least = wander.map_or(1.0, |one| one.cyclic.p_value.min(one.slow.p_value));
    Ok(if least < look.level() {
        moves()
    } else {
        Vec::new()
    })
}

/// What is to be done where it moves: single stretches are no causes, and samples are outliers only against the
/// noise about them.
pub fn moves() -> Vec<Proposal> {
    vec![
        Proposal::Learn(Lesson::StrengthMoves),
        Proposal::Withdraw(vec![burst::KIND, outliers::KIND]),
    ]
}
