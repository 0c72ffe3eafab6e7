//! What an estimate is made from, and which source serves which bins.
//!
//! Each bin takes the source with the finest resolution among those that have seen enough of the
//! record ([`Settings::segments`]): a level's segments in the band where its decimators are flat,
//! or, below what segments reach, the cosine transform of the whole record.

use super::{
    binning::{Group, Origin, Settings},
    cascade::Cascade,
    cosine::{LOWEST_CYCLES, Run},
    covariance::Correlations,
    decimate::{FACTOR, PASS},
    history::SlowRun,
    segments::{LEN, Power},
};
use std::ops::RangeInclusive;

/// Lowest bin of a segment that is used where the record is long enough to choose: below, the
/// next level or the whole record sees more.
const LOWEST_BIN: usize = 6;

/// Lowest bin of a segment that is used where nothing else reaches.
const LAST_RESORT_BIN: usize = 2;

/// Highest bin of a segment at the sample rate itself: the two below half the rate are not
/// independent of their own mirror images.
const HIGHEST_BIN: usize = LEN / 2 - 2;

/// Runs shorter than this share of the longest do not enter the transform of the whole record.
const RUN_SHARE: usize = 2;

/// What an estimate is made from.
pub(super) struct Sources<'a> {
    pub(super) cascade: &'a Cascade,
    pub(super) rate_hz: f64,
    pub(super) powers: Vec<Power>,
    pub(super) correlations: Correlations,
    /// Level and runs of the whole record.
    record: Option<(usize, &'a [SlowRun])>,
}

impl<'a> Sources<'a> {
    pub(super) fn collect(cascade: &'a Cascade, rate_hz: f64) -> Self {
        let levels = cascade.levels();
        let powers = levels.iter().map(|level| level.power()).collect();
        let record = levels
            .iter()
            .enumerate()
            .find_map(|(number, level)| level.history.runs().map(|runs| (number, runs)));
        Self {
            cascade,
            rate_hz,
            powers,
            correlations: Correlations::new(&cascade.plan().window),
            record,
        }
    }

    pub(super) fn level_rate_hz(&self, level: usize) -> f64 {
        self.rate_hz / (FACTOR as f64).powi(level as i32)
    }

    fn highest_bin(level: usize) -> usize {
        if level == 0 {
            HIGHEST_BIN
        } else {
            (PASS * LEN as f64) as usize
        }
    }

    /// Level whose segments serve `f_hz` best, if any has enough.
    fn level_for(&self, f_hz: f64, least_segments: u64, lowest_bin: usize) -> Option<usize> {
        (0..self.powers.len()).rev().find(|&level| {
            let bin = f_hz / self.level_rate_hz(level) * LEN as f64;
            self.powers[level].segments >= least_segments.max(1)
                && bin >= lowest_bin as f64 - 0.5
                && bin < Self::highest_bin(level) as f64 + 0.5
        })
    }

    /// Bins by descending frequency, as groups of neighbours from the same source.
    pub(super) fn groups(&self, settings: &Settings) -> Vec<Group> {
        let (longest_s, record_top_hz) = self.record.map_or((0.0, 0.0), |(level, runs)| {
            let longest = longest(runs);
            let top = if level == 0 { 0.49 } else { PASS };
            let rate_hz = self.level_rate_hz(level);
            (longest as f64 / rate_hz, top * rate_hz)
        });
        let mut plan: Vec<(Origin, Vec<(f64, f64)>)> = Vec::new();
        let ratio = (-1.0 / settings.bins_per_octave.max(0.1)).exp2();
        let mut upper = 0.5 * self.rate_hz;
        let lowest_hz = self.rate_hz / (self.cascade.next_index().max(1) as f64);
        while upper > lowest_hz {
            let lower = upper * ratio;
            let centre = (upper * lower).sqrt();
            let origin = self
                .level_for(centre, settings.segments, LOWEST_BIN)
                .map(|level| Origin::Segments { level })
                .or_else(|| {
                    (centre <= record_top_hz && centre * longest_s >= 0.9 * LOWEST_CYCLES)
                        .then_some(Origin::Record)
                })
                .or_else(|| {
                    self.level_for(centre, 1, LAST_RESORT_BIN)
                        .map(|level| Origin::Segments { level })
                });
            if let Some(origin) = origin {
                match plan.last_mut() {
                    Some((last, bands)) if *last == origin => bands.push((lower, upper)),
                    _ => plan.push((origin, vec![(lower, upper)])),
                }
            }
            upper = lower;
        }
        plan.into_iter()
            .rev()
            .map(|(origin, bands)| self.group(origin, &bands))
            .collect()
    }

    /// Fills bands (descending) with what their source has in them; empty ones vanish.
    fn group(&self, origin: Origin, bands: &[(f64, f64)]) -> Group {
        let top = bands.first().map_or(0.0, |band| band.1);
        match (origin, self.record) {
            (Origin::Record, Some((level, runs))) => {
                let rate_hz = self.level_rate_hz(level);
                let longest = longest(runs);
                let runs: Vec<Run> = runs
                    .iter()
                    .filter(|run| run.samples.len() * RUN_SHARE >= longest)
                    .map(|run| Run::new(&run.samples, top / rate_hz))
                    .collect();
                let bins = bands
                    .iter()
                    .rev()
                    .map(|&(lower, upper)| {
                        let mut members = Vec::new();
                        for (number, run) in runs.iter().enumerate() {
                            for (index, ordinate) in run.ordinates.iter().enumerate() {
                                let f_hz = run.cycles(ordinate) * rate_hz;
                                if f_hz > lower && f_hz <= upper {
                                    members.push((number, index));
                                }
                            }
                        }
                        members
                    })
                    .filter(|members| !members.is_empty())
                    .collect();
                Group::Record { level, runs, bins }
            }
            (Origin::Segments { level }, _) => Group::Level {
                level,
                bins: self.level_bins(level, bands),
            },
            (Origin::Record, None) => Group::Level {
                level: 0,
                bins: Vec::new(),
            },
        }
    }

    fn level_bins(&self, level: usize, bands: &[(f64, f64)]) -> Vec<RangeInclusive<usize>> {
        let per_hz = LEN as f64 / self.level_rate_hz(level);
        bands
            .iter()
            .rev()
            .filter_map(|&(lower, upper)| {
                let first = (lower * per_hz).floor() as usize + 1;
                let last = ((upper * per_hz).floor() as usize).min(Self::highest_bin(level));
                (first <= last).then_some(first.max(1)..=last)
            })
            .collect()
    }
}

/// Samples in the longest run.
fn longest(runs: &[SlowRun]) -> usize {
    runs.iter().map(|run| run.samples.len()).max().unwrap_or(0)
}
