//! The loop: look, name, extend, fit again, look again, until nothing significant is left.
//!
//! Within a round the views are taken from the most local to the most general: single values, lines,
//! level, variance, shape of the spectrum. The first that finds something extends the model, and
//! the next round begins with everything fitted anew, so that what one effect hid from another
//! shows. What was found earlier and is no longer needed is dropped at the end.

use std::collections::BTreeMap;

use super::axis::AxisState;
use super::bursts::{self, Burst};
use super::codes;
use super::finding::{Remark, Rival, Value};
use super::impulses;
use super::laws::{self, Law};
use super::levels::{self, Jump};
use super::lines::{self, Group, Measured};
use super::mend::{Wave, block_means};
use super::slow;
use super::telegraph;
use super::whole::{Transformer, held_out_gain};
use crate::fit::likelihood::Fit;
use crate::fit::likelihood::components::SEEN;
use crate::model::catalogue::{self, CATALOGUE};
use crate::model::effect::Part;

/// Tests that share the family's level evenly.
const TESTS: f64 = 14.0;

/// Rounds, at most: far more than effects that one record can tell apart.
const ROUNDS: usize = 24;

/// Jumps from which up and down by turns is a switch rather than steps.
const SWITCHING: usize = 6;

/// What the diagnosis is told.
#[derive(Debug, Clone)]
pub struct Options {
    /// Probability at most of any finding or remark where nothing is hidden.
    pub family_level: f64,
    /// A covariate, such as the temperature, one value a sample.
    pub covariate: Option<Vec<f64>>,
}

impl Options {
    /// Level of one test.
    pub fn level(&self) -> f64 {
        self.family_level / TESTS
    }
}

/// An effect that was accepted.
#[derive(Debug, Clone)]
pub struct Accepted {
    /// Its name.
    pub effect: &'static str,
    /// Its parameters.
    pub parameters: BTreeMap<String, Value>,
    /// Probability of as much without it.
    pub p_value: f64,
    /// Other names.
    pub rivals: Vec<Rival>,
    /// Numbers that were fitted to all of the record for it.
    pub freedom: f64,
    /// Fit without it.
    pub before: Fit,
    /// Gain in log-likelihood on held-out data, where it was measured as the effect was found.
    pub nats: Option<f64>,
    /// What the record and the model were with it.
    pub with: Snapshot,
    /// And without.
    pub without: Snapshot,
}

/// State of record and model at some moment.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// What is taken out.
    pub waves: Vec<Wave>,
    /// Laws beside the five terms, by their place in the catalogue.
    pub laws: Vec<(&'static str, Vec<f64>)>,
}

impl Snapshot {
    fn of(axis: &AxisState) -> Self {
        Self {
            waves: axis.mended.waves.clone(),
            laws: axis
                .laws
                .iter()
                .map(|law| (law.effect.name(), law.values.clone()))
                .collect(),
        }
    }
}

/// The outcome for one axis.
pub struct Outcome {
    /// Effects, in the order in which they were found.
    pub accepted: Vec<Accepted>,
    /// What is left.
    pub unexplained: Vec<Remark>,
    /// What the five terms alone get wrong.
    pub discrepancies: Vec<Remark>,
}

/// Runs the loop on an axis; `grid` is the step that all of its values are multiples of, if it is
/// coarser than declared.
pub fn run(axis: &mut AxisState, options: &Options, values: &CodeFindings) -> Option<Outcome> {
    let mut rounds = Rounds {
        axis,
        options,
        accepted: Vec::new(),
        discrepancies: Vec::new(),
        switching: false,
    };
    rounds.note_base();
    rounds.take_codes(values)?;
    for _ in 0..ROUNDS {
        if !(rounds.outliers()?
            || rounds.lines()?
            || rounds.levels()?
            || rounds.bursts()?
            || rounds.laws()?)
        {
            break;
        }
    }
    let unexplained = rounds.left_over();
    Some(Outcome {
        accepted: rounds.accepted,
        unexplained,
        discrepancies: rounds.discrepancies,
    })
}

/// What the values themselves say.
#[derive(Debug, Clone, Default)]
pub struct CodeFindings {
    /// Repeats, and where they are.
    pub stale: Option<(codes::Stale, Vec<usize>)>,
    /// Pile-ups.
    pub clipping: Vec<codes::Clipping>,
    /// Step of the values that is coarser than declared, beside the short-term noise.
    pub coarse: Option<f64>,
}

struct Rounds<'a> {
    axis: &'a mut AxisState,
    options: &'a Options,
    accepted: Vec<Accepted>,
    discrepancies: Vec<Remark>,
    /// Whether the level switches to and fro: no business of single steps.
    switching: bool,
}

impl Rounds<'_> {
    fn level(&self) -> f64 {
        self.options.level()
    }

    /// Accepts an effect after `change` has been made to the record or the laws.
    fn accept(
        &mut self,
        effect: &'static str,
        parameters: BTreeMap<String, Value>,
        p_value: f64,
        freedom: f64,
        nats: Option<f64>,
        change: impl FnOnce(&mut AxisState) -> Option<()>,
    ) -> Option<()> {
        let (before, without) = (self.axis.fit.clone(), Snapshot::of(self.axis));
        change(self.axis)?;
        self.accepted.push(Accepted {
            effect,
            parameters,
            p_value,
            rivals: Vec::new(),
            freedom,
            before,
            nats,
            with: Snapshot::of(self.axis),
            without,
        });
        Some(())
    }

    fn find(&mut self, effect: &str) -> Option<&mut Accepted> {
        self.accepted.iter_mut().find(|one| one.effect == effect)
    }

    fn note_base(&mut self) {
        let level = self.level();
        let departure = laws::departure(&self.axis.data, &self.axis.fit.expected);
        if let Some(departure) = departure.filter(|one| one.p_value < level) {
            self.discrepancies.push(spectrum_remark(&departure));
        }
    }

    fn take_codes(&mut self, values: &CodeFindings) -> Option<()> {
        if let Some((stale, places)) = &values.stale {
            let share = Value::normal(stale.share, stale.share_sd);
            let (whole, density) = self.axis.whole();
            let replaced = impulses::sizes_at(&whole, &density, places);
            let parameters = named([("share", share)]);
            self.accept("stale", parameters, stale.p_value, 1.0, None, |axis| {
                axis.mended.waves.push(Wave::Replaced(replaced));
                axis.refresh(false)
            })?;
        }
        for clipping in &values.clipping {
            let parameters = [
                ("level", Value::exact(clipping.level)),
                ("side", Value::exact(clipping.side)),
            ];
            self.plain("clipping", parameters, clipping.p_value);
        }
        if let Some(step) = values.coarse {
            self.plain("quantisation", [("step", Value::exact(step))], 0.0);
        }
        Some(())
    }

    /// An effect that changes neither record nor law.
    fn plain<const N: usize>(
        &mut self,
        effect: &'static str,
        parameters: [(&str, Value); N],
        p_value: f64,
    ) {
        let parameters = named(parameters);
        let _ = self.accept(effect, parameters, p_value, N as f64, None, |_| Some(()));
    }

    fn outliers(&mut self) -> Option<bool> {
        let (whole, density) = self.axis.whole();
        let axis = &*self.axis;
        let found = impulses::outliers(&whole, &density, self.level(), |n| axis.usable(n));
        if found.found.is_empty() || self.crowded(&found.found, whole.len()) {
            return Some(false);
        }
        let mut all = found.found;
        let before = self
            .axis
            .mended
            .waves
            .iter()
            .position(|wave| matches!(wave, Wave::Outliers(_)));
        let old = before.map(|place| self.axis.mended.waves.remove(place));
        if let Some(Wave::Outliers(old)) = old {
            for one in old {
                match all.iter_mut().find(|new| new.index == one.index) {
                    Some(new) => new.size += one.size,
                    None => all.push(one),
                }
            }
            all.sort_by_key(|one| one.index);
        }
        let count = all.len() as f64;
        let duration_s = self.axis.filled.len() as f64 / self.axis.rate_hz;
        let mean_square = all.iter().map(|one| one.size * one.size).sum::<f64>() / count;
        let fourth = all.iter().map(|one| one.size.powi(4)).sum::<f64>() / count;
        let size_log_sd =
            (0.25 * (fourth / mean_square.powi(2) - 1.0).max(2.0 / count) / count).sqrt();
        let parameters = named([
            (
                "rate_hz",
                Value::log_normal(count / duration_s, count.sqrt().recip()),
            ),
            ("size", Value::log_normal(mean_square.sqrt(), size_log_sd)),
        ]);
        let nats = found.nats;
        let change = |axis: &mut AxisState| {
            axis.mended.waves.push(Wave::Outliers(all));
            axis.refresh(false)
        };
        if self.find("outliers").is_some() {
            change(self.axis)?;
            let with = Snapshot::of(self.axis);
            let one = self.find("outliers")?;
            (one.parameters, one.with, one.freedom) = (parameters, with, 2.0 * count);
            one.nats = one.nats.map(|before| before + nats);
        } else {
            let p_value = found.p_value;
            self.accept(
                "outliers",
                parameters,
                p_value,
                2.0 * count,
                Some(nats),
                change,
            )?;
        }
        Some(true)
    }

    /// Whether outliers stand in one place rather than all over the record: a burst's own samples.
    fn crowded(&self, found: &[impulses::Outlier], length: usize) -> bool {
        if found.len() < 6 {
            return false;
        }
        // Kolmogorov's distance of their moments from evenly spread ones.
        let count = found.len() as f64;
        let distance = (0..)
            .zip(found)
            .map(|(k, one): (u32, _)| {
                let place = one.index as f64 / length as f64;
                let k = f64::from(k);
                ((k + 1.0) / count - place)
                    .abs()
                    .max((place - k / count).abs())
            })
            .fold(0.0, f64::max);
        2.0 * (-2.0 * count * distance * distance).exp() < 1e-6
    }

    fn lines(&mut self) -> Option<bool> {
        let groups = lines::lines(self.axis, self.level());
        let mut any = false;
        for group in groups {
            match group {
                Group::Single(one) => any |= self.single(one)?,
                Group::Hum {
                    base_hz,
                    base_sd_hz,
                    lines,
                } => any |= self.hum(base_hz, base_sd_hz, lines)?,
                Group::Cluster { .. } => {}
            }
        }
        Some(any)
    }

    fn single(&mut self, one: Measured) -> Option<bool> {
        // What is left beside a line that was taken out is no second one.
        let duration_s = self.axis.filled.len() as f64 / self.axis.rate_hz;
        let near = self.axis.mended.waves.iter().any(|wave| match wave {
            Wave::Line { cycles, .. } => {
                let f_hz = cycles * self.axis.rate_hz;
                (f_hz - one.line.frequency_hz).abs() < (40.0 / duration_s).max(0.004 * f_hz)
            }
            _ => false,
        });
        if near {
            return Some(false);
        }
        let parameters = named([
            (
                "f_hz",
                Value::normal(one.line.frequency_hz, one.line.frequency_sd_hz),
            ),
            (
                "amplitude",
                Value::normal(one.line.amplitude, one.amplitude_sd),
            ),
        ]);
        let p_value = one.line.false_alarm;
        self.accept("sinusoid", parameters, p_value, 3.0, None, |axis| {
            axis.mended.waves.push(one.wave);
            axis.refresh(false)
        })?;
        Some(true)
    }

    fn hum(&mut self, base_hz: f64, base_sd_hz: f64, lines: Vec<(u32, Measured)>) -> Option<bool> {
        let p_value = lines
            .iter()
            .map(|(_, one)| one.line.false_alarm)
            .fold(1.0, f64::min);
        let mut parameters = named([("f_hz", Value::normal(base_hz, base_sd_hz))]);
        for (number, one) in &lines {
            parameters.insert(
                format!("amplitude_{number}"),
                Value::normal(one.line.amplitude, one.amplitude_sd),
            );
        }
        let freedom = 1.0 + 2.0 * lines.len() as f64;
        let change = |axis: &mut AxisState| {
            axis.mended
                .waves
                .extend(lines.into_iter().map(|(_, one)| one.wave));
            axis.refresh(false)
        };
        if self.find("hum").is_some() {
            change(self.axis)?;
            let with = Snapshot::of(self.axis);
            let one = self.find("hum")?;
            for (name, value) in parameters {
                one.parameters.entry(name).or_insert(value);
            }
            one.with = with;
            one.freedom += freedom;
        } else {
            self.accept("hum", parameters, p_value, freedom, None, change)?;
        }
        Some(true)
    }

    fn levels(&mut self) -> Option<bool> {
        let level = self.level();
        let has =
            |wanted: &str, accepted: &[Accepted]| accepted.iter().any(|one| one.effect == wanted);
        let thermal = match &self.options.covariate {
            Some(column) if !has("thermal", &self.accepted) => {
                slow::follows(self.axis, column, level)
            }
            _ => None,
        };
        let warm_up = if has("warmup", &self.accepted) {
            None
        } else {
            slow::warm_up(self.axis, level)
        };
        let jump = if self.switching {
            None
        } else {
            self.largest_jump()
        };
        let size = |z: Option<f64>| z.map_or(0.0, f64::abs);
        let (t, w, j) = (
            size(thermal.as_ref().map(|(change, _)| change.z)),
            size(warm_up.as_ref().map(|change| change.z)),
            size(jump.map(|jump| jump.z)),
        );
        if let Some((change, lag_s)) = thermal.filter(|_| t >= w && t >= j) {
            let Wave::Follows { gain, .. } = change.wave else {
                return Some(false);
            };
            let parameters = named([
                ("gain", Value::normal(gain, change.size_sd)),
                (
                    "lag_s",
                    Value {
                        value: lag_s,
                        lo: None,
                        hi: None,
                    },
                ),
            ]);
            self.accept(
                "thermal",
                parameters,
                change.p_value,
                2.0,
                Some(change.nats),
                |axis| {
                    axis.mended.waves.push(change.wave);
                    axis.refresh(false)
                },
            )?;
            return Some(true);
        }
        if let Some(change) = warm_up.filter(|_| w > 0.0 && w >= j) {
            let Wave::WarmUp { amplitude, samples } = change.wave else {
                return Some(false);
            };
            let parameters = named([
                ("amplitude", Value::normal(amplitude, change.size_sd)),
                (
                    "time_s",
                    Value::log_normal(samples / self.axis.rate_hz, change.time_log_sd),
                ),
            ]);
            self.accept(
                "warmup",
                parameters,
                change.p_value,
                2.0,
                Some(change.nats),
                |axis| {
                    axis.mended.waves.push(change.wave);
                    axis.refresh(false)
                },
            )?;
            return Some(true);
        }
        let Some(jump) = jump else {
            return Some(false);
        };
        self.steps(jump)
    }

    fn largest_jump(&self) -> Option<Jump> {
        let factor = self.axis.slow_factor();
        let (whole, density) = self.axis.slow(&self.axis.filled);
        let axis = &*self.axis;
        let jump = levels::largest_jump(&whole, &density, self.level(), |n| {
            axis.usable(n * factor) && axis.usable((n + 1) * factor - 1)
        })?;
        Some(Jump {
            index: jump.index * factor,
            index_sd: (jump.index_sd * factor as f64).max(0.3 * factor as f64),
            ..jump
        })
    }

    fn steps(&mut self, first: Jump) -> Option<bool> {
        let waves = &mut self.axis.mended.waves;
        let place = waves.iter().position(|wave| matches!(wave, Wave::Steps(_)));
        let mut jumps = match place.map(|place| waves.remove(place)) {
            Some(Wave::Steps(jumps)) => jumps,
            _ => Vec::new(),
        };
        let reach = 8 * self.axis.slow_factor();
        match jumps
            .iter_mut()
            .find(|old| old.index.abs_diff(first.index) <= reach)
        {
            Some(old) => {
                // The same one again: what its place or height left.
                old.height += first.height;
                old.index = old.index.midpoint(first.index);
            }
            None => jumps.push(first),
        }
        jumps.sort_by_key(|jump| jump.index);
        if to_and_fro(&jumps) {
            self.switching = true;
            self.accepted.retain(|one| one.effect != "steps");
            self.axis.refresh(false)?;
            return Some(true);
        }
        let parameters = self.step_parameters(&jumps);
        let nats = self.step_gain(&jumps);
        let freedom = 2.0 * jumps.len() as f64;
        let change = |axis: &mut AxisState| {
            axis.mended.waves.push(Wave::Steps(jumps));
            axis.refresh(false)
        };
        if self.find("steps").is_some() {
            change(self.axis)?;
            let with = Snapshot::of(self.axis);
            let one = self.find("steps")?;
            (one.parameters, one.with, one.freedom) = (parameters, with, freedom);
            one.nats = one.nats.map(|before| before + nats);
        } else {
            self.accept(
                "steps",
                parameters,
                first.p_value,
                freedom,
                Some(nats),
                change,
            )?;
        }
        Some(true)
    }

    /// Gain of what the jumps add to those that are taken out already.
    fn step_gain(&self, jumps: &[Jump]) -> f64 {
        let mut waveform = vec![0.0; self.axis.filled.len()];
        Wave::Steps(jumps.to_vec()).take_out(&mut waveform);
        for wave in &self.axis.mended.waves {
            if let Wave::Steps(before) = wave {
                let back = before.iter().map(|jump| Jump {
                    height: -jump.height,
                    ..*jump
                });
                Wave::Steps(back.collect()).take_out(&mut waveform);
            }
        }
        let (record, density) = self.axis.slow(&self.axis.filled);
        let means = block_means(&waveform, self.axis.slow_factor());
        let rate_hz = self.axis.rate_hz / self.axis.slow_factor() as f64;
        let mut wave = Transformer::new(means.len()).transform(&means, rate_hz);
        wave.close(&density);
        held_out_gain(&record, &density, &wave)
    }

    fn step_parameters(&self, jumps: &[Jump]) -> BTreeMap<String, Value> {
        let rate_hz = self.axis.rate_hz;
        let rows = (1..).zip(jumps).flat_map(|(number, jump): (u32, &Jump)| {
            [
                (
                    format!("time_s_{number}"),
                    Value::normal(jump.index as f64 / rate_hz, jump.index_sd / rate_hz),
                ),
                (
                    format!("height_{number}"),
                    Value::normal(jump.height, jump.height_sd),
                ),
            ]
        });
        rows.collect()
    }

    fn bursts(&mut self) -> Option<bool> {
        let (whole, density) = self.axis.whole();
        let axis = &*self.axis;
        let powers = bursts::powers(&whole, &density, |n| axis.usable(n));
        let Some(burst) = bursts::burst(&powers, self.level()) else {
            return Some(false);
        };
        let Burst { range, factor, .. } = burst.clone();
        // A stretch that is most of the record is its law.
        if range.len() > whole.len() / 2
            || self
                .accepted
                .iter()
                .filter(|one| one.effect == "burst")
                .count()
                >= 4
        {
            return Some(false);
        }
        let rate_hz = self.axis.rate_hz;
        let parameters = named([
            (
                "from_s",
                Value::normal(range.start as f64 / rate_hz, burst.end_sd / rate_hz),
            ),
            (
                "to_s",
                Value::normal(range.end as f64 / rate_hz, burst.end_sd / rate_hz),
            ),
            ("factor", Value::log_normal(factor, burst.log_factor_sd)),
        ]);
        self.accept(
            "burst",
            parameters,
            burst.p_value,
            3.0,
            Some(burst.held_nats),
            |axis| {
                axis.mended.masked.push(range);
                axis.refresh(true)
            },
        )?;
        Some(true)
    }

    fn laws(&mut self) -> Option<bool> {
        let level = self.level();
        let axis = &*self.axis;
        let mut found: Vec<laws::Found> = CATALOGUE
            .iter()
            .filter_map(|&effect| {
                laws::search(&axis.frame, &axis.data, &axis.laws, &axis.fit, effect)
            })
            .collect();
        // Each parameter has to be paid for.
        let worth = |one: &laws::Found| one.nats - one.law.values.len() as f64;
        found.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
        if found.first().is_none_or(|best| best.p_value >= level) {
            return Some(false);
        }
        let best = found.remove(0);
        let mut rivals: Vec<Rival> = found
            .iter()
            .filter(|other| other.p_value < level)
            .map(|other| Rival {
                effect: other.law.effect.name().to_owned(),
                log_odds: worth(&best) - worth(other),
            })
            .collect();
        let (law, p_value) = (best.law, best.p_value);
        let freedom = law.values.len() as f64;
        let mut effect = law.effect.name();
        if effect == "markov"
            && let Some(two) = self.two_levels(&law, &best.fit)
        {
            let other = |name: &str, log_odds| Rival {
                effect: name.to_owned(),
                log_odds,
            };
            if two > 0.0 {
                effect = "telegraph";
                self.switching = true;
                rivals.insert(0, other("markov", two));
            } else {
                rivals.insert(0, other("telegraph", -two));
            }
        }
        self.accept(effect, BTreeMap::new(), p_value, freedom, None, |axis| {
            axis.laws.push(law);
            axis.refresh(false)
        })?;
        if let Some(one) = self.accepted.last_mut() {
            one.rivals = rivals;
        }
        Some(true)
    }

    /// Logarithm of the odds that what looks like Markov noise in the spectrum switches between
    /// two levels.
    fn two_levels(&self, law: &Law, fit: &Fit) -> Option<f64> {
        let axis = &*self.axis;
        let squared = fit.squared[laws::component_of(&axis.laws, axis.laws.len())];
        let place = law.effect.parameters(&law.values);
        let time_s = law.values[place.iter().position(|one| one.name == "time_s")?];
        let Part::Term(term) = law.effect.part(&law.values) else {
            return None;
        };
        let wander = |f_hz: f64| {
            squared * axis.frame.term_density(&*term, f_hz) * axis.frame.chain_power(f_hz)
        };
        let rest = |f_hz: f64| -> f64 {
            SEEN.iter()
                .zip(&fit.squared)
                .map(|(one, squared)| squared * axis.frame.unit_density(*one, f_hz))
                .sum()
        };
        telegraph::log_odds(axis, squared.sqrt(), time_s, wander, rest)
    }

    /// What is significant still, and named by nothing.
    fn left_over(&mut self) -> Vec<Remark> {
        let level = self.level();
        let mut remarks = Vec::new();
        self.describe_laws();
        let departure = laws::departure(&self.axis.data, &self.axis.fit.expected);
        if let Some(departure) = departure.filter(|one| one.p_value < level) {
            remarks.push(spectrum_remark(&departure));
        }
        for group in lines::lines(self.axis, level) {
            if let Group::Cluster {
                f_hz,
                width_hz,
                lines,
            } = group
            {
                let p_value = lines
                    .iter()
                    .map(|line| line.false_alarm)
                    .fold(1.0, f64::min);
                remarks.push(Remark {
                    test: "lines".into(),
                    place: format!(
                        "{:.5} to {:.5} Hz",
                        f_hz - 0.5 * width_hz,
                        f_hz + 0.5 * width_hz
                    ),
                    p_value,
                    description: format!(
                        "power in {} narrow lines that stand too close to be separate: a tone \
                         that wanders or is switched",
                        lines.len()
                    ),
                });
            }
        }
        let (whole, density) = self.axis.whole();
        let axis = &*self.axis;
        let powers = bursts::powers(&whole, &density, |n| axis.usable(n));
        if let Some(wander) = bursts::wander(&powers) {
            if wander.cyclic.0 < level {
                let period_s = wander.cyclic.1 / axis.rate_hz;
                remarks.push(Remark {
                    test: "variance".into(),
                    place: format!("period {period_s:.4} s"),
                    p_value: wander.cyclic.0,
                    description: "the power of the noise rises and falls in a cycle".into(),
                });
            }
            if wander.slow < level {
                remarks.push(Remark {
                    test: "variance".into(),
                    place: "slower than a sixteenth of the record".into(),
                    p_value: wander.slow,
                    description: "the power of the noise wanders in time".into(),
                });
            }
        }
        remarks
    }

    /// Parameters of the laws as finally fitted, with their intervals.
    fn describe_laws(&mut self) {
        let axis = &*self.axis;
        for (which, law) in axis.laws.iter().enumerate() {
            let log_sd =
                laws::log_deviations(&axis.frame, &axis.data, &axis.laws, which, &axis.fit);
            let values = law_values(axis, which);
            let parameters: BTreeMap<String, Value> = law
                .effect
                .parameters(&law.values)
                .iter()
                .zip(values.iter().zip(&log_sd))
                .map(|(parameter, (value, sd))| {
                    (parameter.name.to_string(), Value::log_normal(*value, *sd))
                })
                .collect();
            let name = law.effect.name();
            let switching = |one: &Accepted| one.effect == "telegraph" && name == "markov";
            if let Some(one) = self
                .accepted
                .iter_mut()
                .find(|one| (one.effect == name || switching(one)) && one.parameters.is_empty())
            {
                one.parameters = if switching(one) {
                    // Two levels of the same spectrum: twice the deviation apart, kept for twice
                    // the correlation time.
                    named([
                        ("height", Value::log_normal(2.0 * values[0], log_sd[0])),
                        ("dwell_s", Value::log_normal(2.0 * values[1], log_sd[1])),
                    ])
                } else {
                    parameters
                };
            }
        }
    }
}

/// Values of a law with its fitted size.
pub fn law_values(axis: &AxisState, which: usize) -> Vec<f64> {
    let law: &Law = &axis.laws[which];
    let mut values = law.values.clone();
    if let (Some(size), Part::Term(_)) = (law.effect.size(), law.effect.part(&law.values)) {
        let squared = axis.fit.squared[laws::component_of(&axis.laws, which)];
        values[size] = squared.powf(1.0 / laws::squared_power(law));
    }
    values
}

/// The laws of a snapshot.
pub fn laws_of(snapshot: &Snapshot) -> Vec<Law> {
    snapshot
        .laws
        .iter()
        .filter_map(|(name, values)| {
            Some(Law {
                effect: catalogue::find(name)?,
                values: values.clone(),
            })
        })
        .collect()
}

/// Whether jumps go up and down by turns, by about as much: two levels.
fn to_and_fro(jumps: &[Jump]) -> bool {
    if jumps.len() < SWITCHING {
        return false;
    }
    let turns = jumps
        .windows(2)
        .filter(|pair| pair[0].height * pair[1].height < 0.0)
        .count();
    let mean = jumps.iter().map(|jump| jump.height.abs()).sum::<f64>() / jumps.len() as f64;
    let alike = jumps
        .iter()
        .filter(|jump| (0.6..1.6).contains(&(jump.height.abs() / mean)))
        .count();
    5 * turns >= 4 * (jumps.len() - 1) && 5 * alike >= 4 * jumps.len()
}

fn named<const N: usize>(values: [(&str, Value); N]) -> BTreeMap<String, Value> {
    values
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

fn spectrum_remark(departure: &laws::Departure) -> Remark {
    Remark {
        test: "spectrum".into(),
        place: format!("{:.5} to {:.5} Hz", departure.from_hz, departure.to_hz),
        p_value: departure.p_value,
        description: format!(
            "{:.3} times the power that the model expects there",
            departure.ratio
        ),
    }
}
