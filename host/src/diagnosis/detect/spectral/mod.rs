//! Laws that change the shape of the spectrum: every effect of the catalogue that a search by shape can begin
//! with ([`Effect::starts`](crate::model::effect::Effect::starts)), and telegraph noise among them.

pub mod exchange;
mod switching;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use super::{Detector, coarse_grid, lines, telegraph};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::look::{Lesson, Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::laws::search::{self, Found};
use crate::diagnosis::laws::{Law, squared_power};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Rival;
use crate::model::catalogue::CATALOGUE;
use crate::model::kind::Kind;
use crate::model::{averaging, hum, markov, resonance, sinusoid};

/// Share of the level that is left where the strength of the noise moves: bins scatter by more than
/// their degrees of freedom say. A thousandth is a choice.
const WHERE_STRENGTH_MOVES: f64 = 1e-3;

/// Width over 1/T of a resonance that a record can distinguish from a line.
const RESOLVED: f64 = 1.0;

/// Laws at most: with more, the record is of another kind, and no name is worth much. Four are a
/// choice.
const MOST_LAWS: usize = 4;

pub use switching::anywhere as switching_anywhere;

/// Looks for the law that is worth most; one test for each shape that the catalogue has.
pub static DETECTOR: Detector = Detector {
    tests: 6,
    look: strongest_law,
};

/// The same ahead of all others, where the level was seen to switch and its law is not there yet. The tests are
/// those of [`DETECTOR`].
pub static OF_SWITCHING: Detector = Detector {
    tests: 0,
    look: |look| {
        if look.character.level_switches && look.axis.laws.is_empty() {
            strongest_law(look)
        } else {
            Ok(Vec::new())
        }
    },
};

/// What is to be done about the law that is worth most.
///
/// # Errors
/// [`NoFit`] where the axis has no bins.
pub fn strongest_law(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    if look.axis.laws.len() == MOST_LAWS {
        return Ok(Vec::new());
    }
    let mut found = significant(look)?;
    // A resonance too narrow for the record to resolve is a line, or nothing.
    if let Some(narrow) = found.first().filter(|one| is_line(look, one)) {
        let line = lines::unresolved(look, narrow.law.values[0], narrow.p_value);
        if let Some(line) = line {
            return Ok(vec![line]);
        }
        found.remove(0);
    }
    let Some(first) = found.first() else {
        return Ok(Vec::new());
    };
    if first.law.effect == resonance::KIND {
        let (f_hz, worth) = (first.law.values[0], worth(look.axis.rate_hz, first));
        if let Some(line) = lines::in_place_of(look, f_hz, first.p_value, worth)? {
            return Ok(vec![line]);
        }
    }
    // Jumps seen one by one may be a part of it.
    if found[0].law.effect == markov::KIND
        && let Some(proposals) = switching::in_place_of_jumps(look)?
    {
        return Ok(proposals);
    }
    Ok(named(look, found))
}

/// Laws that are significant, the one that is worth most first.
fn significant(look: &Look<'_>) -> Result<Vec<Found>, NoFit> {
    let moving = look.character.strength_moves || look.axis.has_envelope();
    let level = look.level() * if moving { WHERE_STRENGTH_MOVES } else { 1.0 };
    let axis = look.axis;
    let starts = axis.starts().ok_or(NoFit)?;
    let kinds = CATALOGUE.par_iter().filter(|kind| look.is_open(**kind));
    let found = kinds.filter_map(|&kind| search::search(axis.fitted(), &starts, kind));
    let mut found: Vec<Found> = found.collect();
    // Only what is significant competes: a search over more shapes gains more by chance, and what is seldom built has less of
    // the level.
    let level_of = |law: &Law| {
        let surprise = law.effect.surprise_nats(&law.values, axis.rate_hz);
        level * (-surprise).exp()
    };
    found.retain(|one| one.p_value < level_of(&one.law) && is_beyond_rounding(axis, one));
    let worth = |one: &Found| worth(axis.rate_hz, one);
    found.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    Ok(found)
}

/// Whether a law is none that rounding alone may have: a filter, or noise that is louder.
fn is_beyond_rounding(axis: &AxisState, one: &Found) -> bool {
    let least_variance = coarse_grid::least_variance(axis);
    if least_variance == 0.0 || !one.law.adds() {
        return true;
    }
    // A power law has a density, and is as loud as the band is wide.
    let is_variance = squared_power(&one.law) > 1.0;
    let variance = one.fit.squared.last().filter(|_| is_variance);
    variance.is_some_and(|variance| *variance > least_variance)
}

/// Gain in log-likelihood at this rate; what a law costs has to be paid for.
fn worth(rate_hz: f64, one: &Found) -> f64 {
    one.nats - cost(rate_hz, &one.law)
}

/// Nats that a law costs: one for each parameter, and what makes its values unlikely.
fn cost(rate_hz: f64, law: &Law) -> f64 {
    law.freedom() + law.effect.surprise_nats(&law.values, rate_hz)
}

/// The law by its likeliest name, with the others as rivals.
fn named(look: &Look<'_>, mut found: Vec<Found>) -> Vec<Proposal> {
    let worth = |one: &Found| worth(look.axis.rate_hz, one);
    let mut names: Vec<(Kind, f64)> = found
        .iter()
        .map(|one| (one.law.effect, worth(one)))
        .collect();
    let (mut kind, mut most) = names[0];
    let mut place = 0;
    let mut proposals = Vec::new();
    if let Some((markov, odds)) = telegraph::among(look, &found, worth) {
        let switching = names[markov].1 + odds;
        names.push((crate::model::telegraph::KIND, switching));
        if switching > most {
            (kind, most, place) = (crate::model::telegraph::KIND, switching, markov);
            proposals.push(Proposal::Learn(Lesson::LevelSwitches));
        }
    }
    names.retain(|(name, _)| *name != kind);
    names.sort_by(|a, b| b.1.total_cmp(&a.1));
    let rivals = names.into_iter().map(|(name, worth)| Rival {
        effect: name,
        log_odds: most - worth,
    });
    let Found { law, p_value, .. } = found.remove(place);
    let freedom = law.freedom();
    let mut candidate = Candidate {
        rivals: rivals.collect(),
        ..Candidate::new(Estimate::of_law(kind), p_value, freedom, Change::Law(law))
    };
    if kind == crate::model::telegraph::KIND {
        telegraph::supersede(&mut candidate);
    }
    if kind == averaging::KIND {
        // The tops of its lobes pass for lines until it is there.
        candidate.reopens = vec![sinusoid::KIND, hum::KIND];
    }
    proposals.push(Proposal::Explain(Box::new(candidate)));
    proposals
}

/// Whether a law is a resonance narrower than the record resolves, or one whose power stands at a
/// single frequency: bins see no more than a width of their own.
fn is_line(look: &Look<'_>, one: &Found) -> bool {
    /// Width over frequency below which bins do not resolve it: two of them, at 16 an octave, span a
    /// tenth.
    const SEEN_BY_BINS: f64 = 0.1;
    /// Share of the power that a line there holds: most of it.
    const SHARE: f64 = 0.5;
    let axis = look.axis;
    let [f_hz, width_hz, ..] = one.law.values[..] else {
        return false;
    };
    if one.law.effect != resonance::KIND || width_hz > SEEN_BY_BINS * f_hz {
        return false;
    }
    let line = lines::measure_near(axis, f_hz, one.p_value).line;
    width_hz * look.duration_s() < RESOLVED
        || one
            .fit
            .squared
            .last()
            .is_some_and(|power| 0.5 * line.amplitude.powi(2) > SHARE * power)
}

/// Between which frequencies law number `which` makes at least `share` of the density; for a
/// filter, where it takes away as much.
pub fn band_of(axis: &AxisState, which: usize, share: f64) -> std::ops::Range<f64> {
    use crate::model::effect::Part;
    let law = &axis.laws[which];
    let part = law.effect.part(&law.values);
    let decides = |f_hz: f64| match &part {
        Part::Term(_) => axis.law_density(which, f_hz) >= share * axis.density(f_hz),
        Part::Distortion(filter) => filter.power(f_hz, axis.rate_hz) <= 1.0 - share,
        Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => false,
    };
    let bins = axis.bins.all().iter().map(|bin| bin.f_hz);
    let inside: Vec<f64> = bins.filter(|&f_hz| decides(f_hz)).collect();
    match (inside.first(), inside.last()) {
        (Some(&from_hz), Some(&to_hz)) => from_hz..to_hz,
        _ => 0.0..0.0,
    }
}
