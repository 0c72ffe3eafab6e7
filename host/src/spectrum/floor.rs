//! The floor that lines stand out of: long segments, averaged, and the median over neighbours.
//!
//! Segments of at most [`SEGMENT`] samples with the cascade's taper, half overlapped, in single
//! precision (after the reference and the weighted mean are taken out, its 24 bits lie far below any
//! noise that single samples show). The mean power at each frequency follows the law of a mean of
//! correlated exponentials, matched in three moments; the median over its neighbours, over the law's
//! own median, is the floor.

mod law;
mod long_segments;

use std::collections::VecDeque;

pub(super) use long_segments::{LongSegments, SEGMENT};

/// Lowest bin that is searched: below, too few neighbours show what the floor is.
const LOWEST_BIN: usize = 32;

/// Neighbours to either side that the floor is the median of, at most; at low frequencies an
/// eighth of the bin's number, so that a steep spectrum does not bend over them.
const NEIGHBOURS: usize = 128;

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
