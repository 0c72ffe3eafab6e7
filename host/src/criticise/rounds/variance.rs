//! Stretches of the record with noise of another size.

use super::super::bursts::{self, Burst};
use super::super::finding::Value;
use super::{Rounds, named};

/// Stretches at most.
const MOST: usize = 4;

impl Rounds<'_> {
    /// Masks the stretch that departs most from the rest.
    pub(super) fn bursts(&mut self) -> Option<bool> {
        let seen = self.axis.whole();
        let (whole, density) = (&seen.whole, &seen.density);
        let axis = &*self.axis;
        let powers = bursts::powers(whole, density, |n| axis.usable(n));
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
                >= MOST
        {
            return Some(false);
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
        self.accept(
            "burst",
            parameters,
            burst.p_value,
            3.0,
            Some(burst.held_nats),
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
}
