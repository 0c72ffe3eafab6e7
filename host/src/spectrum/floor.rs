//! The floor that lines stand out of: long segments, averaged, and the median over neighbours.
//!
//! Segments of at most [`SEGMENT`] samples with the cascade's taper, half overlapped, in single
//! precision (after the reference and the weighted mean are taken out, its 24 bits lie far below any
//! noise that single samples show). The mean power at each frequency follows the law of a mean of
//! correlated exponentials, matched in three moments; the median over its neighbours, over the law's
//! own median, is the floor.

use super::{
    cascade::OutOfOrder,
    fill::{Filler, Piece},
    window::Window,
};
use realfft::{RealFftPlanner, RealToComplex, num_complex::Complex32};
use std::{collections::VecDeque, sync::Arc};

/// Samples of a segment, at most.
pub(super) const SEGMENT: usize = 1 << 18;

/// Lowest bin that is searched: below, too few neighbours show what the floor is.
const LOWEST_BIN: usize = 32;

/// Neighbours to either side that the floor is the median of, at most; at low frequencies an
/// eighth of the bin's number, so that a steep spectrum does not bend over them.
const NEIGHBOURS: usize = 128;

/// Share of a segment that may be bridged.
const BRIDGED_SHARE: f64 = 0.1;

/// Averaged segments of one record.
pub(super) struct LongSegments {
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
}

impl LongSegments {
    /// Averages segments of `segment` samples, a power of two from 1024 to [`SEGMENT`]
    /// (others are taken down to one).
    pub(super) fn new(segment: usize) -> Self {
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
            fft,
        }
    }

    /// Takes consecutive values; `first` is the absolute index of the first. Gaps and values that
    /// are not finite are bridged where they are few.
    ///
    /// # Errors
    /// [`OutOfOrder`] if `first` lies before the end of an earlier block; nothing is taken.
    pub(super) fn push(&mut self, first: u64, values: &[f64]) -> Result<(), OutOfOrder> {
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
                self.neighbours += u64::from(self.follows);
            }
        }
        self.follows = usable;
        self.pending.drain(..len / 2);
        self.bridged = [self.bridged[1], 0];
    }

    /// Smooth floor of the spectrum: two-sided density per hertz at `f_hz`, none before the first
    /// segment. The median over neighbours, so that lines do not raise it.
    pub(super) fn floor(&self, rate_hz: f64) -> Option<Floor> {
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
}

/// The spectrum without its lines.
pub(super) struct Floor {
    bin_hz: f64,
    densities: Vec<f32>,
    /// Relative variance of a median, times the number of neighbours.
    median_variance: f64,
}

impl Floor {
    /// Two-sided density per hertz at a frequency.
    pub(super) fn at(&self, f_hz: f64) -> f64 {
        let place = (f_hz / self.bin_hz).max(0.0);
        let last = self.densities.len() - 1;
        let below = (place as usize).min(last);
        let above = (below + 1).min(last);
        let share = (place - below as f64).clamp(0.0, 1.0);
        f64::from(self.densities[below]) * (1.0 - share) + f64::from(self.densities[above]) * share
    }

    /// Lowest frequency that lines are searched from, hertz.
    pub(super) fn lowest_hz(&self) -> f64 {
        LOWEST_BIN as f64 * self.bin_hz
    }

    /// Relative standard deviation at a frequency.
    pub(super) fn relative_sd_at(&self, f_hz: f64) -> f64 {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::line_tests::{add_tone, white};

    /// The floor of a record at a sample a second, of segments of 4096 samples.
    fn floor(record: &[f64]) -> Floor {
        let mut segments = LongSegments::new(1 << 12);
        for (index, block) in record.chunks(1000).enumerate() {
            segments.push(1000 * index as u64, block).expect("in order");
        }
        segments.floor(1.0).expect("a segment")
    }

    #[test]
    fn lies_on_the_density_of_white_noise_below_lines_and_across_a_gap() {
        let mut record = white(5, 41 << 12);
        for cycles in [0.1, 0.2, 0.3] {
            add_tone(&mut record, 1.0, cycles, 0.5);
        }
        record[70_000..70_100].fill(f64::NAN);
        let floor = floor(&record);
        // Medians of 257 neighbours each, three of them with a line of 2 or 3 bins among them.
        for step in 1..10 {
            let f_hz = 0.05 * f64::from(step);
            let off = (floor.at(f_hz) - 1.0) / floor.relative_sd_at(f_hz);
            assert!(
                off.abs() < 5.0,
                "seed 5, {f_hz} Hz: {off} standard deviations"
            );
        }
    }

    #[test]
    fn a_record_that_goes_back_is_refused_and_none_has_no_floor() {
        let mut segments = LongSegments::new(1024);
        assert!(segments.floor(1.0).is_none());
        segments.push(10, &[1.0; 10]).expect("in order");
        assert!(segments.push(19, &[1.0]).is_err());
    }
}
