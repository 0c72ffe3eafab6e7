//! Lines: single ones (`sinusoid`), mains with its harmonics (`hum`), and those that wander.

mod mains;
mod measure;
#[cfg(test)]
mod tests;

use std::ops::Range;

use super::Detector;
use crate::diagnosis::axis::{AxisState, Excluded, NoFit};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::steady;
use crate::model::{hum, resonance, sinusoid};
use crate::spectrum::Line;
pub use mains::{Group, mains_base, wandering, with_hum};
pub use measure::{Measured, measure_near};

/// Looks for lines, all at once.
pub static DETECTOR: Detector = Detector { tests: 1, look };

/// Excludes the lines that wander, once no resonance can be what makes them. Their tests are those of
/// [`DETECTOR`].
pub static WANDERING: Detector = Detector {
    tests: 0,
    look: look_for_wandering,
};

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let groups = lines(look.axis, look.level());
    Ok(proposals(look, groups, |one| wanders(look, one)))
}

/// The lines of the residual at a family-wise `level`, grouped.
pub fn lines(axis: &AxisState, level: f64) -> Vec<Group> {
    let found = axis.lines(level);
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
        if count >= 3 {
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

/// A resonance too narrow for the record to resolve: a line.
pub fn unresolved(look: &Look<'_>, f_hz: f64, p_value: f64) -> Option<Proposal> {
    let one = measure_near(look.axis, f_hz, p_value);
    single(look, &mut taken_out_hz(look.axis), one)
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
fn taken_out_hz(axis: &AxisState) -> Vec<f64> {
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
    let reach_hz = |known_hz: f64| (40.0 / look.duration_s()).max(0.004 * known_hz);
    if known_hz
        .iter()
        .any(|&known_hz| (known_hz - f_hz).abs() < reach_hz(known_hz))
    {
        return None;
    }
    known_hz.push(f_hz);
    let frequency = Value::normal(f_hz, one.line.frequency_sd_hz);
    let effect = Estimate::new(sinusoid::KIND, [frequency, ahead_of_chain(axis, &one)]);
    let p_value = one.line.false_alarm;
    Some(Proposal::Explain(Box::new(Candidate::new(
        effect,
        p_value,
        3.0,
        Change::Waves(vec![one.wave]),
    ))))
}

/// Mains: added to what is there of it, harmonics that are known already staying as they are.
fn hum(look: &Look<'_>, base: Value, lines: Vec<(u32, Measured)>) -> Proposal {
    let p_values = lines.iter().map(|(_, one)| one.line.false_alarm);
    let p_value = p_values.fold(1.0, f64::min);
    let mut freedom = 1.0 + 2.0 * lines.len() as f64;
    let (mut values, mut waves) = (vec![Some(base)], Vec::new());
    let amends = look.place_of(hum::KIND);
    if let Some(place) = amends {
        let old = &look.axis.explanations()[place];
        values.clone_from(&old.effect.values);
        waves.extend_from_slice(old.waves());
        freedom += old.freedom;
    }
    for (number, one) in lines {
        let number = number as usize;
        values.resize(values.len().max(number + 1), None);
        values[number].get_or_insert(ahead_of_chain(look.axis, &one));
        waves.push(one.wave);
    }
    let effect = Estimate {
        kind: hum::KIND,
        values,
    };
    Proposal::Explain(Box::new(Candidate {
        amends,
        ..Candidate::new(effect, p_value, freedom, Change::Waves(waves))
    }))
}

/// Amplitude of a line as it was ahead of the declared chain, like that of all other effects.
fn ahead_of_chain(axis: &AxisState, one: &Measured) -> Value {
    let passed = axis.bins.chain_power(one.line.frequency_hz).sqrt();
    Value::normal(one.line.amplitude / passed, one.amplitude_sd / passed)
}

/// Whether a line does not keep its size and phase.
fn wanders(look: &Look<'_>, one: &Measured) -> bool {
    let cycles = one.line.frequency_hz / look.axis.rate_hz;
    steady::line::p_steady(look.axis, cycles) < look.level()
}

fn look_for_wandering(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let mut known = look.axis.excluded_hz();
    known.extend(resonances_hz(look.axis));
    let mut proposals = Vec::new();
    for group in lines(look.axis, look.level()) {
        let Group::Single(one) = group else { continue };
        let f_hz = one.line.frequency_hz;
        if wanders(look, &one) && !known.iter().any(|band| band.contains(&f_hz)) {
            let excluded = excluded(look, &one);
            known.push(excluded.band_hz.clone());
            proposals.push(Proposal::ExcludeLine(excluded));
        }
    }
    Ok(proposals)
}

fn excluded(look: &Look<'_>, one: &Measured) -> Excluded {
    /// Width of what is excluded, 1/T on either side: a choice.
    const WANDER_REACH: f64 = 40.0;
    let f_hz = one.line.frequency_hz;
    let width_hz = WANDER_REACH * look.axis.rate_hz / look.axis.filled.len() as f64;
    Excluded {
        band_hz: f_hz - width_hz..f_hz + width_hz,
        remark: Remark {
            test: "lines".into(),
            place: Place::Line(f_hz),
            p_value: one.line.false_alarm,
            description: format!(
                "a line of amplitude {:.3e} that does not keep its size and phase: {}",
                one.line.amplitude,
                wandering(f_hz)
            ),
        },
    }
}
