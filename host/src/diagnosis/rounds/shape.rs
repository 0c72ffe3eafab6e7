//! Laws that change the spectrum's shape.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::diagnosis::detect::lines;
use crate::diagnosis::detect::telegraph;
use crate::diagnosis::laws::spread::Spread;
use crate::diagnosis::laws::{self, Law, search};
use crate::diagnosis::result::finding::{Rival, Value};
use crate::diagnosis::rounds::{Rounds, named};
use crate::fit::likelihood::Fit;
use crate::model::catalogue::{self, CATALOGUE};
use crate::model::effect::Part;

/// Share of the level that is left where the strength of the noise moves.
const RESTLESS: f64 = 1e-3;

/// Width over 1/T of a resonance that a record can tell from a line.
const RESOLVED: f64 = 1.0;

/// Laws at most.
const MOST: usize = 4;

impl Rounds<'_> {
    /// Adds the law that is worth most.
    pub(crate) fn laws(&mut self) -> Option<bool> {
        // With more laws than that the record is of another kind, and no name is worth much.
        if self.axis.laws.len() == MOST {
            return Some(false);
        }
        // Bins of noise whose strength moves scatter by more than their degrees of freedom say.
        let level = self.level() * if self.restless { RESTLESS } else { 1.0 };
        let axis = &*self.axis;
        let starts = axis.starts()?;
        let refused = self.refused;
        let mut found: Vec<search::Found> = CATALOGUE
            .par_iter()
            .filter(|effect| !refused.contains(&effect.name()))
            .filter_map(|&effect| {
                search::search(
                    &axis.frame,
                    &axis.data,
                    &axis.laws,
                    &axis.fit,
                    &starts,
                    effect,
                )
            })
            .collect();
        // Each parameter has to be paid for.
        let worth = |one: &search::Found| one.nats - one.law.values.len() as f64;
        // Only what is significant competes: a search over more shapes gains more by chance.
        found.retain(|one| one.p_value < level);
        found.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
        // A resonance too narrow for the record to resolve is a line, or nothing.
        let line = found
            .first()
            .filter(|one| one.p_value < level && self.is_line(one));
        if let Some(line) = line {
            if self.unresolved(line.law.values[0], line.p_value)? {
                return Some(true);
            }
            found.remove(0);
        }
        if found.is_empty() {
            return Some(false);
        }
        if found[0].law.effect.name() == "markov" {
            // Jumps seen one by one may be a part of it.
            if self.drop_switching()? || self.switching_with_jumps()? {
                return Some(true);
            }
        }
        let mut candidates: Vec<(&'static str, f64)> = found
            .iter()
            .map(|one| (one.law.effect.name(), worth(one)))
            .collect();
        let (mut effect, mut most) = candidates[0];
        let mut place = 0;
        if let Some((markov, two)) = self.switch_among(&found, worth) {
            let telegraph = candidates[markov].1 + two;
            candidates.push(("telegraph", telegraph));
            if telegraph > most {
                (effect, most, place) = ("telegraph", telegraph, markov);
                self.switching = true;
                // Its jumps may have passed for them.
                for other in ["outliers", "steps", "warmup"] {
                    self.withdraw(other);
                }
            }
        }
        candidates.retain(|(name, _)| *name != effect);
        candidates.sort_by(|a, b| b.1.total_cmp(&a.1));
        let rivals = candidates.iter().map(|(name, worth)| Rival {
            effect: (*name).to_owned(),
            log_odds: most - worth,
        });
        let rivals: Vec<Rival> = rivals.collect();
        let best = found.remove(place);
        let (law, p_value) = (best.law, best.p_value);
        let freedom = law.values.len() as f64;
        let accepted = self.accept(effect, BTreeMap::new(), p_value, freedom, None, |axis| {
            axis.laws.push(law);
            axis.refresh_jumps()
        })?;
        if let Some(one) = self.accepted.last_mut().filter(|_| accepted) {
            one.rivals = rivals;
            one.law = Some(self.axis.laws.len() - 1);
        }
        Some(accepted)
    }

    /// Whether a law is a resonance narrower than the record resolves, or one whose power stands at a
    /// single frequency: bins see no more than a width of their own.
    fn is_line(&self, one: &search::Found) -> bool {
        /// Width over frequency below which bins do not tell it.
        const SEEN_BY_BINS: f64 = 0.1;
        /// Share of the power that a line there holds.
        const SHARE: f64 = 0.5;
        let axis = &*self.axis;
        let [f_hz, width_hz, ..] = one.law.values[..] else {
            return false;
        };
        if one.law.effect.name() != "resonance" || width_hz > SEEN_BY_BINS * f_hz {
            return false;
        }
        let component = laws::component_of(&axis.frame, &axis.laws, axis.laws.len());
        let line = lines::measure_near(axis, f_hz, one.p_value).line;
        width_hz * self.duration_s() < RESOLVED
            || 0.5 * line.amplitude.powi(2) > SHARE * one.fit.squared[component]
    }

    /// Of what was found, best first, the Markov noise that may switch between two levels as well,
    /// and the logarithm of the odds that it does.
    fn switch_among(
        &self,
        found: &[search::Found],
        worth: impl Fn(&search::Found) -> f64,
    ) -> Option<(usize, f64)> {
        /// By how much the Markov noise may be less likely than the best.
        const NEAR: f64 = 10.0;
        // One switch is enough: what is left of it is no second one.
        let known = self.accepted.iter().any(|one| one.effect == "telegraph");
        if known || self.refused.contains(&"telegraph") {
            return None;
        }
        let place = found
            .iter()
            .position(|one| one.law.effect.name() == "markov")?;
        let near = worth(&found[0]) - worth(&found[place]) < NEAR;
        let two = near.then(|| self.two_levels(&found[place].law, &found[place].fit))??;
        Some((place, two))
    }

    /// Adds the switching between two levels, where it is what makes the spectrum's low end.
    pub(crate) fn switching_law(&mut self) -> Option<bool> {
        if self.switching || self.refused.contains(&"telegraph") {
            return Some(false);
        }
        if self.switches(&[])? {
            self.switching = true;
            return self.laws();
        }
        self.switching_with_jumps()
    }

    /// The same with the jumps that were told one by one put back, if they go to and fro by its height.
    fn switching_with_jumps(&mut self) -> Option<bool> {
        let jumps = self.to_and_fro();
        if self.switching || self.refused.contains(&"telegraph") || jumps.is_empty() {
            return Some(false);
        }
        let before = (self.axis.mended.clone(), self.accepted.clone());
        self.withdraw("steps");
        self.axis.refresh_jumps()?;
        if self.switches(&jumps)? {
            self.switching = true;
            return self.laws();
        }
        (self.axis.mended, self.accepted) = before;
        self.axis.refresh_jumps()?;
        Some(false)
    }

    /// Whether there is Markov noise that rather switches between two levels, of the height of the
    /// `jumps`.
    fn switches(&self, jumps: &[f64]) -> Option<bool> {
        /// Largest factor between a jump and the height.
        const ALIKE: f64 = 1.6;
        /// Odds that take a jump back, which by itself widens the law of amplitudes.
        const PUT_BACK: f64 = 3.0;
        let axis = &*self.axis;
        let markov = catalogue::find("markov")?;
        let found = search::search(
            &axis.frame,
            &axis.data,
            &axis.laws,
            &axis.fit,
            &*axis.starts()?,
            markov,
        );
        let Some(found) = found.filter(|one| one.p_value < self.level()) else {
            return Some(false);
        };
        let component = laws::component_of(&axis.frame, &axis.laws, axis.laws.len());
        let height = 2.0 * found.fit.squared[component].sqrt();
        let alike = |jump: &f64| (height / jump.abs()).ln().abs() < ALIKE.ln();
        if !jumps.iter().all(alike) {
            return Some(false);
        }
        let odds = self.two_levels(&found.law, &found.fit);
        let least = if jumps.is_empty() { 0.0 } else { PUT_BACK };
        Some(odds.is_some_and(|odds| odds > least))
    }

    /// Heights of the jumps that were told one by one, if each goes back where the one before came
    /// from.
    fn to_and_fro(&self) -> Vec<f64> {
        let heights: Vec<f64> = self.axis.mended.jumps().map(|jump| jump.height).collect();
        let back = heights.windows(2).all(|pair| pair[0] * pair[1] < 0.0);
        if back { heights } else { Vec::new() }
    }

    /// Logarithm of the odds that what looks like Markov noise in the spectrum switches between
    /// two levels.
    fn two_levels(&self, law: &Law, fit: &Fit) -> Option<f64> {
        let axis = &*self.axis;
        let squared = fit.squared[laws::component_of(&axis.frame, &axis.laws, axis.laws.len())];
        let place = law.effect.parameters(&law.values);
        let time_s = law.values[place.iter().position(|one| one.name == "time_s")?];
        let Part::Term(term) = law.effect.part(&law.values) else {
            return None;
        };
        let wander = |f_hz: f64| {
            squared * axis.frame.term_density(&*term, f_hz) * axis.frame.chain_power(f_hz)
        };
        let rest = |f_hz: f64| axis.frame.base_density(&fit.squared, f_hz);
        telegraph::log_odds(axis, squared.sqrt(), time_s, wander, rest)
    }

    /// Parameters of the laws as finally fitted, with their intervals; standard deviations of the
    /// squares of the base components beside them.
    pub(crate) fn describe_laws(&mut self) -> Vec<f64> {
        let axis = &*self.axis;
        let spread = Spread::new(&axis.frame, &axis.data, &axis.laws, &axis.fit);
        for (which, law) in axis.laws.iter().enumerate() {
            let log_sd = spread.log_deviations(which);
            let values = laws::sized(&axis.frame, &axis.laws, which, &axis.fit);
            let parameters: BTreeMap<String, Value> = law
                .effect
                .parameters(&law.values)
                .iter()
                .zip(values.iter().zip(&log_sd))
                .map(|(parameter, (value, sd))| {
                    (parameter.name.to_string(), Value::log_normal(*value, *sd))
                })
                .collect();
            let mut accepted = self.accepted.iter_mut();
            if let Some(one) = accepted.find(|one| one.law == Some(which)) {
                one.parameters = if one.effect == "telegraph" {
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
        (0..axis.frame.units().len())
            .map(|component| spread.square_sd(component))
            .collect()
    }
}
