//! The lowest frequencies: sine multitapers over whole gap-free runs.
//!
//! Where the record holds only a few segments, tapering each alone would throw away up to 40 % of
//! the information, and the lowest frequencies would be those of a segment, not of the record.
//! Instead the decimated record as a whole is seen through `K` orthogonal tapers
//! `h_k[n] = sqrt(2 / A) sin(pi k n / A)`, `n = 1..A-1`, `A` = length + 1 (Riedel and Sidorenko
//! 1995): `K / (K + 1/2)` of the information, a window about `(K + 1) / A` wide. `K` grows with
//! frequency from 1 at two cycles a run to [`MOST_TAPERS`]. A straight line is fitted and taken
//! out first; what that costs the lowest ordinates is part of their known response.
//!
//! Since a sine is the difference of two exponentials, every taper's transform is the difference
//! of two points of one zero-padded transform.

use super::quadrature::Nodes;
use rustfft::{FftPlanner, num_complex::Complex64};
use std::f64::consts::PI;

/// Most tapers at one frequency.
pub const MOST_TAPERS: usize = 8;

/// Lowest ordinate, cycles a run.
pub const LOWEST_CYCLES: f64 = 2.0;

/// Bins beyond the highest ordinate that responses are evaluated in at every node.
const NEAR: usize = 100;

/// Estimate at one frequency from one run.
#[derive(Debug, Clone)]
pub struct Ordinate {
    /// Frequency in half bins: `half_bins / (2 A)` cycles per sample of the level.
    pub half_bins: usize,
    /// Tapers.
    pub tapers: usize,
    /// Mean of the tapers' squared transforms: power per cycle per sample of the level.
    pub power: f64,
    /// What each taper makes of a constant and of a line, both of unit norm.
    trend: Vec<[Complex64; 2]>,
}

/// A gap-free run through the tapers.
#[derive(Debug, Clone)]
pub struct Run {
    /// Samples in it.
    pub len: usize,
    /// The ordinates, by frequency.
    pub ordinates: Vec<Ordinate>,
}

impl Run {
    /// Ordinates of `samples` up to `highest` cycles per sample.
    pub fn new(samples: &[f64], highest: f64) -> Self {
        let len = samples.len();
        let denominator = (len + 1) as f64;
        let mut grid = Vec::new();
        let mut cycles = LOWEST_CYCLES;
        while cycles <= highest * denominator {
            let tapers = ((cycles - 1.0) as usize).clamp(1, MOST_TAPERS);
            grid.push(((2.0 * cycles).round() as usize, tapers));
            // Half the width of the window: every frequency is seen twice.
            cycles += 0.5 * (tapers + 1) as f64;
        }
        let (constant, line) = trend_basis(len);
        let project =
            |basis: &[f64]| -> f64 { basis.iter().zip(samples).map(|(b, x)| b * x).sum() };
        let (level, slope) = (project(&constant), project(&line));
        let residual: Vec<f64> = samples
            .iter()
            .zip(constant.iter().zip(&line))
            .map(|(x, (c, l))| x - level * c - slope * l)
            .collect();
        let mut planner = FftPlanner::new();
        let fft = planner.plan_fft_forward(2 * (len + 1));
        let transform = |values: &[f64]| {
            let mut padded = vec![Complex64::default(); 2 * (len + 1)];
            for (z, x) in padded[1..].iter_mut().zip(values) {
                z.re = *x;
            }
            fft.process(&mut padded);
            padded
        };
        let (data, constant, line) = (transform(&residual), transform(&constant), transform(&line));
        let tapered = |z: &[Complex64], half_bins: usize, taper: usize| {
            let period = z.len();
            let below = z[(half_bins + period - taper) % period];
            let above = z[(half_bins + taper) % period];
            (below - above) * Complex64::new(0.0, -0.5) * (2.0 / denominator).sqrt()
        };
        let ordinates = grid
            .into_iter()
            .map(|(half_bins, tapers)| Ordinate {
                half_bins,
                tapers,
                power: (1..=tapers)
                    .map(|k| tapered(&data, half_bins, k).norm_sqr())
                    .sum::<f64>()
                    / tapers as f64,
                trend: (1..=tapers)
                    .map(|k| {
                        [
                            tapered(&constant, half_bins, k),
                            tapered(&line, half_bins, k),
                        ]
                    })
                    .collect(),
            })
            .collect();
        Self { len, ordinates }
    }

    /// Frequency of an ordinate, cycles per sample of the level.
    pub fn cycles(&self, ordinate: &Ordinate) -> f64 {
        ordinate.half_bins as f64 / (2 * (self.len + 1)) as f64
    }

    /// Width of a bin, cycles per sample of the level.
    pub fn bin(&self) -> f64 {
        1.0 / (self.len + 1) as f64
    }

    /// Bins that need nodes of their own for ordinates up to the highest.
    pub fn near_bins(&self) -> usize {
        let highest = self.ordinates.last().map_or(0, |last| last.half_bins / 2);
        (highest + NEAR).min(self.len.div_ceil(2))
    }

    /// Panels beyond [`Self::near_bins`] that the far side lobes are summed over: centre and
    /// width in bins, growing by a twentieth.
    pub fn far_panels(&self) -> Vec<(f64, f64)> {
        let end = 0.5 * (self.len + 1) as f64;
        let mut from = self.near_bins() as f64;
        let mut panels = Vec::new();
        while from < end {
            let width = (0.05 * from).max(1.0).min(end - from);
            panels.push((from + 0.5 * width, width));
            from += width;
        }
        panels
    }

    /// Spectral windows (both signs of frequency together, per bin) of all ordinates at all
    /// nodes: `[ordinate][node]`.
    pub fn windows(&self, nodes: &Nodes) -> Vec<Vec<f64>> {
        let highest = self.ordinates.last().map_or(0, |last| last.half_bins);
        // Exponential sums at offset + m / 2 bins, m from -span.
        let span = highest + MOST_TAPERS + 2;
        let panels = nodes.nodes.iter().map(|node| node.panel).max().unwrap_or(0);
        let count = 2 * span + 2 * panels + 2;
        let tables: Vec<Vec<Complex64>> = nodes
            .offsets
            .iter()
            .map(|&offset| {
                let place = |m: usize| offset + 0.5 * (m as f64 - span as f64);
                (0..count).map(|m| self.exponential_sum(place(m))).collect()
            })
            .collect();
        let trends: Vec<[Complex64; 2]> = nodes
            .nodes
            .iter()
            .map(|node| self.trend_response(nodes.place(node)))
            .collect();
        self.ordinates
            .iter()
            .map(|ordinate| {
                let places = nodes.nodes.iter().zip(&trends);
                places
                    .map(|(node, trend)| {
                        let table = &tables[node.offset];
                        let near = span + 2 * node.panel - ordinate.half_bins;
                        let far = span + 2 * node.panel + ordinate.half_bins;
                        self.window(ordinate, trend, |taper| {
                            [
                                table[near + taper] - table[near - taper],
                                table[far - taper] - table[far + taper],
                            ]
                        })
                    })
                    .collect()
            })
            .collect()
    }

    /// Mean spectral window of an ordinate over the bin around `centre`.
    pub fn mean_window(&self, ordinate: &Ordinate, centre: f64) -> f64 {
        let frequency = 0.5 * ordinate.half_bins as f64;
        let points = 6;
        let total: f64 = (0..points)
            .map(|point| {
                let x = centre + (f64::from(point) + 0.5) / f64::from(points) - 0.5;
                self.window(ordinate, &self.trend_response(x), |taper| {
                    let half = 0.5 * taper as f64;
                    let difference = |place: f64, half: f64| {
                        self.exponential_sum(place + half) - self.exponential_sum(place - half)
                    };
                    [
                        difference(x - frequency, half),
                        difference(x + frequency, -half),
                    ]
                })
            })
            .sum();
        total / f64::from(points)
    }

    /// Spectral window at `x` bins from the trend's response there and each taper's differences
    /// of exponential sums, at `x - f` (for positive frequency) and, conjugate, at `x + f` (for
    /// negative: the sum at `-y` is the conjugate of that at `y`).
    fn window(
        &self,
        ordinate: &Ordinate,
        trend: &[Complex64; 2],
        differences: impl Fn(usize) -> [Complex64; 2],
    ) -> f64 {
        let scale = Complex64::new(0.0, -0.5) * (2.0 * self.bin()).sqrt();
        let mut total = 0.0;
        for (index, [constant, line]) in ordinate.trend.iter().enumerate() {
            let [positive, negative] = differences(index + 1);
            let left = |difference: Complex64, trend: [Complex64; 2]| {
                (scale * difference - trend[0] * constant - trend[1] * line).norm_sqr()
            };
            total += left(positive, *trend) + left(negative.conj(), trend.map(|z| z.conj()));
        }
        total * self.bin() / ordinate.tapers as f64
    }

    /// Covariance of two ordinates relative to the product of their expectations, for a spectrum
    /// that is flat over their windows.
    pub fn relative_covariance(&self, one: &Ordinate, other: &Ordinate) -> f64 {
        let mut total = 0.0;
        for separation in [
            one.half_bins as f64 - other.half_bins as f64,
            (one.half_bins + other.half_bins) as f64,
        ] {
            let y = 0.5 * separation;
            if y.abs() > 2.0 * (MOST_TAPERS + 1) as f64 {
                continue;
            }
            for k in 1..=one.tapers {
                for l in 1..=other.tapers {
                    let (a, b) = (0.5 * (k as f64 - l as f64), 0.5 * (k + l) as f64);
                    let sum = self.exponential_sum(y + a) + self.exponential_sum(y - a)
                        - self.exponential_sum(y + b)
                        - self.exponential_sum(y - b);
                    total += (0.5 * self.bin() * sum).norm_sqr();
                }
            }
        }
        total / (one.tapers * other.tapers) as f64
    }

    /// `sum exp(2 pi i y n / A)` over `n = 0..A`.
    fn exponential_sum(&self, y: f64) -> Complex64 {
        let terms = (self.len + 1) as f64;
        let denominator = (PI * y / terms).sin();
        if denominator.abs() < 1e-12 {
            return Complex64::new(terms, 0.0);
        }
        Complex64::from_polar((PI * y).sin() / denominator, PI * y * (terms - 1.0) / terms)
    }

    /// Projections of `exp(2 pi i x n / A)`, `n = 1..A`, on constant and line of unit norm.
    fn trend_response(&self, x: f64) -> [Complex64; 2] {
        let len = self.len as f64;
        let theta = 2.0 * PI * x * self.bin();
        let phase = Complex64::from_polar(1.0, theta * 0.5 * (len + 1.0));
        let (sin_all, cos_all) = (0.5 * len * theta).sin_cos();
        let (sin_one, cos_one) = (0.5 * theta).sin_cos();
        let sum = sin_all / sin_one;
        let slope = (0.5 * len * cos_all * sin_one - 0.5 * sin_all * cos_one) / (sin_one * sin_one);
        let norm = (len * (len * len - 1.0) / 12.0).sqrt();
        [
            phase * (sum / len.sqrt()),
            phase * Complex64::new(0.0, -slope / norm),
        ]
    }
}

/// Constant and centred line over `len` samples, of unit norm.
fn trend_basis(len: usize) -> (Vec<f64>, Vec<f64>) {
    let n = len as f64;
    let norm = (n * (n * n - 1.0) / 12.0).sqrt();
    let centre = 0.5 * (n - 1.0);
    (
        vec![1.0 / n.sqrt(); len],
        (0..len).map(|i| (i as f64 - centre) / norm).collect(),
    )
}
