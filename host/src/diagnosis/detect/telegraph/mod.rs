//! Telegraph noise: the level jumps to and fro between two levels.
//!
//! It is recognised in one of three ways. Few jumps are taken out one by one ([steps](super::steps)) and
//! recognised by going to and fro by as much; many are seen by their spectrum, which is that of Markov
//! noise, and distinguished from it by the law of amplitudes ([`two_levels`]). Levels that are far apart are read off the
//! record before anything else ([`path`]).

mod differences;
mod edge;
pub mod path;
mod pulses;
pub mod short_dwells;
mod two_levels;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::look::Look;
use crate::diagnosis::explanation::Candidate;
use crate::diagnosis::laws::search::Found;
use crate::diagnosis::laws::{self, Law};
use crate::diagnosis::record::wave::{Jump, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::fit::likelihood::Fit;
use crate::model::effect::Part;
use crate::model::markov;
use crate::model::markov::Markov;
use crate::model::telegraph::{KIND, Telegraph};
use crate::numeric::order::quantile;

/// Jumps from which up and down by turns is a switch rather than steps: by chance as many turn each time once in
/// `2^(8 - 1)` records, 0.8 %. What jumped less often is known by the moments of its jumps better than by how rare they are.
const LEAST_JUMPS: usize = 8;

/// What is known of the two levels of an axis, if it has a telegraph.
pub fn levels(axis: &AxisState) -> Option<Telegraph> {
    let one = axis.explanation(KIND)?;
    let Some(number) = axis.law_number(one) else {
        return Some(Telegraph::of(&one.effect.plain()));
    };
    let values = laws::sized(&axis.bins, &axis.laws, number, &axis.fit);
    Some(Telegraph::with_spectrum_of(&Markov::of(&values)))
}

/// Whether the two levels of an axis were read off, every jump of them.
pub fn is_read_off(axis: &AxisState) -> bool {
    let is_whole = |wave: &Wave| matches!(wave, Wave::Switching(_));
    axis.residual.waves().iter().any(is_whole)
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
    /// Share of the squared heights that is not between the two levels, at most: a choice.
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

/// The jumps between two levels among all: what the placing of one left next to it is smaller.
fn whole_jumps(jumps: &[Jump]) -> Vec<Jump> {
    /// Share of the upper quartile's height that a whole jump has, at least: half, as what the
    /// placing of a jump leaves is less.
    const SHARE: f64 = 0.5;
    let mut heights: Vec<f64> = jumps.iter().map(|jump| jump.height.abs()).collect();
    let typical = quantile(&mut heights, 0.75).unwrap_or(0.0);
    let is_whole = |jump: &&Jump| jump.height.abs() >= SHARE * typical;
    jumps.iter().filter(is_whole).copied().collect()
}

/// Of laws that were found, best first, the Markov noise that may switch between two levels as well,
/// and the logarithm of the odds that it does.
pub fn among(
    look: &Look<'_>,
    found: &[Found],
    worth: impl Fn(&Found) -> f64,
) -> Option<(usize, f64)> {
    /// By how much the Markov noise may be less likely than the best, nats: a choice. Laws that
    /// come near one another compete by their amplitudes too.
    const AS_LIKELY: f64 = 10.0;
    // One switch is enough: what is left of it is no second one.
    if look.axis.has(KIND) || !look.is_open(KIND) {
        return None;
    }
    let place = found
        .iter()
        .position(|one| one.law.effect == markov::KIND)?;
    let near = worth(&found[0]) - worth(&found[place]) < AS_LIKELY;
    let odds = near.then(|| log_odds(look.axis, &found[place].law, &found[place].fit))??;
    Some((place, odds))
}

/// Kinds whose evidence may have been jumps of a switching.
pub fn supersede(candidate: &mut Candidate) {
    use crate::model::{outliers, steps, warmup};
    candidate.supersedes = vec![outliers::KIND, steps::KIND, warmup::KIND];
}

/// Logarithm of the odds that what looks like Markov noise in the spectrum switches between two levels.
pub fn log_odds(axis: &AxisState, law: &Law, fit: &Fit) -> Option<f64> {
    let component = laws::component_of(&axis.bins, &axis.laws, axis.laws.len());
    let squared = fit.squared[component];
    let time_s = Markov::of(&law.values).time_s;
    let Part::Term(term) = law.effect.part(&law.values) else {
        return None;
    };
    let wander =
        |f_hz: f64| squared * axis.bins.term_density(&*term, f_hz) * axis.bins.chain_power(f_hz);
    let rest = |f_hz: f64| axis.bins.base_density(&fit.squared, f_hz);
    two_levels::log_odds(axis, squared.sqrt(), time_s, wander, rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial;
    use crate::diagnosis::laws::search;

    /// Whether jumps of these heights are two levels, every other one down.
    fn is_two_levels(heights: &[f64]) -> bool {
        let jumps = heights.iter().enumerate();
        let jump = |(place, height): (usize, &f64)| {
            let sign = if place % 2 == 0 { 1.0 } else { -1.0 };
            trial::jump(1000 * (place + 1), sign * height)
        };
        is_to_and_fro(&jumps.map(jump).collect::<Vec<_>>())
    }

    #[test]
    fn jumps_between_two_levels_are_of_one_height() {
        assert!(is_two_levels(&[4.0; 12]));
        // A quarter of them is three times as high.
        let mut uneven = [3.0; 12];
        uneven[3..6].fill(9.0);
        assert!(!is_two_levels(&uneven));
        // Half of them less than half as high, with a sixth of the energy.
        let mut others = [4.0; 20];
        others[10..].fill(1.9);
        assert!(!is_two_levels(&others));
    }

    #[test]
    fn what_the_placing_of_a_jump_leaves_is_none() {
        let mut jumps: Vec<Jump> = (0..10)
            .map(|place| trial::jump(1000 * place, if place % 2 == 0 { 4.0 } else { -4.0 }))
            .collect();
        for place in [1, 5, 9] {
            jumps.insert(place, trial::jump(1000 * place + 3, 0.5));
        }
        assert!(is_to_and_fro(&jumps));
    }

    #[test]
    fn two_levels_have_four_jumps_of_five_of_about_one_height() {
        // A quarter of them of half the height, each above half of the upper quartile's.
        let mut others = [4.0; 20];
        others[..5].fill(2.02);
        assert!(!is_two_levels(&others));
        // Three of twenty are few.
        others[..2].fill(4.0);
        assert!(is_two_levels(&others));
    }

    #[test]
    fn markov_noise_far_less_likely_than_another_law_is_no_switching() {
        let trial = trial::Trial::new(trial::switching(7, 4.0).0);
        let starts = trial.axis.starts().expect("a spectrum");
        let search = |kind| search::search(trial.axis.fitted(), &starts, kind);
        let mut found: Vec<Found> = [markov::KIND; 2].into_iter().filter_map(search).collect();
        found[0].law.effect = crate::model::resonance::KIND;
        let is_among = |less: f64| {
            let worth = |one: &Found| {
                if one.law.effect == markov::KIND {
                    -less
                } else {
                    0.0
                }
            };
            trial.look(|look| among(look, &found, worth).is_some())
        };
        assert!(is_among(9.0), "seed 7");
        assert!(!is_among(11.0), "seed 7");
    }
}
