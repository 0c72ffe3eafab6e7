//! Single values: repeats, pile-ups, coarse steps, outliers.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::burst::{self, Powers};
use crate::diagnosis::detect::outliers::{self, Outlier, Outliers};
use crate::diagnosis::detect::steps;
use crate::diagnosis::detect::values::Coarse;
use crate::diagnosis::record::residual::Wave;
use crate::diagnosis::result::finding::Value;
use crate::diagnosis::rounds::{CodeFindings, Rounds, Snapshot, named};
use crate::diagnosis::statistic::matched_filter::Whole;

/// How much further out an outlier must be where the strength of the noise moves.
const RESTLESS: f64 = 3.0;

impl Rounds<'_> {
    /// Takes over what the values themselves say.
    pub(crate) fn take_codes(&mut self, values: &CodeFindings) -> Option<()> {
        if let Some((stale, places)) = &values.stale {
            let share = Value::normal(stale.share, stale.share_sd);
            let seen = self.axis.whole();
            let (whole, density) = (&seen.whole, &seen.density);
            let replaced = outliers::sizes_at(whole, density, places);
            let parameters = named([("share", share)]);
            let p_value = stale.p_value;
            self.accept("stale", parameters, p_value, 1.0, None, |axis| {
                axis.mended.waves.push(Wave::Replaced(replaced));
                axis.refresh()
            })?;
        }
        for (clipping, places) in &values.clipping {
            // Known to the rounding of the mean that was taken out and put back.
            let slack = 4.0 * f64::EPSILON * values.largest;
            let parameters = named([
                ("level", Value::normal(clipping.level, slack)),
                ("side", Value::exact(clipping.side)),
            ]);
            let seen = self.axis.whole();
            let (whole, density) = (&seen.whole, &seen.density);
            let replaced = outliers::sizes_at(whole, density, places);
            self.accept(
                "clipping",
                parameters,
                clipping.p_value,
                1.0,
                None,
                |axis| {
                    axis.mended.waves.push(Wave::Replaced(replaced));
                    axis.refresh()
                },
            )?;
        }
        if let Some(Coarse { step, decides }) = values.coarse {
            self.grid_decides = decides;
            // A difference of two values, each known to its rounding. Thousands of values on a grid
            // that nobody laid have a probability below what a number can hold.
            let step = Value::normal(step, 4.0 * f64::EPSILON * values.largest);
            self.accept(
                "quantisation",
                named([("step", step)]),
                0.0,
                1.0,
                None,
                |_| Some(()),
            )?;
        }
        Some(())
    }

    /// Takes out samples that do not belong.
    pub(crate) fn outliers(&mut self) -> Option<bool> {
        if self.refused.contains(&"outliers") || self.ringing {
            return Some(false);
        }
        let seen = self.axis.whole();
        let len = seen.whole.len();
        let powers = self.axis.powers();
        let old = self.axis.mended.outliers().to_vec();
        // What else was taken out since they were found.
        let else_now = self.accepted.len();
        let mut found = Outliers::default();
        if old.is_empty() || self.sought_beside == else_now {
            found = self.sought(&seen.whole, &seen.density, &powers);
            if found.found.is_empty() {
                return Some(false);
            }
        }
        if old.is_empty() {
            drop(seen);
        } else {
            // In noise that they themselves had raised, beside lines and jumps that were still there, the
            // first are known less well, in size and in place, than they can be now: all are looked
            // for again. What the record is without them makes room meanwhile.
            let density = seen.density.clone();
            drop(seen);
            self.axis.forget_whole();
            found = self.sought(&self.axis.with(&old, &density), &density, &powers);
            let places =
                |all: &[Outlier]| -> Vec<usize> { all.iter().map(|one| one.index).collect() };
            let same = places(&found.found) == places(&old);
            self.sought_beside = else_now;
            if same {
                return Some(false);
            }
            if found.found.is_empty() {
                self.withdraw("outliers");
                self.axis.refresh()?;
                return Some(true);
            }
        }
        let moments: Vec<_> = found
            .found
            .iter()
            .map(|one| one.index..one.index + 1)
            .collect();
        let together = outliers::together(&found.found, len) < self.level();
        if together || self.is_of_band(&moments) {
            self.ringing = true;
            return Some(false);
        }
        if self.is_of_switching(&found.found) {
            self.ringing = true;
            let named = self.withdraw("outliers");
            if named {
                self.axis.refresh()?;
            }
            return Some(named);
        }
        // Where a whole stretch is noisier, its large samples are no outliers.
        let burst = burst::burst(&powers, self.level());
        let inside = |one: &Outlier| {
            burst.as_ref().is_some_and(|burst| {
                let wide = (3.0 * burst.end_sd) as usize;
                let from = burst.range.start.saturating_sub(wide);
                (from..burst.range.end + wide).contains(&one.index)
            })
        };
        let within = found.found.iter().filter(|one| inside(one)).count();
        if within > 0 && 3 * within >= 2 * found.found.len() {
            return Some(false);
        }
        let duration_s = self.axis.filled.len() as f64 / self.axis.rate_hz;
        let law = outliers::law_of(&found.found, found.threshold);
        let count = found.found.len() as f64;
        let parameters = named([
            (
                "rate_hz",
                Value::log_normal(law.count / duration_s, law.count_log_sd),
            ),
            ("size", Value::log_normal(law.size, law.size_log_sd)),
        ]);
        let nats = found.nats;
        let change = |axis: &mut AxisState| {
            axis.mended
                .waves
                .retain(|wave| !matches!(wave, Wave::Outliers(_)));
            axis.mended.waves.push(Wave::Outliers(found.found));
            axis.refresh()
        };
        if self.find("outliers").is_some() {
            change(self.axis)?;
            let (with, after) = (Snapshot::of(self.axis), self.axis.fit.clone());
            let one = self.find("outliers")?;
            (one.parameters, one.freedom) = (parameters, 2.0 * count);
            (one.with, one.after) = (with, after);
            one.nats = Some(nats);
        } else {
            let p_value = found.p_value;
            return self.accept(
                "outliers",
                parameters,
                p_value,
                2.0 * count,
                Some(nats),
                change,
            );
        }
        Some(true)
    }

    /// Samples of `whole` that stand out of noise of this `density`, whose strength over time is known.
    fn sought(&self, whole: &Whole, density: &[f64], powers: &Powers) -> Outliers {
        let local = self.restless.then(|| powers.local());
        let mut found = outliers::outliers(
            whole,
            density,
            self.level(),
            |n| self.axis.usable(n),
            |n| local.as_ref().map_or(1.0, |local| RESTLESS * local(n)),
        );
        if self.switching && !found.found.is_empty() {
            // A jump is larger as a jump than as a single sample.
            let jumps = steps::statistic(whole, density);
            found.found.retain(|one| !steps::is_jump(&jumps, one));
        }
        found
    }
}
