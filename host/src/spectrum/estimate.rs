//! From the cascade's sums to log-spaced bins with density, degrees of freedom and covariance.

use super::{
    binning::{Group, Origin, Settings},
    cascade::Cascade,
    cosine::{Ordinate, Run},
    covariance::{self, Covariance},
    expected::{Operator, Path, SegmentWindows, level_kernels},
    gather::Gathering,
    quadrature::{Nodes, Place},
    segments::LEN,
    sources::Sources,
};
use std::ops::RangeInclusive;

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

impl Sources<'_> {
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
            let (level, count) = (group.level(), group.len());
            let centres: Vec<f64> = bins[first..first + count]
                .iter()
                .map(|bin| bin.f_hz)
                .collect();
            let path = Path::new(self.rate_hz, level);
            let (places, kernels) = match group {
                Group::Level { bins, .. } => self.level_kernels(&path, bins),
                Group::Record { runs, bins, .. } => record_kernels(&path, runs, bins),
            };
            operator.add(&places, &kernels, &centres);
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
    ) -> (Vec<Place>, Vec<Vec<f64>>) {
        let nodes = Nodes::new(LEN / 2);
        let windows = SegmentWindows::new(&self.cascade.plan().window, &nodes.offsets);
        level_kernels(&windows, &nodes, path, ks)
    }
}

/// Kernels of bins over the ordinates of runs: places and `[bin][node]`.
fn record_kernels(
    path: &Path,
    runs: &[Run],
    bins: &[Vec<(usize, usize)>],
) -> (Vec<Place>, Vec<Vec<f64>>) {
    let mut all = Vec::new();
    let mut kernels = vec![Vec::new(); bins.len()];
    for (number, run) in runs.iter().enumerate() {
        let bin_hz = run.bin() * path.level_rate_hz();
        let nodes = Nodes::new(run.near_bins());
        let far = run.far_panels();
        let centres: Vec<f64> = far.iter().map(|&(centre, _)| centre).collect();
        let windowed = run.places(&nodes, &centres);
        let places = nodes
            .nodes
            .iter()
            .map(|node| (nodes.place(node), node.weight));
        let shares: Vec<f64> = places
            .chain(far.iter().copied())
            .map(|(place, width)| width * path.response(place * bin_hz).powi(2))
            .collect();
        let gathering = Gathering::new(run.near_bins());
        for (kernel, members) in kernels.iter_mut().zip(bins) {
            let own = members.iter().filter(|(of_run, _)| *of_run == number);
            let own: Vec<&Ordinate> = own.map(|(_, index)| &run.ordinates[*index]).collect();
            let mut weights = vec![0.0; shares.len()];
            let share = 1.0 / members.len() as f64;
            for ordinate in &own {
                let windows = run.windows(ordinate, &windowed);
                for ((total, gain), window) in weights.iter_mut().zip(&shares).zip(windows) {
                    *total += share * gain * window;
                }
            }
            let (near, far) = weights.split_at(nodes.nodes.len());
            kernel.extend(gathering.gather(near));
            kernel.extend(far);
        }
        all.extend(gathering.places(bin_hz));
        all.extend(far.iter().map(|(centre, _)| Place {
            f_hz: centre * bin_hz,
            of: None,
        }));
    }
    (all, kernels)
}
