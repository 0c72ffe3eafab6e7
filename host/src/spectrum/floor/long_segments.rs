//! Long segments of a record, averaged as it streams by.

use std::sync::Arc;

use realfft::{RealFftPlanner, RealToComplex, num_complex::Complex32};

use super::law::Law;
use super::{Floor, running_medians};
use crate::spectrum::{
    cascade::OutOfOrder,
    fill::{Filler, Piece},
    window::Window,
};

/// Samples of a segment, at most.
pub(in crate::spectrum) const SEGMENT: usize = 1 << 18;

/// Share of a segment that may be bridged.
const BRIDGED_SHARE: f64 = 0.1;

/// Averaged segments of one record.
pub(in crate::spectrum) struct LongSegments {
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
    pub(in crate::spectrum) fn new(segment: usize) -> Self {
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
    pub(in crate::spectrum) fn push(
        &mut self,
        first: u64,
        values: &[f64],
    ) -> Result<(), OutOfOrder> {
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
    pub(in crate::spectrum) fn floor(&self, rate_hz: f64) -> Option<Floor> {
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
