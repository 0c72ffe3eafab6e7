//! How the bins vary together.
//!
//! For a Gaussian process whose spectrum is flat over a window's width, two tapered transforms
//! have a squared correlation that depends on their separation in time and frequency alone, and
//! averages add these up (Welch 1967; Percival and Walden 1993, section 6.17; Isserlis' theorem).
//! Within one level and among the ordinates of one run the sums are exact. Bins of different
//! sources meet only at the seams; there the long-record form
//! `cov = (1 / T) int G_a G_b df` over the normalised kernels serves, since one side has many
//! segments. The figures are relative: multiply by the expectations of both bins.

use super::{
    binning::Group,
    expected::Operator,
    segments::{HOP, LEN, Power},
    window::Window,
};
use std::ops::RangeInclusive;

/// Separations beyond this many bins of a segment are uncorrelated (below 1e-6).
const REACH: usize = 16;

/// Bins of a short segment on which its window still has weight, for the seams.
const SEAM: f64 = 3.0;

/// Steps a bin of the tabulated spectral window.
const STEPS: f64 = 64.0;

/// Symmetric matrix of covariances relative to the expectations.
#[derive(Debug, Clone, Default)]
pub struct Covariance {
    size: usize,
    values: Vec<f64>,
}

impl Covariance {
    /// Number of bins.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Covariance of two bins over the product of their expectations; zero outside the matrix.
    pub fn at(&self, one: usize, other: usize) -> f64 {
        self.values
            .get(one * self.size + other)
            .copied()
            .unwrap_or(0.0)
    }

    fn set(&mut self, one: usize, other: usize, value: f64) {
        self.values[one * self.size + other] = value;
        self.values[other * self.size + one] = value;
    }
}

/// What the covariance follows from.
pub(super) struct Input<'a> {
    pub(super) groups: &'a [Group],
    pub(super) powers: &'a [Power],
    pub(super) correlations: &'a Correlations,
    pub(super) operator: &'a Operator,
    pub(super) rate_hz: f64,
    pub(super) duration_s: f64,
}

/// Covariance of all bins.
pub(super) fn of(input: &Input<'_>) -> Covariance {
    let size = input.operator.rows().len();
    let mut covariance = Covariance {
        size,
        values: vec![0.0; size * size],
    };
    let mut first = 0;
    for group in input.groups {
        match group {
            Group::Level { level, bins } => {
                let power = &input.powers[*level];
                for (i, one) in bins.iter().enumerate() {
                    for (j, other) in bins.iter().enumerate().skip(i) {
                        if other.start() > &(one.end() + REACH) {
                            break;
                        }
                        let value = input.correlations.between(one, other, power);
                        covariance.set(first + i, first + j, value);
                    }
                }
                seam(input, &mut covariance, first, *level, bins);
                first += bins.len();
            }
            Group::Record { bins, .. } => {
                for (i, members) in bins.iter().enumerate() {
                    covariance.set(first + i, first + i, of_ordinates(members.len()));
                }
                first += bins.len();
            }
        }
    }
    covariance
}

/// Relative variances of all bins.
pub(super) fn variances(
    groups: &[Group],
    powers: &[Power],
    correlations: &Correlations,
) -> Vec<f64> {
    let mut variances = Vec::new();
    for group in groups {
        match group {
            Group::Level { level, bins } => {
                let power = &powers[*level];
                variances.extend(bins.iter().map(|ks| correlations.between(ks, ks, power)));
            }
            Group::Record { bins, .. } => {
                variances.extend(bins.iter().map(|members| of_ordinates(members.len())));
            }
        }
    }
    variances
}

/// What a taper does to covariances: squared correlations of the transforms of a segment, and of
/// neighbours, by distance in bins; and its spectral window.
pub(super) struct Correlations {
    same: Vec<f64>,
    neighbour: Vec<f64>,
    /// Squared transform over the sum of squares, in [`STEPS`] a bin up to [`SEAM`].
    power: Vec<f64>,
}

impl Correlations {
    pub(super) fn new(window: &Window) -> Self {
        let power = |step: usize| {
            let transform = window.transform(step as f64 / STEPS);
            transform * transform / window.sum_of_squares()
        };
        let table = |lag| {
            (0..=REACH)
                .map(|bins| window.correlation(lag, bins as f64))
                .collect()
        };
        Self {
            same: table(0),
            neighbour: table(HOP),
            power: (0..=(SEAM * STEPS) as usize + 1).map(power).collect(),
        }
    }

    /// Spectral window at a distance of at most [`SEAM`] bins.
    fn power(&self, bins: f64) -> f64 {
        let place = bins.abs() * STEPS;
        let step = place as usize;
        let part = place - step as f64;
        self.power[step] + part * (self.power[step + 1] - self.power[step])
    }

    fn between(
        &self,
        one: &RangeInclusive<usize>,
        other: &RangeInclusive<usize>,
        power: &Power,
    ) -> f64 {
        let (mut same, mut neighbour) = (0.0, 0.0);
        for k in one.clone() {
            for l in other.clone() {
                // A bin also meets the mirror image of the other at negative frequency.
                for distance in [k.abs_diff(l), k + l] {
                    if distance <= REACH {
                        same += self.same[distance];
                        neighbour += self.neighbour[distance];
                    }
                }
            }
        }
        let (segments, neighbours) = (power.segments as f64, power.neighbours as f64);
        let pairs = (one.clone().count() * other.clone().count()) as f64;
        (segments * same + 2.0 * neighbours * neighbour) / (pairs * segments * segments)
    }
}

/// Relative variance of the mean of ordinates of the cosine transform, which are independent and
/// have one degree of freedom each.
fn of_ordinates(count: usize) -> f64 {
    2.0 / count as f64
}

/// Covariances of a level's lowest bins with the bins below, which have another source: the
/// level's window taken at the nodes of theirs, which lie closer.
fn seam(
    input: &Input<'_>,
    covariance: &mut Covariance,
    first: usize,
    level: usize,
    bins: &[RangeInclusive<usize>],
) {
    let Some(lowest) = bins.first() else { return };
    let level_rate_hz = input.rate_hz / (super::decimate::FACTOR as f64).powi(level as i32);
    let bin_hz = level_rate_hz / LEN as f64;
    let start = *lowest.start() as f64;
    let nodes_hz = input.operator.nodes_hz();
    let rows = input.operator.rows();
    for (i, ks) in bins.iter().enumerate() {
        if *ks.start() as f64 > start + SEAM {
            break;
        }
        let scale = 1.0 / (ks.clone().count() as f64 * level_rate_hz);
        let density = |f_hz: f64| -> f64 {
            let place = f_hz / bin_hz;
            let near = ks.clone().filter(|&k| (k as f64 - place).abs() <= SEAM);
            let total: f64 = near
                .map(|k| input.correlations.power(place - k as f64))
                .sum();
            scale * total
        };
        let densities: Vec<f64> = nodes_hz.iter().map(|&f_hz| density(f_hz)).collect();
        for (j, row) in rows[..first].iter().enumerate() {
            let value: f64 = row
                .iter()
                .map(|&(node, weight)| weight * densities[node as usize])
                .sum();
            if value > 0.0 {
                covariance.set(first + i, j, value / input.duration_s);
            }
        }
    }
}
