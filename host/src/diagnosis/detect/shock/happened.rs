//! What is proposed of the events of a record: shocks, each with its course, and motion.

use std::ops::Range;

use super::course::Course;
use super::moment::MOMENT;
use super::moved::Moved;
use super::scan::Scan;
use super::stretch::Stretch;
use crate::diagnosis::axis::SPREAD;
use crate::diagnosis::detect::burst::{Burst, MOST_STRETCHES, candidate};
use crate::diagnosis::detect::look::Look;
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::{Jump, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::motion::{Envelope, Level};
use crate::model::unnamed::Band;
use crate::model::{burst, motion, shock};

/// An event of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Happened {
    /// How far it stands out, as a normal number of as small a probability.
    pub z: f64,
    /// What it is.
    pub what: Known,
}

/// What an event is.
#[derive(Debug, Clone, PartialEq)]
pub enum Known {
    /// One transient.
    Shock(Course),
    /// Something that moved the sensor for a while.
    Motion(Moved),
    /// The noise itself was louder for a while.
    Louder(Burst),
}

impl Happened {
    /// Of a stretch.
    pub const fn new(stretch: &Stretch, what: Known) -> Self {
        Self { z: stretch.z, what }
    }

    /// Samples in which it is.
    pub const fn samples(&self) -> &Range<usize> {
        match &self.what {
            Known::Shock(course) => &course.samples,
            Known::Motion(moved) => &moved.samples,
            Known::Louder(burst) => &burst.range,
        }
    }

    /// Makes it last for these samples.
    pub fn last(&mut self, samples: Range<usize>) {
        match &mut self.what {
            Known::Shock(course) => {
                if course.shock.f_hz > 0.0 {
                    let lasts = samples.end as f64 - course.shock.time_s;
                    course.shock.duration_s = lasts.max(course.shock.duration_s);
                }
                course.samples = samples;
            }
            Known::Motion(moved) => moved.samples = samples,
            Known::Louder(burst) => burst.range = samples,
        }
    }

    /// Whether it is a shock no longer than some single samples that came together.
    pub fn is_short(&self) -> bool {
        let lasts = |course: &Course| {
            let own = course.shock.duration_s.ceil() as usize;
            own.min(course.samples.len())
        };
        matches!(&self.what, Known::Shock(course) if lasts(course) <= 2 * MOMENT)
    }

    /// Whether it goes to one side and comes back.
    pub fn is_bump(&self) -> bool {
        matches!(&self.what, Known::Shock(course) if course.shock.f_hz == 0.0)
    }
}

/// A candidate for the shocks among some events, one for the motion, and one for each stretch in which the noise is louder.
pub fn candidates(look: &Look<'_>, scan: &Scan<'_>, all: Vec<Happened>) -> Vec<Candidate> {
    let highest = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
    let (mut courses, mut moved): (Vec<Course>, Vec<Moved>) = Default::default();
    let (mut of_courses, mut of_moved): (Vec<f64>, Vec<f64>) = Default::default();
    let mut louder: Vec<Burst> = Vec::new();
    for Happened { z, what } in all {
        match what {
            Known::Shock(course) => {
                courses.push(course);
                of_courses.push(z);
            }
            Known::Motion(one) => {
                moved.push(one);
                of_moved.push(z);
            }
            Known::Louder(burst) => louder.push(burst),
        }
    }
    let shocks = (!courses.is_empty())
        .then(|| of_shocks(look, &courses, scan.p_value(highest(&of_courses))));
    let motion =
        (!moved.is_empty()).then(|| of_motion(look, &moved, scan.p_value(highest(&of_moved))));
    let bursts = of_louder(look, &louder);
    shocks.into_iter().chain(motion).chain(bursts).collect()
}

/// Those of some stretches in which the noise is louder, before any is fitted to them too.
fn of_louder(look: &Look<'_>, louder: &[Burst]) -> Vec<Candidate> {
    let axis = look.axis;
    let decides = |one: &&Burst| one.p_value < look.level();
    let found: Vec<&Burst> = louder.iter().filter(decides).collect();
    let known = axis
        .explanations()
        .iter()
        .filter(|one| one.kind() == burst::KIND);
    if known.count() + found.len() > MOST_STRETCHES {
        return Vec::new();
    }
    found.into_iter().map(|one| candidate(axis, one)).collect()
}

fn of_shocks(look: &Look<'_>, shocks: &[Course], p_value: f64) -> Candidate {
    let rate_hz = look.axis.rate_hz;
    let values = shocks
        .iter()
        .flat_map(|one| row(one, rate_hz, |f_hz| passed(look, f_hz)));
    let effect = Estimate {
        kind: shock::KIND,
        values: values.collect(),
    };
    let waves = vec![Wave::Shocks {
        shocks: shocks.iter().map(|one| one.in_seconds(rate_hz)).collect(),
        rate_hz,
    }];
    let masked = masked(look, shocks.iter().map(|one| one.samples.clone()));
    let freedom = effect.values.iter().flatten().count() as f64;
    Candidate {
        held_out_nats: Some(shocks.iter().map(|one| one.nats).sum()),
        ..Candidate::new(effect, p_value, freedom, Change::Happened { masked, waves })
    }
}

fn of_motion(look: &Look<'_>, all: &[Moved], p_value: f64) -> Candidate {
    let rows = all.iter().flat_map(|one| {
        let levels = std::iter::once([one.step, one.mean]).chain(std::iter::repeat([None; 2]));
        let bands = one.bands.iter().zip(levels);
        bands.flat_map(move |(band, levels)| motion_row(look, one, band, levels))
    });
    let effect = Estimate {
        kind: motion::KIND,
        values: rows.collect(),
    };
    let jump = |one: &Moved| {
        let [height, height_sd] = one.step?;
        let z = height.abs() / height_sd;
        Some(Jump {
            index: one.samples.start.midpoint(one.samples.end),
            height,
            height_sd,
            // Anywhere in it.
            index_sd: one.samples.len() as f64 / 12.0_f64.sqrt(),
            z,
            p_value,
        })
    };
    let jumps: Vec<Jump> = all.iter().filter_map(jump).collect();
    let level = |one: &Moved| Level {
        from: one.samples.start as u64,
        envelope: Envelope::new(one.samples.len() as u64, one.fade as u64),
        mean: one.mean.map_or(0.0, |[height, _]| height),
        step: one.step.map_or(0.0, |[height, _]| height),
    };
    let levels: Vec<Level> = all
        .iter()
        .filter(|one| one.mean.is_some() || one.step.is_some())
        .map(level)
        .collect();
    let steps = (!jumps.is_empty()).then_some(Wave::Steps(jumps));
    let levels = (!levels.is_empty()).then_some(Wave::Meanwhile(levels));
    let waves = steps.into_iter().chain(levels).collect();
    let masked = masked(look, all.iter().map(|one| with_fading(&one.samples)));
    let freedom = effect.values.iter().flatten().count() as f64;
    let change = Change::Happened { masked, waves };
    Candidate {
        held_out_nats: Some(all.iter().map(|one| one.nats).sum()),
        ..Candidate::new(effect, p_value, freedom, change)
    }
}

/// The parameters of one band of a stretch, ahead of the chain.
fn motion_row(
    look: &Look<'_>,
    one: &Moved,
    band: &Band,
    [step, mean]: [Option<[f64; 2]>; 2],
) -> [Option<Value>; motion::ROW] {
    let rate_hz = look.axis.rate_hz;
    let known = |[height, sd]: [f64; 2]| Value::normal(height, sd);
    let f_hz = band.f_hz * rate_hz;
    [
        Some(Value::told(one.samples.start as f64 / rate_hz)),
        Some(Value::told(one.samples.len() as f64 / rate_hz)),
        Some(step.map_or(Value::told(0.0), known)),
        Some(Value::told(f_hz)),
        Some(Value::told(band.width_hz * rate_hz)),
        Some(Value::told(band.amplitude / passed(look, f_hz))),
        mean.map(known),
        Some(Value::told(one.fade as f64 / rate_hz)),
    ]
}

/// The samples of some motion with those in which it comes up and fades: it goes on below the noise where it is seen no more.
fn with_fading(samples: &Range<usize>) -> Range<usize> {
    /// Part of what is seen for which it does, on either side: a choice.
    const FADES: usize = 32;
    let fades = samples.len() / FADES;
    samples.start.saturating_sub(fades)..samples.end + fades
}

/// What fits leave out for the samples of some events.
fn masked(look: &Look<'_>, samples: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
    let spread = if look.axis.is_filtered() { SPREAD } else { 0 };
    let last = look.axis.residual.len();
    samples
        .map(|one| one.start.saturating_sub(spread)..(one.end + spread).min(last))
        .collect()
}

/// Amplitude that the chain lets through.
fn passed(look: &Look<'_>, f_hz: f64) -> f64 {
    /// What is let through of a shock that is seen, at least: a choice.
    const LEAST: f64 = 0.1;
    look.axis.bins.chain_power(f_hz).sqrt().max(LEAST)
}

/// The parameters of one shock, ahead of the chain; `None` for what it has not.
fn row(course: &Course, rate_hz: f64, passed: impl Fn(f64) -> f64) -> [Option<Value>; 5] {
    let shock = course.in_seconds(rate_hz);
    let gain = if shock.f_hz > 0.0 {
        passed(shock.f_hz).recip()
    } else {
        1.0
    };
    let plain =
        |value: f64, sd: Option<f64>| sd.map_or(Value::told(value), |sd| Value::normal(value, sd));
    let relative = |value: f64, sd: Option<f64>| {
        sd.map_or(Value::told(value), |sd| Value::log_normal(value, sd))
    };
    let [time, peak, duration, frequency, decay] = course.sd;
    let is_there = |value: f64| value > 0.0;
    [
        Some(plain(shock.time_s, time.map(|sd| sd / rate_hz))),
        Some(plain(gain * shock.peak, peak.map(|sd| gain * sd))),
        Some(relative(shock.duration_s, duration)),
        Some(relative(shock.f_hz, frequency)).filter(|_| is_there(shock.f_hz)),
        Some(relative(shock.decay_s, decay)).filter(|_| is_there(shock.decay_s)),
    ]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Chain;
    use crate::diagnosis::axis::AxisState;
    use crate::diagnosis::detect::trial::{RATE_HZ, Trial, noise};

    #[test]
    fn motion_comes_up_and_fades_beside_what_is_seen_of_it() {
        assert_eq!(with_fading(&(3200..6400)), 3100..6500);
        assert_eq!(with_fading(&(10..3210)), 0..3310);
    }

    #[test]
    fn a_converters_filter_spreads_what_happened() {
        let mut trial = Trial::new(noise(1));
        let left_out = |trial: &Trial| trial.look(|look| masked(look, std::iter::once(1000..1100)));
        assert_eq!(left_out(&trial), [1000..1100]);
        let chain: Chain = "ads1281:linear".parse().expect("a chain");
        let axis = AxisState::new(Arc::new(noise(1)), RATE_HZ, Some(&chain));
        trial.axis = axis.expect("a spectrum");
        assert_eq!(left_out(&trial), [1000 - SPREAD..1100 + SPREAD]);
    }
}
