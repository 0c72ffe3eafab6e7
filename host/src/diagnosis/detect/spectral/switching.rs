//! Switching between two levels in place of jumps that were named one by one: Markov noise is the best of the
//! laws, and the record rather switches.

use super::strongest_law;
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::look::{Lesson, Look, Proposal};
use crate::diagnosis::detect::telegraph::{is_read_off, log_odds};
use crate::diagnosis::laws;
use crate::diagnosis::laws::search;
use crate::model::telegraph::KIND;
use crate::model::{markov, steps};

/// Jumps that were named one by one and belong to a switching of which more is left: what is to be done
/// where Markov noise is the best of the laws.
///
/// # Errors
/// [`NoFit`] where the record with the jumps put back cannot be fitted.
pub fn in_place_of_jumps(look: &Look<'_>) -> Result<Option<Vec<Proposal>>, NoFit> {
    if look.character.level_switches || is_read_off(look.axis) {
        return Ok(None);
    }
    if look.axis.has(KIND) {
        return Ok(Some(vec![
            Proposal::Learn(Lesson::LevelSwitches),
            Proposal::Withdraw(vec![KIND]),
        ]));
    }
    with_jumps(look)
}

/// The switching between two levels, where it is what makes the spectrum's low end, jumps that were named one
/// by one being part of it or not.
///
/// # Errors
/// [`NoFit`] where the record with the jumps put back cannot be fitted.
pub fn anywhere(look: &Look<'_>) -> Result<Option<Vec<Proposal>>, NoFit> {
    if look.character.level_switches || !look.is_open(KIND) {
        return Ok(None);
    }
    if switches(look, look.axis, &[])? {
        return as_law(look).map(Some);
    }
    with_jumps(look)
}

/// The same with the jumps that were named one by one put back, if they go to and fro by its height.
fn with_jumps(look: &Look<'_>) -> Result<Option<Vec<Proposal>>, NoFit> {
    let jumps = back_and_forth(look.axis);
    if jumps.is_empty() || !look.is_open(KIND) {
        return Ok(None);
    }
    let mut without = look.axis.clone();
    without.withdraw(steps::KIND);
    without.refresh()?;
    if !switches(look, &without, &jumps)? {
        return Ok(None);
    }
    let look = Look {
        axis: &without,
        ..*look
    };
    let mut proposals = vec![Proposal::Withdraw(vec![steps::KIND])];
    proposals.extend(as_law(&look)?);
    Ok(Some(proposals))
}

/// The best law of an axis that switches.
fn as_law(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let mut character = look.character.clone();
    character.level_switches = true;
    let look = Look {
        character: &character,
        ..*look
    };
    let mut proposals = vec![Proposal::Learn(Lesson::LevelSwitches)];
    proposals.extend(strongest_law(&look)?);
    Ok(proposals)
}

/// Whether there is Markov noise in an axis that rather switches between two levels, of the height of the
/// `jumps`.
fn switches(look: &Look<'_>, axis: &AxisState, jumps: &[f64]) -> Result<bool, NoFit> {
    /// Largest factor between a jump and the height: a choice, that of jumps to and fro.
    const ALIKE: f64 = 1.6;
    /// Logarithm of the odds, 20 to 1, that take a jump back, which by itself widens the law of
    /// amplitudes.
    const PUT_BACK: f64 = 3.0;
    let starts = axis.starts().ok_or(NoFit)?;
    let found = search::search(axis.fitted(), &starts, markov::KIND);
    let Some(found) = found.filter(|one| one.p_value < look.level()) else {
        return Ok(false);
    };
    let component = laws::component_of(&axis.bins, &axis.laws, axis.laws.len());
    let height = 2.0 * found.fit.squared[component].sqrt();
    let alike = |jump: &f64| (height / jump.abs()).ln().abs() < ALIKE.ln();
    if !jumps.iter().all(alike) {
        return Ok(false);
    }
    let odds = log_odds(axis, &found.law, &found.fit);
    let least = if jumps.is_empty() { 0.0 } else { PUT_BACK };
    Ok(odds.is_some_and(|odds| odds > least))
}

/// Heights of the jumps that were named one by one, if each goes back where the one before came from.
fn back_and_forth(axis: &AxisState) -> Vec<f64> {
    let heights: Vec<f64> = axis.residual.jumps().map(|jump| jump.height).collect();
    let back = heights.windows(2).all(|pair| pair[0] * pair[1] < 0.0);
    if back { heights } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};

    /// A level that switches by 4, and two of its jumps, there and back.
    fn switching(seed: u64) -> (Trial, [crate::diagnosis::record::wave::Jump; 2]) {
        let (values, moments) = trial::switching(seed, 4.0);
        let jumps = [(100, -4.0), (201, 4.0)].map(|(place, by)| trial::jump(moments[place], by));
        (Trial::new(values), jumps)
    }

    fn are_of_it(trial: &Trial, jumps: &[f64]) -> bool {
        let found = trial.look(|look| switches(look, look.axis, jumps));
        found.expect("a record that can be fitted")
    }

    fn in_place(trial: &Trial) -> Option<Vec<Proposal>> {
        let found = trial.look(in_place_of_jumps);
        found.expect("a record that can be fitted")
    }

    #[test]
    fn jumps_of_another_height_are_none_of_a_switching() {
        let (trial, _) = switching(20);
        assert!(are_of_it(&trial, &[]), "seed 20");
        assert!(are_of_it(&trial, &[4.0, -4.0]), "seed 20");
        assert!(!are_of_it(&trial, &[4.0, -8.0]), "seed 20");
    }

    #[test]
    fn what_no_level_holds_for_significant_switches_nowhere() {
        let (mut trial, _) = switching(21);
        assert!(are_of_it(&trial, &[]), "seed 21");
        trial.level = 0.0;
        assert!(!are_of_it(&trial, &[]), "seed 21");
    }

    #[test]
    fn noise_of_normal_amplitudes_does_not_switch() {
        let keep = f64::exp(-0.08);
        let mut normal = crate::diagnosis::trial::numbers(22, 4);
        let mut level = 0.0;
        let values = noise(22).into_iter().map(|value| {
            level = keep * level + 2.0 * f64::sqrt(1.0 - keep * keep) * normal.draw();
            value + level
        });
        assert!(!are_of_it(&Trial::new(values.collect()), &[]), "seed 22");
    }

    #[test]
    fn only_jumps_are_put_back_and_only_once() {
        let (mut trial, jumps) = switching(23);
        assert!(in_place(&trial).is_none(), "seed 23: no jumps");
        trial.know(steps::KIND, [4.0, 10.0], trial::steps(&jumps));
        assert!(in_place(&trial).is_some(), "seed 23");
        trial.character.level_switches = true;
        assert!(in_place(&trial).is_none(), "seed 23: known");
    }

    #[test]
    fn jumps_are_put_back_for_plain_odds_alone() {
        for (seed, height) in [(25, 0.6), (26, 0.8)] {
            let trial = Trial::new(trial::switching(seed, height).0);
            assert!(are_of_it(&trial, &[]), "seed {seed}");
            assert!(!are_of_it(&trial, &[height, -height]), "seed {seed}");
        }
    }
}
