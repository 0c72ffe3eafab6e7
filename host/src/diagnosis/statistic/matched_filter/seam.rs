//! Where the ring closes: what lies across the seam is no news.

use std::sync::Arc;

use rayon::prelude::*;

use super::projection::{Half, Projection};
use super::transform::{SHARED, Transform};
use super::waveform::{Settling, Step, Waveform};
use crate::diagnosis::statistic::sums::sums;

impl Transform {
    /// Sets the seam free: the first sample takes the value, the level across the seam the step, and what noise of a memory of so
    /// many samples keeps of what was before the first sample the size, that all others predict for them. Where such noise was is
    /// no news of the last sample, though on the ring it comes next.
    pub fn close(&mut self, density: &[f64], memories: &[f64]) {
        self.close_level(density);
        let mut kept: Vec<Self> = Vec::new();
        for &samples in memories {
            let course = Settling {
                samples,
                len: self.len,
            };
            let mut course = self.transformer().waveform(&course, self.rate_hz);
            course.close_level(density);
            kept.iter().for_each(|one| course.take_out(one, density));
            self.take_out(&course, density);
            kept.push(course);
        }
    }

    /// Takes out what there is of a course, as much as is likeliest.
    fn take_out(&mut self, course: &Self, density: &[f64]) {
        let size = Projection::new(self, density, course, Half::Both).size();
        if size.is_finite() {
            self.add_scaled(-size, course);
        }
    }

    /// Sets the first sample and the level across the seam free.
    fn close_level(&mut self, density: &[f64]) {
        let ring = Arc::clone(&self.ring);
        let step = |k: usize| Step.at(ring.turn(k));
        // Normal equations of both, over half of the ring.
        let [right, right_of_step, one, of_step, square] = sums(1..self.ordinates.len(), |k| {
            let (ordinate, weight, step) = (self.ordinates[k], density[k].recip(), step(k));
            [
                ordinate.re,
                (ordinate * step.conj()).re,
                1.0,
                step.re,
                step.norm_sqr(),
            ]
            .map(|term| term * weight)
        });
        let determinant = one * square - of_step * of_step;
        let sample = (right * square - right_of_step * of_step) / determinant;
        let height = (right_of_step * one - right * of_step) / determinant;
        if !(sample.is_finite() && height.is_finite()) {
            return;
        }
        let ordinates = self.ordinates.par_iter_mut().with_min_len(SHARED);
        let ordinates = ordinates.enumerate().skip(1);
        ordinates.for_each(|(k, ordinate)| *ordinate -= sample + height * step(k));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::statistic::matched_filter::Transformer;
    use crate::model::random::{Gaussian, Seed};

    #[test]
    fn noise_that_remembers_begins_where_it_likes() {
        /// Samples for which it remembers, in a record as long as two hundred times that.
        const MEMORY: f64 = 50.0;
        const LENGTH: usize = 10_000;
        const RECORDS: u64 = 40;
        let kept = (-1.0 / MEMORY).exp();
        let density: Vec<f64> = (0..=LENGTH / 2)
            .map(|k| {
                let turn = std::f64::consts::TAU * k as f64 / LENGTH as f64;
                (1.0 - kept * kept) / (1.0 + kept * kept - 2.0 * kept * turn.cos())
            })
            .collect();
        // Mean square of the statistic of a settling three times as slow: 1 where there is none.
        let square = |memories: &[f64]| {
            let squares = (0..RECORDS).map(|seed| {
                let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
                let mut level = noise.draw();
                let values: Vec<f64> = (0..LENGTH)
                    .map(|_| {
                        level = kept * level + (1.0 - kept * kept).sqrt() * noise.draw();
                        level
                    })
                    .collect();
                let transformer = Transformer::new(LENGTH);
                let mut record = transformer.transform(&values, 1.0);
                record.close(&density, memories);
                let course = Settling {
                    samples: 3.0 * MEMORY,
                    len: LENGTH,
                };
                let mut course = transformer.waveform(&course, 1.0);
                course.close(&density, memories);
                Projection::new(&record, &density, &course, Half::Both)
                    .z()
                    .powi(2)
            });
            squares.sum::<f64>() / RECORDS as f64
        };
        // Chi-squared of forty degrees of freedom over forty: 1 to a fifth, five deviations.
        let (free, held) = (square(&[MEMORY]), square(&[]));
        assert!((free - 1.0).abs() < 5.0 * 0.22, "{free}, seeds 0 to 39");
        assert!(held > 4.0, "{held}: nothing to set free, seeds 0 to 39");
    }
}
