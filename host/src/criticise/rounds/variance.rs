//! Stretches of the record with noise of another size.

use super::super::bursts::{self, Burst, even, wander};
use super::super::finding::Value;
use super::steady::LONG;
use super::{Rounds, named};
use std::ops::Range;

/// Stretches at most.
const MOST: usize = 3;

/// Samples from the end of a burst within which a short stretch belongs to it.
const NEAR: usize = 4096;

/// Samples about an outlier where something of it may stay.
const REMAINS: usize = 64;

impl Rounds<'_> {
    /// The stretch that departs most from the rest, if it is a burst: not most of the record, not of a
    /// band alone, and no rest on a coarse grid.
    pub(super) fn even_burst(&self) -> Option<Burst> {
        if self.restless {
            return None;
        }
        let burst = bursts::burst(&self.axis.powers(), self.level())?;
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
    pub(super) fn bursts(&mut self) -> Option<bool> {
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
        if let Some(longer) = self.beside(&range) {
            return self.lengthen(longer, &range);
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
                axis.refresh(true)
            },
        )
    }

    /// The burst, by its place among the effects, that a short stretch is an end of: noise that is switched
    /// behind the converter's filter leaves what the filter shuts out.
    fn beside(&self, range: &Range<usize>) -> Option<usize> {
        let rate_hz = self.axis.rate_hz;
        self.accepted.iter().position(|one| {
            let at = |name: &str| Some(one.parameters.get(name)?.value * rate_hz);
            let ends = (one.effect == "burst").then(|| at("from_s").zip(at("to_s")));
            ends.flatten().is_some_and(|(from, to)| {
                let short = range.len() <= LONG.min((to - from) as usize);
                let near = [from, to].map(|end| {
                    (range.start as f64 - end)
                        .abs()
                        .min((range.end as f64 - end).abs())
                });
                short && near[0].min(near[1]) < NEAR as f64
            })
        })
    }

    /// Masks a stretch beside a burst along with it.
    fn lengthen(&mut self, place: usize, range: &Range<usize>) -> Option<bool> {
        let rate_hz = self.axis.rate_hz;
        let one = &mut self.accepted[place];
        for (name, end) in [("from_s", range.start), ("to_s", range.end)] {
            let end_s = end as f64 / rate_hz;
            if let Some(value) = one.parameters.get_mut(name)
                && ((name == "from_s") == (end_s < value.value))
            {
                *value = Value::normal(end_s, bursts::BLOCK as f64 / rate_hz);
            }
        }
        self.axis.mended.masked.push(range.clone());
        self.axis.refresh(true)?;
        Some(true)
    }

    /// Whether the values lie on a coarse grid: noise seems to change its strength wherever its level
    /// lies within a step.
    pub(super) fn is_coarse(&self) -> bool {
        self.accepted.iter().any(|one| one.effect == "quantisation")
    }

    /// Notes that the strength of the noise moves all the time, where it does.
    pub(super) fn strength(&mut self) -> Option<bool> {
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
            self.axis.refresh(true)?;
        }
        Some(any)
    }
}
