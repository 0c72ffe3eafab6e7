//! From the cascade's sums to log-spaced bins with density, degrees of freedom and covariance.
//!
//! Each bin takes the source with the finest resolution among those that have seen enough of the
//! record ([`Settings::segments`]): a level's segments in the band where its decimators are flat,
//! or, below what segments reach, the cosine transform of the whole record.

use super::{
    cascade::Cascade,
    cosine::{LOWEST_CYCLES, Run},
    covariance::{self, Correlations, Covariance},
    decimate::{FACTOR, PASS},
    expected::{Operator, Path, SegmentWindows, level_kernels},
    history::SlowRun,
    quadrature::{Nodes, Peak},
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

/// How to bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Bins an octave.
    pub bins_per_octave: f64,
    /// Whole segments that a level must have for its bins to be preferred to coarser ones.
    pub segments: u64,
    /// Narrow features that expectations must resolve.
    pub peaks: Vec<Peak>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            bins_per_octave: 16.0,
            segments: 12,
            peaks: Vec::new(),
        }
    }
}

/// Where a bin's estimate comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Segments at the sample rate over `8^level`.
    Segments {
        /// Number of decimations.
        level: usize,
    },
    /// Cosine transforms of whole gap-free runs.
    Record,
}

/// One bin of the estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Bin {
    /// Mean frequency of what is averaged, hertz.
    pub f_hz: f64,
    /// Two-sided density, squared units of the samples per hertz.
    pub psd: f64,
    /// Degrees of freedom: `2 psd^2 / variance` for a spectrum that is flat over the bin.
    pub edf: f64,
    /// Where it comes from.
    pub origin: Origin,
}

/// Bins of an axis up to now, by ascending frequency, without what a fit needs: for display, at a
/// small part of the cost of an [`Estimate`].
pub fn bins(cascade: &Cascade, rate_hz: f64, settings: &Settings) -> Vec<Bin> {
    let sources = Sources::collect(cascade, rate_hz);
    sources.bins(&sources.groups(settings))
}

/// Spectrum of one axis up to now, by ascending frequency.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// The bins.
    pub bins: Vec<Bin>,
    /// Expectation of the bins under a model.
    pub operator: Operator,
    /// Covariance of the bins relative to their expectations.
    pub covariance: Covariance,
}

impl Estimate {
    /// Estimate from the cascade of an axis sampled at `rate_hz`; no bins if there are too few
    /// samples.
    pub fn new(cascade: &Cascade, rate_hz: f64, settings: &Settings) -> Self {
        Sources::collect(cascade, rate_hz).estimate(settings)
    }

    /// Densities for samples in counts of `units_per_count`.
    pub fn scale(&mut self, units_per_count: f64) {
        for bin in &mut self.bins {
            bin.psd *= units_per_count * units_per_count;
        }
    }

    /// Expectation of every bin under a model's two-sided density per hertz.
    pub fn expected(&self, density: impl Fn(f64) -> f64) -> Vec<f64> {
        self.operator.expected(density)
    }
}

/// What an estimate is made from.
pub(super) struct Sources<'a> {
    cascade: &'a Cascade,
    rate_hz: f64,
    powers: Vec<Power>,
    correlations: Correlations,
    /// Level and runs of the whole record.
    record: Option<(usize, &'a [SlowRun])>,
}

/// Bins of one source, in ascending order.
pub(super) enum Group {
    /// Bins of a level, each over some bins of its segments.
    Level {
        level: usize,
        bins: Vec<RangeInclusive<usize>>,
    },
    /// Bins over ordinates of runs: run and ordinate.
    Record {
        level: usize,
        runs: Vec<Run>,
        bins: Vec<Vec<(usize, usize)>>,
    },
}

impl<'a> Sources<'a> {
    fn collect(cascade: &'a Cascade, rate_hz: f64) -> Self {
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

    fn level_rate_hz(&self, level: usize) -> f64 {
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
    fn groups(&self, settings: &Settings) -> Vec<Group> {
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

    fn bins(&self, groups: &[Group]) -> Vec<Bin> {
        let mut bins = Vec::new();
        for group in groups {
            match group {
                Group::Level { level, bins: ks } => self.level_densities(*level, ks, &mut bins),
                Group::Record {
                    level,
                    runs,
                    bins: members,
                } => {
                    self.record_densities(*level, runs, members, &mut bins);
                }
            }
        }
        let variances = covariance::variances(groups, &self.powers, &self.correlations);
        for (bin, variance) in bins.iter_mut().zip(variances) {
            bin.edf = 2.0 / variance;
        }
        bins
    }

    fn estimate(&self, settings: &Settings) -> Estimate {
        let groups = self.groups(settings);
        let bins = self.bins(&groups);
        let mut operator = Operator::default();
        for group in &groups {
            let first = operator.rows().len();
            let (level, count) = match group {
                Group::Level { level, bins } => (*level, bins.len()),
                Group::Record { level, bins, .. } => (*level, bins.len()),
            };
            let centres: Vec<f64> = bins[first..first + count]
                .iter()
                .map(|bin| bin.f_hz)
                .collect();
            let path = Path::new(self.rate_hz, level);
            let (nodes_hz, kernels) = match group {
                Group::Level { bins, .. } => self.level_kernels(&path, bins, settings),
                Group::Record { runs, bins, .. } => record_kernels(&path, runs, bins, settings),
            };
            operator.add(&nodes_hz, &kernels, &centres);
            operator.add_aliases(first, &centres, &path);
        }
        let covariance = covariance::of(&covariance::Input {
            groups: &groups,
            powers: &self.powers,
            correlations: &self.correlations,
            operator: &operator,
            rate_hz: self.rate_hz,
            duration_s: self.cascade.samples() as f64 / self.rate_hz,
        });
        Estimate {
            bins,
            operator,
            covariance,
        }
    }

    fn level_densities(&self, level: usize, ks: &[RangeInclusive<usize>], bins: &mut Vec<Bin>) {
        let (window, power) = (&self.cascade.plan().window, &self.powers[level]);
        let rate_hz = self.level_rate_hz(level);
        let bin_hz = rate_hz / LEN as f64;
        let scale = 1.0 / (power.segments as f64 * window.sum_of_squares() * rate_hz);
        for range in ks {
            let count = range.clone().count() as f64;
            let total: f64 = range.clone().map(|k| power.at(k)).sum();
            bins.push(Bin {
                f_hz: 0.5 * (range.start() + range.end()) as f64 * bin_hz,
                psd: total * scale / count,
                edf: 0.0,
                origin: Origin::Segments { level },
            });
        }
    }

    fn record_densities(
        &self,
        level: usize,
        runs: &[Run],
        members: &[Vec<(usize, usize)>],
        bins: &mut Vec<Bin>,
    ) {
        let rate_hz = self.level_rate_hz(level);
        for members in members {
            let mean = |value: &dyn Fn(&Run, usize) -> f64| -> f64 {
                let values = members.iter().map(|&(run, index)| value(&runs[run], index));
                values.sum::<f64>() / members.len() as f64
            };
            bins.push(Bin {
                f_hz: rate_hz * mean(&|run, index| run.cycles(&run.ordinates[index])),
                psd: mean(&|run, index| run.ordinates[index].power) / rate_hz,
                edf: 0.0,
                origin: Origin::Record,
            });
        }
    }

    fn level_kernels(
        &self,
        path: &Path,
        ks: &[RangeInclusive<usize>],
        settings: &Settings,
    ) -> (Vec<f64>, Vec<Vec<f64>>) {
        let nodes = Nodes::new(LEN / 2, path.level_rate_hz() / LEN as f64, &settings.peaks);
        let windows = SegmentWindows::new(&self.cascade.plan().window, &nodes.offsets);
        level_kernels(&windows, &nodes, path, ks)
    }
}

/// Samples in the longest run.
fn longest(runs: &[SlowRun]) -> usize {
    runs.iter().map(|run| run.samples.len()).max().unwrap_or(0)
}

/// Kernels of bins over the ordinates of runs: frequencies and `[bin][node]`.
fn record_kernels(
    path: &Path,
    runs: &[Run],
    bins: &[Vec<(usize, usize)>],
    settings: &Settings,
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut nodes_hz = Vec::new();
    let mut kernels = vec![Vec::new(); bins.len()];
    for (number, run) in runs.iter().enumerate() {
        let bin_hz = run.bin() * path.level_rate_hz();
        let nodes = Nodes::new(run.near_bins(), bin_hz, &settings.peaks);
        let far = run.far_panels();
        let centres: Vec<f64> = far.iter().map(|&(centre, _)| centre).collect();
        let (near, distant) = (run.windows(&nodes), run.mean_windows(&centres));
        let places = nodes
            .nodes
            .iter()
            .map(|node| (nodes.place(node), node.weight));
        let shares: Vec<(f64, f64)> = places
            .chain(far.iter().copied())
            .map(|(place, width)| (place, width * path.response(place * bin_hz).powi(2)))
            .collect();
        for (kernel, members) in kernels.iter_mut().zip(bins) {
            let from = kernel.len();
            kernel.resize(from + shares.len(), 0.0);
            for &(_, index) in members.iter().filter(|(of_run, _)| *of_run == number) {
                let share = 1.0 / members.len() as f64;
                let windows = near[index].iter().chain(&distant[index]);
                let kernel = kernel[from..].iter_mut();
                for ((total, (_, gain)), window) in kernel.zip(&shares).zip(windows) {
                    *total += share * gain * window;
                }
            }
        }
        nodes_hz.extend(shares.iter().map(|(place, _)| place * bin_hz));
    }
    (nodes_hz, kernels)
}
