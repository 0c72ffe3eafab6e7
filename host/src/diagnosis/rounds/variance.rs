//! Stretches of the record with noise of another size.

use crate::diagnosis::detect::burst::{self, Burst, even};
use crate::diagnosis::doubt::wander;
use crate::diagnosis::result::finding::Value;
use crate::diagnosis::rounds::steady::LONG;
use crate::diagnosis::rounds::{Accepted, Rounds, named};
use std::collections::BTreeMap;
use std::ops::Range;

/// Stretches at most.
const MOST: usize = 3;

/// Samples from the end of a burst within which a short stretch belongs to it.
const NEAR: f64 = 4096.0;

/// Samples about an outlier where something of it may stay.
const REMAINS: usize = 64;

impl Rounds<'_> {
    /// The stretch that departs most from the rest, if it is a burst: not most of the record, not of a
    /// band alone, and no rest on a coarse grid.
    pub(crate) fn even_burst(&self) -> Option<Burst> {
        if self.restless || self.grid_decides {
            return None;
        }
        let burst = burst::burst(&self.axis.powers(), self.level())?;
        let seen = self.axis.whole();
        let range = &burst.range;
        // A stretch that is most of the record is its law.
        let is_law = range.len() > seen.whole.len() / 2;
        let rests = burst.factor < 1.0 && self.is_coarse();
        // Of samples that were taken out close together, something stays.
        let outliers = self.axis.mended.outliers();
        let near = range.start.saturating_sub(REMAINS)..range.end + REMAINS;
        let remains =
            range.len() <= 4 * REMAINS && outliers.iter().any(|one| near.contains(&one.index));
        // What is stronger in some band only is something else.
        let of_band = || {
            self.is_of_band(std::slice::from_ref(range))
                || even::p_value(&seen, range) < self.level()
        };
        (!is_law && !rests && !remains && !of_band()).then_some(burst)
    }

    /// Masks the stretch that departs most from the rest.
    pub(crate) fn bursts(&mut self) -> Option<bool> {
        // What is taken back for a burst must not be taken back for one that is refused.
        if self.refused.contains(&"burst") {
            return Some(false);
        }
        let Some(burst) = self.even_burst() else {
            return Some(false);
        };
        let Burst { range, factor, .. } = burst.clone();
        let before = self.accepted.iter().filter(|one| one.effect == "burst");
        if before.count() == MOST {
            // It comes and goes all the time.
            return self.restless_noise();
        }
        let rate_hz = self.axis.rate_hz;
        // Where the level switches, a stretch shorter than its dwell is two jumps too close to be
        // told apart.
        let switching = self.accepted.iter().find(|one| one.effect == "telegraph");
        let dwell_s = switching
            .and_then(|one| one.parameters.get("dwell_s"))
            .map_or(0.0, |dwell| dwell.value);
        if (range.len() as f64) < dwell_s * rate_hz {
            return Some(false);
        }
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
        // Large samples of the stretch may have passed for them.
        self.withdraw("outliers");
        if let Some(other) = self.beside(&range) {
            return self.join(other, &range, parameters, burst.held_nats);
        }
        self.accept(
            "burst",
            parameters,
            burst.p_value,
            3.0,
            burst.held_nats,
            |axis| {
                // The ends are known to within some blocks.
                let wide = 3.0 * burst.end_sd;
                let from = (range.start as f64 - wide).max(0.0) as usize;
                let to = ((range.end as f64 + wide) as usize).min(axis.mended.len());
                axis.mended.masked.push(from..to);
                axis.refresh()
            },
        )
    }

    /// The burst, by its place among the effects, of which a stretch is an end, or the other way
    /// round: noise that is switched behind the converter's filter leaves what the filter shuts out.
    fn beside(&self, range: &Range<usize>) -> Option<usize> {
        self.accepted.iter().position(|one| {
            self.stretch_of(one).is_some_and(|[from, to]| {
                let ends = [range.start as f64, range.end as f64];
                let apart = (ends[0] - to).max(from - ends[1]);
                let shorter = (to - from).min(ends[1] - ends[0]);
                shorter <= LONG as f64 && apart < NEAR
            })
        })
    }

    /// First and last sample of a burst.
    fn stretch_of(&self, one: &Accepted) -> Option<[f64; 2]> {
        if one.effect != "burst" {
            return None;
        }
        let at = |name: &str| Some(one.parameters.get(name)?.value * self.axis.rate_hz);
        Some([at("from_s")?, at("to_s")?])
    }

    /// Joins a stretch with the burst that it is a part of: of the longer one's size, between the
    /// outer ends of both.
    fn join(
        &mut self,
        other: usize,
        range: &Range<usize>,
        mut parameters: BTreeMap<String, Value>,
        nats: Option<f64>,
    ) -> Option<bool> {
        let [from, to] = self.stretch_of(&self.accepted[other])?;
        let mut old = self.accepted[other].parameters.clone();
        if to - from > range.len() as f64 {
            std::mem::swap(&mut old, &mut parameters);
        }
        for (name, first) in [("from_s", true), ("to_s", false)] {
            if let (Some(one), Some(two)) = (parameters.get_mut(name), old.get(name))
                && (two.value < one.value) == first
            {
                *one = *two;
            }
        }
        let one = &mut self.accepted[other];
        one.parameters = parameters;
        one.nats = nats.or(one.nats);
        self.axis.mended.masked.push(range.clone());
        self.axis.refresh()?;
        Some(true)
    }

    /// Whether the values lie on a coarse grid: noise seems to change its strength wherever its level
    /// lies within a step.
    pub(crate) fn is_coarse(&self) -> bool {
        self.accepted.iter().any(|one| one.effect == "quantisation")
    }

    /// Notes that the strength of the noise moves all the time, where it does.
    pub(crate) fn strength(&mut self) -> Option<bool> {
        if self.restless || self.is_coarse() {
            return Some(false);
        }
        let powers = self.axis.powers();
        let moves = wander::wander(&powers)
            .is_some_and(|moves| moves.cyclic.p_value.min(moves.slow.p_value) < self.level());
        if moves {
            return self.restless_noise();
        }
        Some(false)
    }

    /// With noise whose strength moves all the time single stretches are no causes, and samples are
    /// outliers only against the noise about them. Whether anything is taken back.
    fn restless_noise(&mut self) -> Option<bool> {
        self.restless = true;
        let mut any = self.withdraw("burst");
        any |= self.withdraw("outliers");
        if any {
            self.axis.refresh()?;
        }
        Some(any)
    }
}
