//! What the estimates are expected to be under a model: a linear operator on its spectrum.
//!
//! For a stationary process with two-sided density `S` of its *samples*, a bin's expectation is
//! exactly `int_0^{fs/2} S(f) G(f) df`, where the bin's kernel `G` holds the taper's spectral
//! window (both signs of frequency, straight line removed), the squared response of the decimators
//! in front of the level, and what they let fold in from above. [`Operator`] keeps `G` at
//! quadrature nodes, so that each new model costs one evaluation a node and one sparse product.
//! Fits should do what depends on frequency alone (a signal chain) once, at [`Operator::nodes_hz`].

use super::{
    decimate::{Decimator, FACTOR},
    quadrature::{Nodes, Panel, Place},
    segments::LEN,
    window::Window,
};
use crate::numeric::peak::Peak;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Entries whose share of the bin is below this for any spectrum between 1/f^2 and f^2 are left
/// out.
const NEGLIGIBLE: f64 = 1e-9;

/// Densities that one pass over the rows sums up: the five terms and a few laws, in one or two of the processor's widest
/// registers.
const ABREAST: usize = 8;

/// Rows of kernel weights over common nodes.
#[derive(Debug, Clone, Default)]
pub struct Operator {
    nodes_hz: Vec<f64>,
    /// The panel of each node, and which of its nodes it is.
    panels: Vec<Option<(Panel, usize)>>,
    /// For each bin, node and weight.
    rows: Vec<Vec<(u32, f64)>>,
}

impl Operator {
    /// Frequencies at which a model's density is needed, hertz, all positive.
    pub fn nodes_hz(&self) -> &[f64] {
        &self.nodes_hz
    }

    /// For each bin, the nodes (index into [`Self::nodes_hz`]) and weights that make its
    /// expectation.
    pub fn rows(&self) -> &[Vec<(u32, f64)>] {
        &self.rows
    }

    /// Expectation of every bin for a two-sided density per hertz.
    pub fn expected(&self, density: impl Fn(f64) -> f64) -> Vec<f64> {
        let densities: Vec<f64> = self.nodes_hz.iter().map(|&f_hz| density(f_hz)).collect();
        self.apply(&densities)
    }

    /// Expectation of every bin from the densities at [`Self::nodes_hz`]; missing ones count as
    /// zero.
    pub fn apply(&self, densities: &[f64]) -> Vec<f64> {
        self.rows
            .iter()
            .map(|row| {
                row.iter()
                    .map(|&(node, weight)| weight * densities.get(node as usize).unwrap_or(&0.0))
                    .sum()
            })
            .collect()
    }

    /// The same for several at once, which reads the rows once for every eight of them.
    pub fn apply_all(&self, densities: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let blocks = densities.chunks(ABREAST);
        blocks.flat_map(|block| self.apply_block(block)).collect()
    }

    /// The same for at most [`ABREAST`].
    fn apply_block(&self, densities: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut nodes = vec![[0.0; ABREAST]; self.nodes_hz.len()];
        for (place, densities) in densities.iter().enumerate() {
            let pairs = nodes.iter_mut().zip(densities);
            pairs.for_each(|(node, density)| node[place] = *density);
        }
        let sums_of = |row: &Vec<(u32, f64)>| {
            let mut sums = [0.0; ABREAST];
            for &(node, weight) in row {
                let pairs = sums.iter_mut().zip(&nodes[node as usize]);
                pairs.for_each(|(sum, density)| *sum += weight * density);
            }
            sums
        };
        let sums: Vec<[f64; ABREAST]> = self.rows.iter().map(sums_of).collect();
        let places = 0..densities.len();
        let column = |place: usize| sums.iter().map(|sums| sums[place]).collect();
        places.map(column).collect()
    }

    /// Puts a `density` that has this peak into the `densities` at [`Self::nodes_hz`], where nodes stand too far from each
    /// other to see it.
    pub fn resolve(&self, densities: &mut [f64], peak: &Peak, density: impl Fn(f64) -> f64) {
        let mut last: Option<(Panel, [f64; 6])> = None;
        for (value, of) in densities.iter_mut().zip(&self.panels) {
            let Some((panel, node)) = of.filter(|(panel, _)| panel.hides(peak)) else {
                continue;
            };
            let spread = match last {
                Some((known, spread)) if known == panel => spread,
                _ => panel.spread(peak, &density),
            };
            last = Some((panel, spread));
            *value = spread[node];
        }
    }

    /// Adds the bins of one source: `kernels[bin][node]` at these places, with the bins' centres to judge by what is
    /// negligible.
    pub(super) fn add(&mut self, places: &[Place], kernels: &[Vec<f64>], centres_hz: &[f64]) {
        let mut place = vec![None; places.len()];
        for (kernel, centre_hz) in kernels.iter().zip(centres_hz) {
            let mut row = Vec::new();
            for (node, (&weight, &Place { f_hz, of })) in kernel.iter().zip(places).enumerate() {
                let ratio = f_hz / centre_hz;
                let steep = (ratio * ratio).max(1.0 / (ratio * ratio));
                if weight.abs() * steep > NEGLIGIBLE {
                    let at = *place[node].get_or_insert_with(|| {
                        self.nodes_hz.push(f_hz);
                        self.panels.push(of);
                        self.nodes_hz.len() as u32 - 1
                    });
                    row.push((at, weight));
                }
            }
            self.rows.push(row);
        }
    }

    /// Adds to the last bins, `from` on, what the decimators fold in: the bin's centre mirrored
    /// about multiples of each stage's output rate, with the response there.
    pub(super) fn add_aliases(&mut self, from: usize, centres_hz: &[f64], path: &Path) {
        for (row, &centre_hz) in self.rows[from..].iter_mut().zip(centres_hz) {
            for image_hz in path.images(centre_hz) {
                let gain = path.response(image_hz);
                let weight = gain * gain;
                let ratio = image_hz / centre_hz;
                if weight * ratio * ratio > NEGLIGIBLE {
                    row.push((self.nodes_hz.len() as u32, weight));
                    self.nodes_hz.push(image_hz);
                    self.panels.push(None);
                }
            }
        }
    }
}

/// What lies between the samples and a level: as many decimators as its number says.
#[derive(Debug, Clone)]
pub struct Path {
    decimator: Decimator,
    rate_hz: f64,
    level: usize,
}

impl Path {
    /// Path from samples at `rate_hz` to `level`.
    pub fn new(rate_hz: f64, level: usize) -> Self {
        Self {
            decimator: Decimator::default(),
            rate_hz,
            level,
        }
    }

    /// Rate of the level, hertz.
    pub fn level_rate_hz(&self) -> f64 {
        self.rate_hz / (FACTOR as f64).powi(self.level as i32)
    }

    /// Amplitude response of all decimators at a frequency of the samples.
    pub fn response(&self, f_hz: f64) -> f64 {
        let mut cycles = f_hz / self.rate_hz;
        let mut gain = 1.0;
        for _ in 0..self.level {
            gain *= self.decimator.response(cycles);
            cycles *= FACTOR as f64;
        }
        gain
    }

    /// Frequencies that fold onto `f_hz` at the last step of some decimator.
    fn images(&self, f_hz: f64) -> Vec<f64> {
        let mut images = Vec::new();
        let mut input_hz = self.rate_hz;
        for _ in 0..self.level {
            let output_hz = input_hz / FACTOR as f64;
            for multiple in 1..=FACTOR / 2 {
                for image_hz in [
                    multiple as f64 * output_hz - f_hz,
                    multiple as f64 * output_hz + f_hz,
                ] {
                    if image_hz < 0.5 * input_hz {
                        images.push(image_hz);
                    }
                }
            }
            input_hz = output_hz;
        }
        images
    }
}

/// Spectral windows of the segments: the taper's transform at nodes, about bins, less what the
/// straight line takes that is removed from every segment.
pub(super) struct SegmentWindows {
    /// For each offset, transforms of the taper (real) and of the taper times a line (imaginary)
    /// at whole bins plus the offset.
    tables: Vec<[Vec<f64>; 2]>,
    /// Both at whole bins, over their own norms.
    trend: [Vec<f64>; 2],
    scale: f64,
}

impl SegmentWindows {
    pub(super) fn new(window: &Window, offsets: &[f64]) -> Self {
        let fft = crate::fft::forward(LEN);
        let transform = |weights: &[f64], offset: f64| -> Vec<Complex64> {
            let mut z: Vec<Complex64> = (0..LEN)
                .map(|n| {
                    let turn = 2.0 * PI * offset * (n as f64 - HALF) / LEN as f64;
                    Complex64::from_polar(1.0, -turn) * weights[n]
                })
                .collect();
            fft.process(&mut z);
            // Centring the taper turns bin m by half a cycle m times.
            for odd in z.iter_mut().skip(1).step_by(2) {
                *odd = -*odd;
            }
            z
        };
        let both = |offset: f64| -> [Vec<f64>; 2] {
            [
                transform(window.values(), offset)
                    .iter()
                    .map(|z| z.re)
                    .collect(),
                transform(window.line(), offset)
                    .iter()
                    .map(|z| z.im)
                    .collect(),
            ]
        };
        let [mut mean, mut slope] = both(0.0);
        mean.iter_mut().for_each(|w| *w /= window.sum());
        slope.iter_mut().for_each(|w| *w /= window.sum_of_line());
        Self {
            tables: offsets.iter().map(|&offset| both(offset)).collect(),
            trend: [mean, slope],
            scale: 1.0 / (LEN as f64 * window.sum_of_squares()),
        }
    }

    /// Window of bin `k`, per bin, at `panel + offsets[offset]` bins, both signs of frequency.
    pub(super) fn at(&self, k: usize, panel: usize, offset: usize) -> f64 {
        let [taper, line] = &self.tables[offset];
        let mean = taper[panel] * self.trend[0][k];
        let slope = line[panel] * self.trend[1][k];
        // The line's transform is odd: it changes sign with the frequency.
        let positive = taper[(panel + LEN - k) % LEN] - mean - slope;
        let negative = taper[(panel + k) % LEN] - mean + slope;
        (positive * positive + negative * negative) * self.scale
    }
}

/// Half a segment.
const HALF: f64 = (LEN / 2) as f64;

/// Kernels of bins of a level, each the mean over the segments' bins `ks`: `[bin][node]`.
pub(super) fn level_kernels(
    windows: &SegmentWindows,
    nodes: &Nodes,
    path: &Path,
    bins: &[std::ops::RangeInclusive<usize>],
) -> (Vec<Place>, Vec<Vec<f64>>) {
    let bin_hz = path.level_rate_hz() / LEN as f64;
    let places: Vec<Place> = nodes.places(bin_hz).collect();
    let gains: Vec<f64> = places
        .iter()
        .zip(&nodes.nodes)
        .map(|(place, node)| path.response(place.f_hz).powi(2) * node.weight)
        .collect();
    let kernels = bins
        .iter()
        .map(|ks| {
            let count = ks.clone().count().max(1) as f64;
            nodes
                .nodes
                .iter()
                .zip(&gains)
                .map(|(node, gain)| {
                    let total: f64 = ks
                        .clone()
                        .map(|k| windows.at(k, node.panel, node.offset))
                        .sum();
                    total / count * gain
                })
                .collect()
        })
        .collect();
    (places, kernels)
}
