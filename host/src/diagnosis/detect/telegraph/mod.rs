//! Telegraph noise: the level jumps to and fro between two levels.
//!
//! It is told in one of two ways. Few jumps are taken out one by one ([steps](super::steps)) and
//! recognised by going to and fro by as much; many are seen by their spectrum, which is that of Markov
//! noise, and told from it by the law of amplitudes ([`two_levels`]).

mod two_levels;

use super::spectral;
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::explanation::{Candidate, Estimate};
use crate::diagnosis::laws::search::{self, Found};
use crate::diagnosis::laws::{self, Law};
use crate::diagnosis::record::wave::Jump;
use crate::diagnosis::result::finding::Value;
use crate::diagnosis::search::{Lesson, Look, Proposal};
use crate::fit::likelihood::Fit;
use crate::model::effect::Part;
use crate::model::markov;
use crate::model::markov::Markov;
use crate::model::telegraph::{KIND, Telegraph};

/// Jumps from which up and down by turns is a switch rather than steps.
const LEAST_JUMPS: usize = 3;

/// What is known of the two levels of an axis, if it has a telegraph.
pub fn levels(axis: &AxisState) -> Option<Telegraph> {
    let one = axis.explanation(KIND)?;
    let Some(number) = axis.law_number(one) else {
        return Some(Telegraph::of(&one.effect.plain()));
    };
    let values = laws::sized(&axis.frame, &axis.laws, number, &axis.fit);
    Some(Telegraph::with_spectrum_of(&Markov::of(&values)))
}

/// Two levels by their jumps.
pub fn of_jumps(jumps: &[Jump], duration_s: f64) -> Estimate {
    let whole = whole_jumps(jumps);
    let count = whole.len() as f64;
    let heights: Vec<f64> = whole.iter().map(|jump| jump.height.abs()).collect();
    let height = heights.iter().sum::<f64>() / count;
    let squares = heights.iter().map(|one| (one - height).powi(2));
    let scatter = squares.sum::<f64>() / count;
    let own = whole.iter().map(|jump| jump.height_sd.powi(2)).sum::<f64>() / count;
    Estimate::new(
        KIND,
        [
            Value::normal(height, (scatter.max(own) / count).sqrt()),
            Value::log_normal(duration_s / count, count.sqrt().recip()),
        ],
    )
}

/// Two levels of the spectrum of Markov noise, by the parameters of that.
pub fn of_law(markov: &[Value]) -> Estimate {
    let twice = |value: &Value| value.map(Telegraph::per_markov);
    Estimate::new(KIND, markov.iter().map(twice))
}

/// Whether jumps go up and down by turns, by about as much: two levels.
pub fn is_to_and_fro(jumps: &[Jump]) -> bool {
    /// Share of the squared heights that is not between the two levels, at most.
    const REST: f64 = 0.1;
    let energy = |jumps: &[Jump]| jumps.iter().map(|jump| jump.height.powi(2)).sum::<f64>();
    let whole = whole_jumps(jumps);
    if whole.len() < LEAST_JUMPS || energy(&whole) < (1.0 - REST) * energy(jumps) {
        return false;
    }
    let turns = whole
        .windows(2)
        .filter(|pair| pair[0].height * pair[1].height < 0.0)
        .count();
    let mean = whole.iter().map(|jump| jump.height.abs()).sum::<f64>() / whole.len() as f64;
    let alike = whole
        .iter()
        .filter(|jump| (0.6..1.6).contains(&(jump.height.abs() / mean)))
        .count();
    5 * turns >= 4 * (whole.len() - 1) && 5 * alike >= 4 * whole.len()
}

/// The jumps between two levels among all: what the placing of one left beside it is smaller.
fn whole_jumps(jumps: &[Jump]) -> Vec<Jump> {
    /// Share of the upper quartile's height that a whole jump has.
    const SHARE: f64 = 0.5;
    let mut heights: Vec<f64> = jumps.iter().map(|jump| jump.height.abs()).collect();
    heights.sort_by(f64::total_cmp);
    let typical = heights.get(3 * heights.len() / 4).copied().unwrap_or(0.0);
    let is_whole = |jump: &&Jump| jump.height.abs() >= SHARE * typical;
    jumps.iter().filter(is_whole).copied().collect()
}

/// Jumps that were named one by one and belong to a switching of which more is left: what is to be done
/// where Markov noise is the best of the laws.
///
/// # Errors
/// [`NoFit`] where the record with the jumps put back cannot be fitted.
pub fn in_place_of_jumps(look: &Look<'_>) -> Result<Option<Vec<Proposal>>, NoFit> {
    if look.character.level_switches {
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
    without.withdraw(crate::model::steps::KIND);
    without.refresh()?;
    if !switches(look, &without, &jumps)? {
        return Ok(None);
    }
    let look = Look {
        axis: &without,
        ..*look
    };
    let mut proposals = vec![Proposal::Withdraw(vec![crate::model::steps::KIND])];
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
    proposals.extend(spectral::strongest_law(&look)?);
    Ok(proposals)
}

/// Whether there is Markov noise in an axis that rather switches between two levels, of the height of the
/// `jumps`.
fn switches(look: &Look<'_>, axis: &AxisState, jumps: &[f64]) -> Result<bool, NoFit> {
    /// Largest factor between a jump and the height.
    const ALIKE: f64 = 1.6;
    /// Odds that take a jump back, which by itself widens the law of amplitudes.
    const PUT_BACK: f64 = 3.0;
    let starts = axis.starts().ok_or(NoFit)?;
    let (frame, data) = (&axis.frame, &axis.data);
    let found = search::search(frame, data, &axis.laws, &axis.fit, &starts, markov::KIND);
    let Some(found) = found.filter(|one| one.p_value < look.level()) else {
        return Ok(false);
    };
    let component = laws::component_of(frame, &axis.laws, axis.laws.len());
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

/// Of laws that were found, best first, the Markov noise that may switch between two levels as well,
/// and the logarithm of the odds that it does.
pub fn among(
    look: &Look<'_>,
    found: &[Found],
    worth: impl Fn(&Found) -> f64,
) -> Option<(usize, f64)> {
    /// By how much the Markov noise may be less likely than the best.
    const NEAR: f64 = 10.0;
    // One switch is enough: what is left of it is no second one.
    if look.axis.has(KIND) || !look.is_open(KIND) {
        return None;
    }
    let place = found
        .iter()
        .position(|one| one.law.effect == markov::KIND)?;
    let near = worth(&found[0]) - worth(&found[place]) < NEAR;
    let odds = near.then(|| log_odds(look.axis, &found[place].law, &found[place].fit))??;
    Some((place, odds))
}

/// Kinds whose evidence may have been jumps of a switching.
pub fn supersede(candidate: &mut Candidate) {
    use crate::model::{outliers, steps, warmup};
    candidate.supersedes = vec![outliers::KIND, steps::KIND, warmup::KIND];
}

/// Logarithm of the odds that what looks like Markov noise in the spectrum switches between two levels.
fn log_odds(axis: &AxisState, law: &Law, fit: &Fit) -> Option<f64> {
    let component = laws::component_of(&axis.frame, &axis.laws, axis.laws.len());
    let squared = fit.squared[component];
    let time_s = Markov::of(&law.values).time_s;
    let Part::Term(term) = law.effect.part(&law.values) else {
        return None;
    };
    let wander =
        |f_hz: f64| squared * axis.frame.term_density(&*term, f_hz) * axis.frame.chain_power(f_hz);
    let rest = |f_hz: f64| axis.frame.base_density(&fit.squared, f_hz);
    two_levels::log_odds(axis, squared.sqrt(), time_s, wander, rest)
}
