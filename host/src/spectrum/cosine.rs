//! The lowest frequencies: the cosine transform of whole gap-free runs.
//!
//! Where the record holds only a few segments, tapering each alone would throw away up to 40 % of
//! the information, and the lowest frequencies would be those of a segment, not of the record. The
//! cosine transform of the decimated record as a whole,
//! `c_k = sqrt(2 / M) sum x[n] cos(pi k (n + 1/2) / M)` at the frequencies `k / 2M`, loses nothing:
//! it is orthogonal, so that white noise gives independent ordinates, and since its basis
//! functions are flat at both ends the ordinates of a random walk are independent as well, whose
//! mean-free form it diagonalises exactly (its increments see sines, which are orthogonal). Each
//! `c_k^2` follows the chi-squared law of one degree of freedom. A straight line is fitted and
//! taken out first: that costs the first ordinate, and what it changes in the others (11 % in the
//! third for a walk) is part of their known response.
//!
//! What the ends cost: a window falls with the square of the distance in frequency, so that a
//! spectrum that rises with the square of frequency leaves a floor in the lowest ordinates, known
//! but there. Segments, which see everything from a few hundred cycles a record on, are tapered.

use super::quadrature::Nodes;
use rustfft::{FftPlanner, num_complex::Complex64};
use std::f64::consts::PI;

/// Lowest ordinate, half cycles a run: the first is nearly all straight line.
const LOWEST: usize = 2;

/// Lowest ordinate, cycles a run.
pub const LOWEST_CYCLES: f64 = 0.5 * LOWEST as f64;

/// Bins beyond the highest ordinate that responses are evaluated in at every node.
const NEAR: usize = 100;

/// Places within a bin over which [`Run::windows`] averages where they are far.
const PLACES: usize = 6;

/// Estimate at one frequency from one run.
#[derive(Debug, Clone)]
pub struct Ordinate {
    /// Frequency in half bins: `half_bins / 2M` cycles per sample of the level.
    pub half_bins: usize,
    /// Squared transform: power per cycle per sample of the level.
    pub power: f64,
    /// What the transform makes of a line of unit norm.
    line: f64,
}

/// A gap-free run, transformed.
#[derive(Debug, Clone)]
pub struct Run {
    /// Samples in it, `M`.
    pub len: usize,
    /// The ordinates, by frequency.
    pub ordinates: Vec<Ordinate>,
}

/// Everything about one frequency `u` (bins) that windows of all ordinates share.
struct Place {
    /// `sin(pi u / M)`.
    sine: f64,
    /// `sin(pi u)` for even ordinates, `cos(pi u)` for odd ones.
    turn: [f64; 2],
    /// What a line of unit norm makes of `sin(2 pi x (n - centre))`.
    line: f64,
}

/// Frequencies at which the windows of all ordinates of a run are wanted.
pub struct Places {
    nodes: Vec<Place>,
    /// [`PLACES`] for each bin.
    far: Vec<Place>,
}

impl Run {
    /// Ordinates of `samples` up to `highest` cycles per sample.
    pub fn new(samples: &[f64], highest: f64) -> Self {
        let len = samples.len();
        let line = line(len);
        let mean = samples.iter().sum::<f64>() / len as f64;
        let slope: f64 = line.iter().zip(samples).map(|(l, x)| l * (x - mean)).sum();
        let residual = samples.iter().zip(&line).map(|(x, l)| x - mean - slope * l);
        let powers = transform(residual, len);
        let lines = transform(line.iter().copied(), len);
        let last = ((2.0 * highest * len as f64) as usize).min(len.saturating_sub(1));
        let ordinates = (LOWEST..=last)
            .map(|k| Ordinate {
                half_bins: k,
                power: powers[k] * powers[k],
                line: lines[k],
            })
            .collect();
        Self { len, ordinates }
    }

    /// Frequency of an ordinate, cycles per sample of the level.
    pub fn cycles(&self, ordinate: &Ordinate) -> f64 {
        ordinate.half_bins as f64 / (2 * self.len) as f64
    }

    /// Width of a bin, cycles per sample of the level.
    pub fn bin(&self) -> f64 {
        1.0 / self.len as f64
    }

    /// Bins that need nodes of their own for ordinates up to the highest.
    pub fn near_bins(&self) -> usize {
        let highest = self.ordinates.last().map_or(0, |last| last.half_bins / 2);
        (highest + NEAR).min(self.len / 2)
    }

    /// Panels beyond [`Self::near_bins`] that the far side lobes are summed over: centre and
    /// width in bins, growing by a twentieth.
    pub fn far_panels(&self) -> Vec<(f64, f64)> {
        let end = 0.5 * self.len as f64;
        let mut from = self.near_bins() as f64;
        let mut panels = Vec::new();
        while from < end {
            let width = (0.05 * from).max(1.0).min(end - from);
            panels.push((from + 0.5 * width, width));
            from += width;
        }
        panels
    }

    /// What the windows of all ordinates share: at `nodes`, and over the bins around `far` centres.
    pub fn places(&self, nodes: &Nodes, far: &[f64]) -> Places {
        let within =
            |centre: f64| (0..PLACES).map(move |i| centre + (i as f64 + 0.5) / PLACES as f64 - 0.5);
        Places {
            nodes: nodes
                .nodes
                .iter()
                .map(|node| self.place(nodes.place(node)))
                .collect(),
            far: far
                .iter()
                .flat_map(|&centre| within(centre).map(|u| self.place(u)))
                .collect(),
        }
    }

    /// Spectral windows (both signs of frequency together, per bin) of an ordinate: at all nodes, then
    /// the mean ones over the bins around the far centres.
    ///
    /// One ordinate after the other: those of a record of two seconds are 4000 at 12 000 nodes.
    pub fn windows(&self, ordinate: &Ordinate, places: &Places) -> impl Iterator<Item = f64> {
        let centre = self.centre(ordinate);
        let at = move |place: &Place| self.window(ordinate, centre, place);
        let mean = move |around: &[Place]| around.iter().map(at).sum::<f64>() / around.len() as f64;
        let far = places.far.chunks_exact(PLACES).map(mean);
        places.nodes.iter().map(at).chain(far)
    }

    /// Sine and cosine of `pi k / 2M`.
    fn centre(&self, ordinate: &Ordinate) -> (f64, f64) {
        (PI * self.cycles(ordinate)).sin_cos()
    }

    fn place(&self, u: f64) -> Place {
        let len = self.len as f64;
        // Against the sum over samples, the centre of the run is the origin of phase.
        let (sine, cosine) = (PI * u / len).sin_cos();
        let (turn_sine, turn_cosine) = (PI * u).sin_cos();
        let norm = (len * (len * len - 1.0) / 12.0).sqrt();
        // sum (n - centre) sin(2 pi x (n - centre)), the derivative of a Dirichlet kernel.
        let line = (turn_sine * cosine - len * turn_cosine * sine) / (2.0 * sine * sine);
        Place {
            sine,
            turn: [turn_sine, turn_cosine],
            line: line / norm,
        }
    }

    /// Spectral window of an ordinate at a place.
    ///
    /// With `a = pi u / M` and `b = pi k / 2M` the transform of the basis function is, but for a
    /// phase, `sqrt(2 / M) sin a cos b / (sin^2 a - sin^2 b)` times `sin(pi u)` or `cos(pi u)` as
    /// `k` is even or odd; only odd ones meet the line.
    fn window(&self, ordinate: &Ordinate, centre: (f64, f64), place: &Place) -> f64 {
        let len = self.len as f64;
        let odd = ordinate.half_bins % 2;
        let apart = place.sine * place.sine - centre.0 * centre.0;
        let mut amplitude = if apart.abs() < 1e-12 * centre.0 * centre.0 {
            // At the ordinate itself: half of the run's length.
            let sign = if (ordinate.half_bins / 2).is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
            let sign = if odd == 1 { -sign } else { sign };
            (0.5 * len).sqrt() * sign
        } else {
            (2.0 / len).sqrt() * place.turn[odd] * place.sine * centre.1 / apart
        };
        if odd == 1 {
            amplitude -= ordinate.line * place.line;
        }
        2.0 * amplitude * amplitude * self.bin()
    }
}

/// Centred line over `len` samples, of unit norm.
fn line(len: usize) -> Vec<f64> {
    let n = len as f64;
    let norm = (n * (n * n - 1.0) / 12.0).sqrt();
    let centre = 0.5 * (n - 1.0);
    (0..len).map(|i| (i as f64 - centre) / norm).collect()
}

/// Cosine transform of type 2, orthonormal, by one transform of twice the length.
fn transform(values: impl Iterator<Item = f64>, len: usize) -> Vec<f64> {
    let mut padded = vec![Complex64::default(); 2 * len];
    for (z, value) in padded.iter_mut().zip(values) {
        z.re = value;
    }
    FftPlanner::new()
        .plan_fft_forward(padded.len().max(1))
        .process(&mut padded);
    let scale = (2.0 / len as f64).sqrt();
    padded[..len]
        .iter()
        .enumerate()
        .map(|(k, z)| {
            let turn = Complex64::from_polar(scale, -PI * k as f64 / (2 * len) as f64);
            (turn * z).re
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transform_and_window_agree_with_plain_sums() {
        let len = 50;
        let samples: Vec<f64> = (0..len).map(|n| ((n * n) as f64 * 0.37).sin()).collect();
        let direct = |k: usize, values: &[f64]| -> f64 {
            let angle = |n: usize| PI * k as f64 * (n as f64 + 0.5) / len as f64;
            let sum: f64 = values
                .iter()
                .enumerate()
                .map(|(n, x)| x * angle(n).cos())
                .sum();
            sum * (2.0 / len as f64).sqrt()
        };
        let transformed = transform(samples.iter().copied(), len);
        for (k, found) in transformed.iter().enumerate().skip(1) {
            assert!((found - direct(k, &samples)).abs() < 1e-12, "{k}");
        }
        let run = Run::new(&samples, 0.5);
        let line = line(len);
        for ordinate in &run.ordinates {
            let k = ordinate.half_bins;
            // The functional of the samples that the ordinate is: basis less its share of a line.
            let basis: Vec<f64> = (0..len)
                .map(|n| {
                    let wave = (PI * k as f64 * (n as f64 + 0.5) / len as f64).cos();
                    wave * (2.0 / len as f64).sqrt() - direct(k, &line) * line[n]
                })
                .collect();
            let power: f64 = basis.iter().zip(&samples).map(|(b, x)| b * x).sum();
            assert!((ordinate.power - power * power).abs() < 1e-12, "{k}");
            for u in [0.013, 0.5 * k as f64, 0.5 * k as f64 + 0.27, 17.3] {
                let z: Complex64 = (0..len)
                    .map(|n| Complex64::from_polar(basis[n], 2.0 * PI * u * n as f64 / len as f64))
                    .sum();
                let exact = 2.0 * z.norm_sqr() / len as f64;
                let found = run.window(ordinate, run.centre(ordinate), &run.place(u));
                assert!((found - exact).abs() < 1e-9, "{k} at {u}: {found} {exact}");
            }
        }
    }
}
