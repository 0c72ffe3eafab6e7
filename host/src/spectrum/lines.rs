//! Narrow lines while streaming: long segments, averaged, against their own neighbourhood.
//!
//! Segments of [`SEGMENT`] samples with the cascade's taper, half overlapped, in single precision
//! (after the reference and the weighted mean are taken out, its 24 bits lie far below any noise
//! that single samples show). The mean power at each frequency is divided by the median over its
//! neighbours; the quotient's law without a line is that of a mean of correlated exponentials,
//! matched in three moments, with the median's own error.
//!
//! **Level.** `level` is family-wise over the search: the probability that a record of stationary
//! noise with a smooth spectrum yields *any* line at *any* of the frequencies searched, from
//! [`LOWEST_BIN`] bins to half the rate, is at most `level`. A bin counts as one trial, without
//! credit for the correlation of neighbours.
//!
//! **Reach.** With `S` segments the line must lift a bin by about `5 / sqrt(1.9 S)` of the floor;
//! after 1.5 h at 2000/s (41 segments' length) that is some 1.45 times the amplitude that an ideal
//! search of the whole record needs, and it grows as the fourth root of the length beyond.

use super::{
    cascade::OutOfOrder,
    fill::{Filler, Piece},
    window::Window,
};
use realfft::{RealFftPlanner, RealToComplex, num_complex::Complex32};
use statrs::function::gamma::gamma_ur;
use std::{collections::VecDeque, sync::Arc};

/// Samples of a segment.
pub const SEGMENT: usize = 1 << 18;

/// Lowest bin that is searched: below, too few neighbours tell what the floor is.
pub const LOWEST_BIN: usize = 32;

/// Neighbours to either side that the floor is the median of, at most; at low frequencies an
/// eighth of the bin's number, so that a steep spectrum does not bend over them.
const NEIGHBOURS: usize = 128;

/// Share of a segment that may be bridged.
const BRIDGED_SHARE: f64 = 0.1;

/// A line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Frequency, hertz.
    pub frequency_hz: f64,
    /// One standard deviation of it, hertz.
    pub frequency_sd_hz: f64,
    /// Amplitude `A` of `A cos(2 pi f t + p)`, in the unit of the samples.
    pub amplitude: f64,
    /// Power over the floor.
    pub ratio: f64,
    /// Family-wise probability of a line as strong anywhere without one.
    pub false_alarm: f64,
}

/// Streaming search of one axis.
#[derive(Clone)]
pub struct LineSearch {
    fft: Arc<dyn RealToComplex<f32>>,
    /// First half of the taper; the rest mirrors it.
    window: Vec<f32>,
    len: usize,
    filler: Filler,
    next: u64,
    reference: Option<f64>,
    /// Samples of the present segment.
    pending: Vec<f32>,
    /// How many of the two halves are bridges.
    bridged: [usize; 2],
    /// Whether the segment before was used: this one then shares half of its samples.
    follows: bool,
    input: Vec<f32>,
    output: Vec<Complex32>,
    scratch: Vec<Complex32>,
    sums: Vec<f32>,
    segments: u64,
    neighbours: u64,
    /// Sum of the squared shares that were bridged: where a strong line leaves a pedestal.
    bridged_power: f64,
}

impl std::fmt::Debug for LineSearch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LineSearch")
            .field("segments", &self.segments)
            .finish_non_exhaustive()
    }
}

impl Default for LineSearch {
    fn default() -> Self {
        Self::new(SEGMENT)
    }
}

impl LineSearch {
    /// Search with segments of `segment` samples, a power of two from 1024 to [`SEGMENT`]
    /// (others are taken down to one).
    pub fn new(segment: usize) -> Self {
        let segment = 1 << segment.clamp(1024, SEGMENT).ilog2();
        let fft = RealFftPlanner::new().plan_fft_forward(segment);
        Self {
            window: Window::new(segment).values()[..=segment / 2]
                .iter()
                .map(|&w| w as f32)
                .collect(),
            len: segment,
            filler: Filler::default(),
            next: 0,
            reference: None,
            pending: Vec::with_capacity(segment),
            bridged: [0, 0],
            follows: false,
            input: fft.make_input_vec(),
            output: fft.make_output_vec(),
            scratch: fft.make_scratch_vec(),
            sums: vec![0.0; segment / 2],
            segments: 0,
            neighbours: 0,
            bridged_power: 0.0,
            fft,
        }
    }

    /// Segments seen.
    pub fn segments(&self) -> u64 {
        self.segments
    }

    /// Takes consecutive codes; `first` is the absolute index of the first.
    ///
    /// # Errors
    /// [`OutOfOrder`] if `first` lies before the end of an earlier block; nothing is taken.
    pub fn push_codes(&mut self, first: u64, codes: &[i32]) -> Result<(), OutOfOrder> {
        let values: Vec<f64> = codes.iter().map(|&code| f64::from(code)).collect();
        self.push_values(first, &values)
    }

    /// Takes consecutive values; `first` is the absolute index of the first. Gaps and values that
    /// are not finite are bridged where they are few.
    ///
    /// # Errors
    /// [`OutOfOrder`] if `first` lies before the end of an earlier block; nothing is taken.
    pub fn push_values(&mut self, first: u64, values: &[f64]) -> Result<(), OutOfOrder> {
        if first < self.next {
            return Err(OutOfOrder {
                first,
                next: self.next,
            });
        }
        self.next = first + values.len() as u64;
        let longest = (BRIDGED_SHARE * self.len as f64) as u64;
        let mut filler = std::mem::take(&mut self.filler);
        filler.push(first, values, longest, &mut |piece| match piece {
            Piece::Measured(values) => self.take(values, false),
            Piece::Bridge(values) => self.take(values, true),
            Piece::Break(_) => self.restart(),
        });
        self.filler = filler;
        Ok(())
    }

    /// Bytes in the buffers, besides the transform's own tables (about half as much again).
    pub fn buffer_bytes(&self) -> usize {
        let singles = [&self.window, &self.pending, &self.input, &self.sums];
        let complexes = [&self.output, &self.scratch];
        4 * singles.map(Vec::capacity).iter().sum::<usize>()
            + 8 * complexes.map(Vec::capacity).iter().sum::<usize>()
    }

    fn restart(&mut self) {
        self.pending.clear();
        self.bridged = [0, 0];
        self.follows = false;
    }

    fn take(&mut self, mut values: &[f64], bridge: bool) {
        let segment = self.len;
        let reference = *self.reference.get_or_insert(values[0]);
        while !values.is_empty() {
            let half = if self.pending.len() < segment / 2 {
                0
            } else {
                1
            };
            let room = (half + 1) * segment / 2 - self.pending.len();
            let (head, tail) = values.split_at(room.min(values.len()));
            self.pending
                .extend(head.iter().map(|x| (x - reference) as f32));
            if bridge {
                self.bridged[half] += head.len();
            }
            if self.pending.len() == segment {
                self.segment();
            }
            values = tail;
        }
    }

    fn segment(&mut self) {
        let len = self.len;
        let bridged = (self.bridged[0] + self.bridged[1]) as f64;
        let usable = bridged <= BRIDGED_SHARE * len as f64;
        if usable {
            let weights = self
                .window
                .iter()
                .chain(self.window[1..len / 2].iter().rev());
            let (mut weighted, mut total) = (0.0, 0.0);
            for (x, w) in self.pending.iter().zip(weights.clone()) {
                weighted += f64::from(*x) * f64::from(*w);
                total += f64::from(*w);
            }
            let mean = (weighted / total) as f32;
            for ((y, x), w) in self.input.iter_mut().zip(&self.pending).zip(weights) {
                *y = (x - mean) * w;
            }
            // All three buffers come from the plan itself, so their lengths are right.
            let done =
                self.fft
                    .process_with_scratch(&mut self.input, &mut self.output, &mut self.scratch);
            if done.is_ok() {
                for (sum, z) in self.sums.iter_mut().zip(&self.output) {
                    *sum += z.norm_sqr();
                }
                self.segments += 1;
                self.bridged_power += (bridged / len as f64).powi(2);
                self.neighbours += u64::from(self.follows);
            }
        }
        self.follows = usable;
        self.pending.drain(..len / 2);
        self.bridged = [self.bridged[1], 0];
    }

    /// Smooth floor of the spectrum: two-sided density per hertz at `f_hz`, none before the first
    /// segment. The median over neighbours, so that lines do not raise it.
    pub fn floor(&self, rate_hz: f64) -> Option<Floor> {
        if self.segments == 0 {
            return None;
        }
        let law = self.law();
        let len = self.len;
        let taper = Window::new(1024);
        let scale = 1.0 / (self.segments as f64 * 0.5 * len as f64 * rate_hz);
        Some(Floor {
            bin_hz: rate_hz / len as f64,
            densities: running_medians(&self.sums)
                .into_iter()
                .map(|median| (f64::from(median) * scale / law.median()) as f32)
                .collect(),
            median_variance: 0.5
                * std::f64::consts::PI
                * taper.noise_bandwidth_bins()
                * law.variance,
        })
    }

    fn law(&self) -> Law {
        let taper = Window::new(1024);
        let overlap = taper.correlation(512, 0.0);
        Law::new(self.segments as f64, self.neighbours as f64 * overlap)
    }

    /// Lines of the record so far, by frequency, at a family-wise `level`.
    pub fn lines(&self, rate_hz: f64, level: f64) -> Vec<Line> {
        let Some(floor) = self.floor(rate_hz) else {
            return Vec::new();
        };
        let len = self.len;
        let (law, taper) = (self.law(), Window::new(1024));
        let scale = 1.0 / (self.segments as f64 * 0.5 * len as f64 * rate_hz);
        let density = |k: usize| f64::from(self.sums[k]) * scale;
        let searched = LOWEST_BIN..len / 2 - 1;
        let trials = searched.len() as f64;
        let mut found: Vec<(usize, f64, f64)> = searched
            .filter(|&k| self.sums[k] >= self.sums[k - 1] && self.sums[k] > self.sums[k + 1])
            .filter_map(|k| {
                let ratio = density(k) / f64::from(floor.densities[k]);
                // Cheap bound first: almost all bins end here.
                if ratio < 1.0 {
                    return None;
                }
                let alarm = trials * law.tail(ratio, floor.relative_sd(k));
                (alarm < level).then_some((k, ratio, alarm))
            })
            .collect();
        found.sort_by(|one, other| density(other.0).total_cmp(&density(one.0)));
        let pedestal = self.bridged_power / self.segments as f64;
        let mut kept: Vec<(usize, f64, f64)> = Vec::new();
        for line in found {
            let hidden = kept.iter().any(|strong| {
                let distance = line.0.abs_diff(strong.0) as f64;
                let leaked = side_lobe(&taper, distance) + pedestal;
                distance <= 3.0 || density(line.0) < 4.0 * density(strong.0) * leaked
            });
            if !hidden {
                kept.push(line);
            }
        }
        kept.sort_by_key(|line| line.0);
        kept.into_iter()
            .map(|(k, ratio, alarm)| {
                let excess = |k: usize| {
                    (density(k) - f64::from(floor.densities[k]))
                        .max(1e-3 * density(k))
                        .ln()
                };
                let (below, at, above) = (excess(k - 1), excess(k), excess(k + 1));
                let offset = (0.5 * (below - above) / (below - 2.0 * at + above)).clamp(-0.5, 0.5);
                let loss = taper.transform(offset) / taper.sum();
                let window_sum = taper.sum() / 1024.0 * len as f64;
                let power = at.exp() * 0.5 * len as f64 * rate_hz / (window_sum * window_sum);
                // Interpolation between bins errs by about 1/(3 sqrt(S r)) bin.
                let sd_bins = 0.3 / (self.segments as f64 * (ratio - 1.0)).sqrt();
                Line {
                    frequency_hz: (k as f64 + offset) * floor.bin_hz,
                    frequency_sd_hz: sd_bins.max(0.005) * floor.bin_hz,
                    amplitude: 2.0 * power.sqrt() / loss,
                    ratio,
                    false_alarm: alarm.min(1.0),
                }
            })
            .collect()
    }
}

/// The spectrum without its lines.
#[derive(Debug, Clone)]
pub struct Floor {
    bin_hz: f64,
    densities: Vec<f32>,
    /// Relative variance of a median, times the number of neighbours.
    median_variance: f64,
}

impl Floor {
    /// Two-sided density per hertz at a frequency.
    pub fn at(&self, f_hz: f64) -> f64 {
        let place = (f_hz / self.bin_hz).max(0.0);
        let last = self.densities.len() - 1;
        let below = (place as usize).min(last);
        let above = (below + 1).min(last);
        let share = (place - below as f64).clamp(0.0, 1.0);
        f64::from(self.densities[below]) * (1.0 - share) + f64::from(self.densities[above]) * share
    }

    /// Lowest frequency that lines are searched from, hertz.
    pub fn lowest_hz(&self) -> f64 {
        LOWEST_BIN as f64 * self.bin_hz
    }

    /// Relative standard deviation at a frequency.
    pub fn relative_sd_at(&self, f_hz: f64) -> f64 {
        self.relative_sd((f_hz / self.bin_hz) as usize)
    }

    fn relative_sd(&self, k: usize) -> f64 {
        (self.median_variance / (2 * half_span(k) + 1) as f64).sqrt()
    }
}

fn half_span(k: usize) -> usize {
    (k / 8).min(NEIGHBOURS)
}

/// Median over the neighbours of each value.
fn running_medians(values: &[f32]) -> Vec<f32> {
    let mut sorted: Vec<f32> = Vec::with_capacity(2 * NEIGHBOURS + 1);
    let mut order: VecDeque<f32> = VecDeque::with_capacity(2 * NEIGHBOURS + 1);
    let mut from = 0;
    (0..values.len())
        .map(|k| {
            let half = half_span(k);
            let (low, high) = (k - half, (k + half).min(values.len() - 1));
            while from + order.len() <= high {
                let value = values[from + order.len()];
                order.push_back(value);
                sorted.insert(sorted.partition_point(|x| *x < value), value);
            }
            while from < low {
                if let Some(value) = order.pop_front() {
                    sorted.remove(sorted.partition_point(|x| *x < value));
                }
                from += 1;
            }
            sorted[sorted.len() / 2]
        })
        .collect()
}

/// Law of a mean of correlated unit exponentials: a shifted gamma law with their first three
/// moments (Pearson's type III).
#[derive(Debug, Clone, Copy)]
struct Law {
    variance: f64,
    shape: f64,
    scale: f64,
}

impl Law {
    /// Mean of `count` exponentials whose squared correlations between neighbours add up to
    /// `overlap`: `tr R^2 = n + 2 o`, `tr R^3 = n + 6 o` for a tridiagonal `R`.
    fn new(count: f64, overlap: f64) -> Self {
        let variance = (count + 2.0 * overlap) / (count * count);
        let third = 2.0 * (count + 6.0 * overlap) / (count * count * count);
        Self {
            variance,
            shape: 4.0 * variance * variance * variance / (third * third),
            scale: 0.5 * third / variance,
        }
    }

    fn median(&self) -> f64 {
        // Median of a gamma law, Wilson and Hilferty 1931: right to 1e-3 at shape 1, to 1e-5 at 10.
        let cube = 1.0 - 1.0 / (9.0 * self.shape);
        1.0 + self.shape * self.scale * (cube * cube * cube - 1.0)
    }

    /// Probability above `ratio` times a floor that is known to a relative standard deviation.
    fn tail(&self, ratio: f64, floor_sd: f64) -> f64 {
        let exact = |ratio: f64| {
            let place = (ratio - 1.0) / self.scale + self.shape;
            if place <= 0.0 {
                1.0
            } else {
                gamma_ur(self.shape, place)
            }
        };
        0.5 * (exact(ratio * (1.0 + floor_sd)) + exact(ratio * (1.0 - floor_sd)))
    }
}

/// Power of the taper's side lobes at and beyond a distance in bins, relative to its peak.
fn side_lobe(taper: &Window, distance: f64) -> f64 {
    // Beyond the table's own resolution the lobes fall by 18 dB an octave.
    let place = distance.min(100.0);
    let highest = (0..8)
        .map(|i| (taper.transform(place - 0.5 + 0.125 * f64::from(i)) / taper.sum()).powi(2))
        .fold(0.0, f64::max);
    highest * (place / distance).powi(6)
}
