//! The level in time: settling, what follows a covariate, jumps.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::slow;
use crate::diagnosis::detect::steps::{self, Jump};
use crate::diagnosis::record::residual::{Wave, block_means};
use crate::diagnosis::result::finding::Value;
use crate::diagnosis::rounds::steady::LONG;
use crate::diagnosis::rounds::{Rounds, Snapshot, named};
use crate::diagnosis::statistic::matched_filter::{Transformer, held_out_gain};
use crate::diagnosis::statistic::profile::Noise;

/// Jumps that are told one by one, at most.
const MOST: usize = 150;

/// Jumps from which up and down by turns is a switch rather than steps.
const SWITCHING: usize = 3;

/// Samples in one of the slow copy up to which jumps are placed to the sample.
const FINE: usize = 8;

impl Rounds<'_> {
    /// Takes out the slow change that shows most: what follows the covariate, settling, or jumps.
    pub(crate) fn levels(&mut self, noise: Noise) -> Option<bool> {
        let level = self.level();
        let open = |effect: &'static str| {
            !self.refused.contains(&effect) && self.accepted.iter().all(|one| one.effect != effect)
        };
        let thermal = match &self.options.covariate {
            Some(column) if open("thermal") => slow::follows(self.axis, column, level, noise),
            _ => None,
        };
        let warm_up = open("warmup")
            .then(|| slow::warm_up(self.axis, level, noise))
            .flatten()
            .filter(|change| !self.is_dwelling(change));
        let jump = if self.switching {
            None
        } else {
            self.largest_jump(noise)
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
                ("lag_s", Value::log_normal(lag_s, change.time_log_sd)),
            ]);
            return self.accept(
                "thermal",
                parameters,
                change.p_value,
                2.0,
                Some(change.nats),
                |axis| {
                    axis.mended.waves.push(change.wave);
                    axis.refresh()
                },
            );
        }
        if let Some(change) = warm_up.filter(|_| w > 0.0 && w >= j) {
            let Wave::WarmUp { amplitude, samples } = change.wave else {
                return Some(false);
            };
            if self.is_settling_lag(samples / self.axis.rate_hz) {
                self.axis.mended.waves.push(change.wave);
                self.axis.refresh()?;
                return Some(true);
            }
            let parameters = named([
                ("amplitude", Value::normal(amplitude, change.size_sd)),
                (
                    "time_s",
                    Value::log_normal(samples / self.axis.rate_hz, change.time_log_sd),
                ),
            ]);
            return self.accept(
                "warmup",
                parameters,
                change.p_value,
                2.0,
                Some(change.nats),
                |axis| {
                    axis.mended.waves.push(change.wave);
                    axis.refresh()
                },
            );
        }
        let Some(jump) = jump else {
            return Some(false);
        };
        self.jumps(jump)
    }

    /// Whether a settling is as quick as the level switches: a dwell at the start.
    fn is_dwelling(&self, change: &slow::SlowChange) -> bool {
        /// Dwell times that make a settling of its own.
        const DWELLS: f64 = 5.0;
        let telegraph = self.accepted.iter().find(|one| one.effect == "telegraph");
        let dwell_s = telegraph.map(|one| match one.law {
            // The correlation time is half a dwell.
            Some(law) => 2.0 * self.axis.laws[law].values[1],
            None => one
                .parameters
                .get("dwell_s")
                .map_or(0.0, |dwell| dwell.value),
        });
        match (&change.wave, dwell_s) {
            (Wave::WarmUp { samples, .. }, Some(dwell_s)) => {
                samples / self.axis.rate_hz < DWELLS * dwell_s
            }
            _ => false,
        }
    }

    /// Whether a settling with this time constant is the lag of a covariate that was not at rest as
    /// the record began.
    fn is_settling_lag(&self, time_s: f64) -> bool {
        /// Largest ratio of the two times.
        const ALIKE: f64 = 2.0;
        let thermal = self.accepted.iter().find(|one| one.effect == "thermal");
        let lag = thermal.and_then(|one| one.parameters.get("lag_s"));
        lag.is_some_and(|lag| (time_s / lag.value).ln().abs() < ALIKE.ln())
    }

    fn largest_jump(&self, noise: Noise) -> Option<Jump> {
        let factor = self.axis.slow_factor();
        let (whole, density) = self.axis.slow(&self.axis.filled, factor);
        let axis = &*self.axis;
        let usable = |n: usize| axis.usable(n * factor) && axis.usable((n + 1) * factor - 1);
        let mut jump = steps::largest_jump(&whole, &density, usable)?;
        if noise == Noise::Anew && jump.p_value >= self.level() {
            jump = steps::beside_walk(axis, whole, &density, &jump, usable)?;
        }
        if jump.p_value >= self.level() {
            return None;
        }
        // In a loud stretch the level seems to jump, and about a jump the noise seems loud: whichever
        // is worth more.
        let burst = self.even_burst();
        let louder = burst.filter(|burst| {
            let nats = -burst.p_value.max(f64::MIN_POSITIVE).ln();
            burst.range.len() >= LONG && nats > 0.5 * jump.z * jump.z
        });
        if louder.is_some_and(|burst| burst.range.contains(&(jump.index * factor))) {
            return None;
        }
        Some(Jump {
            index: jump.index * factor,
            index_sd: (jump.index_sd * factor as f64).max(0.3 * factor as f64),
            ..jump
        })
    }

    /// Takes out the jumps, largest first, beginning with `first`.
    fn jumps(&mut self, first: Jump) -> Option<bool> {
        let waves = &mut self.axis.mended.waves;
        let place = waves.iter().position(|wave| matches!(wave, Wave::Steps(_)));
        let mut jumps = match place.map(|place| waves.remove(place)) {
            Some(Wave::Steps(jumps)) => jumps,
            _ => Vec::new(),
        };
        let place = self.placing();
        let mut next = Some(first);
        let mut new = Vec::new();
        while let Some(jump) = next.filter(|_| jumps.len() + new.len() <= MOST) {
            let jump = place(jump);
            let filled = Arc::make_mut(&mut self.axis.filled);
            Wave::Steps(vec![jump]).take_out(filled);
            self.axis.set_aside(&jump);
            new.push(jump);
            next = self.largest_jump(Noise::Fitted);
        }
        new.sort_by_key(|jump| jump.index);
        let nats = self.jump_gain(&new);
        let reach = 4 * self.axis.slow_factor();
        for jump in new {
            match jumps
                .iter_mut()
                .find(|old| old.index.abs_diff(jump.index) <= reach)
            {
                // The same one again: what was left of its height.
                Some(old) => old.height += jump.height,
                None => jumps.push(jump),
            }
        }
        jumps.sort_by_key(|jump| jump.index);
        let switching = to_and_fro(&jumps);
        let found = self.accepted.iter().position(|one| {
            one.effect == "steps" || (one.effect == "telegraph" && !self.switching)
        });
        if jumps.len() > MOST {
            // Too many to be told one by one: their spectrum tells.
            self.switching = true;
            if let Some(found) = found {
                self.accepted.remove(found);
            }
            self.axis.refresh()?;
            return Some(true);
        }
        let (effect, parameters) = if switching {
            ("telegraph", self.switch_parameters(&whole_jumps(&jumps)))
        } else {
            ("steps", self.step_parameters(&jumps))
        };
        if self.refused.contains(&effect) {
            self.axis.refresh()?;
            return Some(false);
        }
        let freedom = 2.0 * jumps.len() as f64;
        let change = |axis: &mut AxisState| {
            axis.mended.waves.push(Wave::Steps(jumps));
            axis.refresh_jumps()
        };
        let Some(found) = found else {
            let accepted = self.accept(
                effect,
                parameters,
                first.p_value,
                freedom,
                Some(nats),
                change,
            )?;
            // What was slower may have been found for the jumps: it is looked for again.
            if accepted && (self.withdraw("warmup") | self.withdraw("thermal")) {
                self.axis.refresh()?;
            }
            return Some(accepted);
        };
        change(self.axis)?;
        let (with, after) = (Snapshot::of(self.axis), self.axis.fit.clone());
        let one = &mut self.accepted[found];
        one.nats = one.nats.map(|before| before + nats);
        (one.effect, one.parameters, one.freedom) = (effect, parameters, freedom);
        (one.with, one.after) = (with, after);
        Some(true)
    }

    /// Gives up jumps that were told one by one and belong to a switching of which more is left.
    /// Whether there were any.
    pub(crate) fn drop_switching(&mut self) -> Option<bool> {
        if self.switching {
            return Some(false);
        }
        let Some(found) = self
            .accepted
            .iter()
            .position(|one| one.effect == "telegraph")
        else {
            return Some(false);
        };
        self.accepted.remove(found);
        self.switching = true;
        self.axis
            .mended
            .waves
            .retain(|wave| !matches!(wave, Wave::Steps(_)));
        self.axis.refresh_jumps()?;
        Some(true)
    }

    /// What places a jump of the slow copy among the samples themselves.
    fn placing(&self) -> impl Fn(Jump) -> Jump + use<> {
        let factor = self.axis.slow_factor();
        let filter = (factor > 1 && factor <= FINE).then(|| {
            let seen = self.axis.whole();
            steps::statistic(&seen.whole, &seen.density)
        });
        move |jump| match &filter {
            Some(filter) => steps::place(filter, jump, 2 * factor),
            None => jump,
        }
    }

    /// Two levels by their jumps.
    fn switch_parameters(&self, jumps: &[Jump]) -> BTreeMap<String, Value> {
        let count = jumps.len() as f64;
        let heights: Vec<f64> = jumps.iter().map(|jump| jump.height.abs()).collect();
        let height = heights.iter().sum::<f64>() / count;
        let scatter = heights
            .iter()
            .map(|one| (one - height).powi(2))
            .sum::<f64>()
            / count;
        let own = jumps.iter().map(|jump| jump.height_sd.powi(2)).sum::<f64>() / count;
        let duration_s = self.axis.filled.len() as f64 / self.axis.rate_hz;
        named([
            (
                "height",
                Value::normal(height, (scatter.max(own) / count).sqrt()),
            ),
            (
                "dwell_s",
                Value::log_normal(duration_s / count, count.sqrt().recip()),
            ),
        ])
    }

    /// Gain of jumps that were taken out just now.
    fn jump_gain(&self, jumps: &[Jump]) -> f64 {
        let mut waveform = vec![0.0; self.axis.filled.len()];
        Wave::Steps(jumps.to_vec()).take_out(&mut waveform);
        let means = block_means(&waveform, self.axis.slow_factor());
        // They are taken out of the record already; for a comparison they go back in.
        let mut before = waveform;
        for (before, left) in before.iter_mut().zip(self.axis.filled.iter()) {
            *before = left - *before;
        }
        let (record, density) = self.axis.slow(&before, self.axis.slow_factor());
        let rate_hz = self.axis.rate_hz / self.axis.slow_factor() as f64;
        let mut wave = Transformer::new(means.len()).transform(&means, rate_hz);
        wave.close(&density);
        held_out_gain(&record, &density, &wave)
    }

    fn step_parameters(&self, jumps: &[Jump]) -> BTreeMap<String, Value> {
        /// Standard deviation of a moment between two samples, over their distance.
        const BETWEEN: f64 = 0.288_675_134_594_812_9;
        let rate_hz = self.axis.rate_hz;
        let rows = (1..).zip(jumps).flat_map(|(number, jump): (u32, &Jump)| {
            // It came between the sample that has it first and the one before.
            let index = jump.index as f64 - 0.5;
            let index_sd = jump.index_sd.hypot(BETWEEN);
            [
                (
                    format!("time_s_{number}"),
                    Value::normal(index / rate_hz, index_sd / rate_hz),
                ),
                (
                    format!("height_{number}"),
                    Value::normal(jump.height, jump.height_sd),
                ),
            ]
        });
        rows.collect()
    }
}

/// The jumps between two levels among all: what the placing of one left beside it is smaller.
fn whole_jumps(jumps: &[Jump]) -> Vec<Jump> {
    /// Share of the upper quartile's height that a whole jump has.
    const SHARE: f64 = 0.5;
    let mut heights: Vec<f64> = jumps.iter().map(|jump| jump.height.abs()).collect();
    heights.sort_by(f64::total_cmp);
    let typical = heights.get(3 * heights.len() / 4).copied().unwrap_or(0.0);
    let is_whole = |jump: &&Jump| jump.height.abs() >= SHARE * typical;
    jumps.iter().filter(is_whole).copied().collect()
}

/// Whether jumps go up and down by turns, by about as much: two levels.
fn to_and_fro(jumps: &[Jump]) -> bool {
    /// Share of the squared heights that is not between the two levels, at most.
    const REST: f64 = 0.1;
    let energy = |jumps: &[Jump]| jumps.iter().map(|jump| jump.height.powi(2)).sum::<f64>();
    let whole = whole_jumps(jumps);
    if whole.len() < SWITCHING || energy(&whole) < (1.0 - REST) * energy(jumps) {
        return false;
    }
    let turns = whole
        .windows(2)
        .filter(|pair| pair[0].height * pair[1].height < 0.0)
        .count();
    let mean = whole.iter().map(|jump| jump.height.abs()).sum::<f64>() / whole.len() as f64;
    let alike = whole
        .iter()
        .filter(|jump| (0.6..1.6).contains(&(jump.height.abs() / mean)))
        .count();
    5 * turns >= 4 * (whole.len() - 1) && 5 * alike >= 4 * whole.len()
}
