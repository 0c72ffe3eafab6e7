//! Lines: single ones (`sinusoid`), mains with its harmonics (`hum`), and those that wander.

pub mod amplitudes;
mod cycles;
mod mains;
mod measure;
mod slow;
mod spread;
#[cfg(test)]
mod tests;
mod unresolved;
mod unsteady;

use std::ops::Range;

use super::Detector;
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change, Explanation};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::steady;
use crate::model::kind::Kind;
use crate::model::outliers::{self, Outliers};
use crate::model::{hum, resonance, sinusoid};
use crate::spectrum::Line;
pub use mains::{Group, mains_base, wandering, with_hum};
pub use measure::{Measured, UNDECLARED, amplitude_sd, measure_near};
pub use spread::in_noise_left;
pub use unresolved::{in_place_of, unresolved};
pub use unsteady::WANDERING;

/// Looks for lines, all at once.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let (mut groups, found) = cycles::cycles(look);
    groups.extend(grouped(look.axis, &found));
    let mut known = look.axis.excluded_hz();
    known.extend(look.axis.tones_with_skirts_hz());
    let is_known = |f_hz: f64| known.iter().any(|band| band.contains(&f_hz));
    groups.retain_mut(|group| match group {
        Group::Single(one) => !is_known(one.line.frequency_hz),
        Group::Hum { lines, .. } => {
            lines.retain(|(_, one)| !is_known(one.line.frequency_hz));
            !lines.is_empty()
        }
        Group::Cluster { .. } => true,
    });
    Ok(proposals(look, groups, |one| wanders(look, one)))
}

/// The lines of the residual at a family-wise `level`, grouped.
pub fn lines(axis: &AxisState, level: f64) -> Vec<Group> {
    grouped(axis, &found(axis, level))
}

fn found(axis: &AxisState, level: f64) -> Vec<Line> {
    let found = axis.lines(level).iter();
    let found = found.filter(|line| measure::stands_out(axis, line, level));
    found.copied().collect()
}

/// Lines by what they may have in common.
fn grouped(axis: &AxisState, found: &[Line]) -> Vec<Group> {
    let duration_s = axis.filled.len() as f64 / axis.rate_hz;
    let mut groups = Vec::new();
    let mut singles = Vec::new();
    // Neighbours closer than some tens of 1/T belong together.
    let mut rest = found;
    while let Some((first, _)) = rest.split_first() {
        let near = |a: &Line, b: &Line| {
            b.frequency_hz - a.frequency_hz < (40.0 / duration_s).max(0.004 * a.frequency_hz)
        };
        let count = 1 + rest
            .windows(2)
            .take_while(|pair| near(&pair[0], &pair[1]))
            .count();
        let (cluster, others) = rest.split_at(count);
        rest = others;
        let top = (count >= 3).then(|| strongest(axis, cluster));
        if let Some(top) = top.filter(|top| measure::holds(axis, top, cluster)) {
            singles.push(top);
        } else if count >= 3 {
            groups.push(Group::Cluster {
                f_hz: 0.5 * (first.frequency_hz + cluster[count - 1].frequency_hz),
                width_hz: cluster[count - 1].frequency_hz - first.frequency_hz,
                lines: cluster.to_vec(),
            });
        } else {
            singles.extend(cluster.iter().map(|line| measure::measure(axis, line)));
        }
    }
    groups.extend(with_hum(singles));
    groups
}

/// What is to be done about the lines of some groups, but for single ones that are to be left.
pub fn proposals(
    look: &Look<'_>,
    groups: Vec<Group>,
    is_left: impl Fn(&Measured) -> bool,
) -> Vec<Proposal> {
    let mut known_hz = taken_out_hz(look.axis);
    let mut proposals = Vec::new();
    for group in groups {
        match group {
            Group::Single(one) if is_left(&one) => {}
            Group::Single(one) => proposals.extend(single(look, &mut known_hz, one)),
            Group::Hum {
                base_hz,
                base_sd_hz,
                lines,
            } => {
                let base = Value::normal(base_hz, base_sd_hz);
                proposals.push(hum(look, base, lines));
            }
            Group::Cluster { .. } => {}
        }
    }
    proposals
}

/// The strongest of some lines that stand close, measured where it is largest.
fn strongest(axis: &AxisState, lines: &[Line]) -> Measured {
    let largest = lines.iter().max_by(|a, b| a.ratio.total_cmp(&b.ratio));
    let (f_hz, false_alarm) = largest.map_or((0.0, 1.0), |one| (one.frequency_hz, one.false_alarm));
    measure_near(axis, f_hz, false_alarm)
}

/// Bands about the resonances that are there: lines in them are their tops.
pub fn resonances_hz(axis: &AxisState) -> Vec<Range<f64>> {
    /// Widths on either side: there a resonance has a hundredth of its peak's power.
    const RESONANCE_REACH: f64 = 5.0;
    let laws = axis.laws.iter();
    laws.filter(|law| law.effect == resonance::KIND)
        .map(|law| {
            let (f_hz, reach_hz) = (law.values[0], RESONANCE_REACH * law.values[1]);
            f_hz - reach_hz..f_hz + reach_hz
        })
        .collect()
}

/// Frequencies of the lines that are taken out of an axis, hertz.
pub fn taken_out_hz(axis: &AxisState) -> Vec<f64> {
    let frequency_hz = |wave: &Wave| match wave {
        Wave::Line { cycles, .. } => Some(cycles * axis.rate_hz),
        _ => None,
    };
    let waves = axis.residual.waves().iter();
    waves.filter_map(frequency_hz).collect()
}

/// A line by itself, unless it is the top of a resonance or what is left next to one of `known_hz`, to which it
/// is added.
fn single(look: &Look<'_>, known_hz: &mut Vec<f64>, one: Measured) -> Option<Proposal> {
    let f_hz = one.line.frequency_hz;
    let axis = look.axis;
    if resonances_hz(axis).iter().any(|band| band.contains(&f_hz)) || !look.is_open(sinusoid::KIND)
    {
        return None;
    }
    // What is left next to a line that was taken out is no second one.
    if known_hz
        .iter()
        .any(|&known_hz| measure::is_beside(axis, known_hz, f_hz))
    {
        return None;
    }
    known_hz.push(f_hz);
    let frequency = Value::normal(f_hz, one.line.frequency_sd_hz);
    let effect = Estimate::new(sinusoid::KIND, [frequency, ahead_of_chain(axis, &one)]);
    let p_value = one.line.false_alarm;
    Some(Proposal::Explain(Box::new(Candidate {
        reopens: may_be_of(axis, one.line.amplitude),
        ..Candidate::new(effect, p_value, 3.0, Change::Waves(vec![one.wave]))
    })))
}

/// Mains: added to what is there of it, harmonics that are known already staying as they are.
fn hum(look: &Look<'_>, base: Value, lines: Vec<(u32, Measured)>) -> Proposal {
    let p_values = lines.iter().map(|(_, one)| one.line.false_alarm);
    let p_value = p_values.fold(1.0, f64::min);
    let mut freedom = 1.0 + 2.0 * lines.len() as f64;
    let (mut values, mut waves) = (vec![Some(base), None, None], Vec::new());
    let mut largest = 0.0;
    // One of them may be known: of a family that they belong to, or by itself, as the base of others now.
    let holds = |one: &Explanation, wave: &Wave| one.waves().contains(wave);
    let mut all = look.axis.explanations().iter();
    let known = all.position(|known| lines.iter().any(|(_, one)| holds(known, &one.wave)));
    let family = known.filter(|&place| look.axis.explanations()[place].kind() == hum::KIND);
    let was_single = known.is_some() && family.is_none();
    let amends = if was_single {
        None
    } else {
        family.or_else(|| of_base(look, base.value))
    };
    if let Some(place) = amends {
        let old = &look.axis.explanations()[place];
        values.clone_from(&old.effect.values);
        waves.extend_from_slice(old.waves());
        freedom += old.freedom;
    }
    for (number, one) in lines {
        if waves.contains(&one.wave) {
            continue;
        }
        largest = f64::max(largest, one.line.amplitude);
        let number = number as usize;
        let place = hum::FIRST_AMPLITUDE + number - 1;
        values.resize(values.len().max(place + 1), None);
        values[place].get_or_insert(ahead_of_chain(look.axis, &one));
        waves.push(one.wave);
    }
    let effect = Estimate {
        kind: hum::KIND,
        values,
    };
    Proposal::Explain(Box::new(Candidate {
        amends,
        supersedes: was_single.then_some(sinusoid::KIND).into_iter().collect(),
        reopens: may_be_of(look.axis, largest),
        ..Candidate::new(effect, p_value, freedom, Change::Waves(waves))
    }))
}

/// What may have been found for a tone of an `amplitude`: single samples that are no larger, beside a gap above all.
fn may_be_of(axis: &AxisState, amplitude: f64) -> Vec<Kind> {
    let single = axis.explanation(outliers::KIND);
    let is_smaller = |one: &Explanation| Outliers::of(&one.effect.plain()).size < amplitude;
    let single = single.filter(|one| is_smaller(one));
    single.map(Explanation::kind).into_iter().collect()
}

/// Number of the explanation that holds the lines of a base already.
fn of_base(look: &Look<'_>, base_hz: f64) -> Option<usize> {
    /// How near two bases are one, as a share: that of the mains about their nominal frequency.
    const SAME: f64 = 0.005;
    let is_it = |one: &Explanation| {
        let known_hz = one.effect.values.first().copied().flatten();
        let is_near = |known_hz: f64| (known_hz / base_hz - 1.0).abs() < SAME;
        one.kind() == hum::KIND
            && !one.waves().is_empty()
            && known_hz.is_some_and(|one| is_near(one.value))
    };
    look.axis.explanations().iter().position(is_it)
}

/// Amplitude of a line as it was ahead of the declared chain, like that of all other effects.
fn ahead_of_chain(axis: &AxisState, one: &Measured) -> Value {
    let passed = axis.bins.chain_power(one.line.frequency_hz).sqrt();
    Value::normal(one.line.amplitude / passed, one.amplitude_sd / passed)
}

/// Whether a line does not keep its size and phase.
pub fn wanders(look: &Look<'_>, one: &Measured) -> bool {
    let cycles = one.line.frequency_hz / look.axis.rate_hz;
    steady::line::p_steady(look.axis, cycles) < look.level()
}
