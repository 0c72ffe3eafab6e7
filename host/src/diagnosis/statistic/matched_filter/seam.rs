//! Where the ring closes: what lies across the seam is no news.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use realfft::num_complex::Complex64;

use super::transform::{SHARED, Transform};
use super::waveform::{Impulse, Settling, Step, Waveform};
use crate::diagnosis::statistic::sums::sums_of;

/// Courses that are set free, at most: a choice, those of nine tones beside noise of two memories. A pass over the
/// ordinates takes as many products as there are pairs of courses.
const MOST: usize = 40;

/// Share of the largest eigenvalue below which the normal equations say nothing: courses that the ordinates hardly distinguish,
/// which sums of a million squares tell to some 1e-13.
const LEAST: f64 = 1e-10;

/// What is free where the ring closes: the first sample, the level across the seam, and these.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Seam {
    /// How long noise remembers, samples: it keeps some of what was before the first sample. Where it was then is no news of
    /// the last sample, though on the ring that comes next.
    pub memories: Vec<f64>,
    /// Frequencies of tones whose bands are left out, cycles a sample: each is cut off at both ends, and on the ring it
    /// goes on as another, which all other ordinates see.
    pub tones: Vec<f64>,
}

/// What is free, made ready for a ring: courses of size 1 across the seam.
struct Courses {
    /// What noise with a memory keeps.
    memories: Vec<Settling>,
    /// How far each tone turns in a sample.
    tones: Vec<Complex64>,
    /// How many courses there are.
    count: usize,
}

impl Courses {
    /// Their transforms where one sample later is a factor of `turn`, those beyond their number zero: the first sample, the
    /// level, the memories, and of each tone two quadratures with another phase and amplitude, then two with another frequency.
    fn at(&self, turn: Complex64) -> [Complex64; MOST] {
        let mut at = [Complex64::ZERO; MOST];
        let tones = 2 + self.memories.len();
        let of_tones = 2 * self.tones.len();
        let mut put = |place: usize, value: Complex64| {
            if place < self.count {
                at[place] = value;
            }
        };
        put(0, Impulse.at(turn));
        put(1, Step.at(turn));
        for (place, memory) in self.memories.iter().enumerate() {
            put(2 + place, memory.at(turn));
        }
        for (number, &tone) in self.tones.iter().enumerate() {
            let mut sides = [tone, tone.conj()].map(|tone| cut_off(tone * turn));
            let of_first = sides;
            for order in [0, of_tones] {
                let [up, down] = sides;
                let place = tones + order + 2 * number;
                put(place, up + down);
                put(place + 1, Complex64::I * (up - down));
                sides = [up * of_first[0], down * of_first[1]];
            }
        }
        at
    }
}

/// A tone that turns by `turn` beside an ordinate in a sample, cut off at both ends of the ring; nothing at its own, of which the cut
/// says nothing.
fn cut_off(turn: Complex64) -> Complex64 {
    let cut = Complex64::ONE - turn;
    if cut == Complex64::ZERO {
        cut
    } else {
        cut.inv()
    }
}

impl Seam {
    /// All that is free on a ring of `len` samples.
    fn courses(&self, len: usize) -> Courses {
        let memories = self.memories.iter();
        let memories: Vec<Settling> = memories
            .map(|&samples| Settling::new(samples, len))
            .collect();
        let tones = self.tones.iter();
        let tones: Vec<Complex64> = tones
            .map(|cycles| Complex64::cis(std::f64::consts::TAU * cycles))
            .collect();
        Courses {
            count: (2 + memories.len() + 4 * tones.len()).min(MOST),
            memories,
            tones,
        }
    }

    /// The transforms of all that is free, on the ring of `whole`.
    pub fn waveforms(&self, whole: &Transform) -> Vec<Transform> {
        let courses = self.courses(whole.len);
        let count = whole.ordinates.len();
        let mut all = vec![vec![Complex64::ZERO; count]; courses.count];
        for k in 1..count {
            let at = courses.at(whole.ring.turn(k));
            for (ordinates, at) in all.iter_mut().zip(at) {
                ordinates[k] = at;
            }
        }
        let of = |ordinates| Transform {
            rate_hz: whole.rate_hz,
            len: whole.len,
            ordinates,
            ring: Arc::clone(&whole.ring),
        };
        all.into_iter().map(of).collect()
    }
}

impl Transform {
    /// Sets the seam free: what is left is without as much of each course as is likeliest in noise of this `density`.
    pub fn close(&mut self, density: &[f64], seam: &Seam) {
        let courses = seam.courses(self.len);
        let Some(sizes) = self.sizes(density, &courses) else {
            return;
        };
        let ring = &self.ring;
        let ordinates = self.ordinates.par_iter_mut().with_min_len(SHARED);
        let ordinates = ordinates.enumerate().skip(1);
        ordinates.for_each(|(k, ordinate)| {
            let at = courses.at(ring.turn(k));
            let pairs = at.iter().zip(&sizes);
            *ordinate -= pairs.map(|(at, size)| at * size).sum::<Complex64>();
        });
    }

    /// The likeliest sizes of some courses; `None` where the ordinates say nothing of them.
    fn sizes(&self, density: &[f64], courses: &Courses) -> Option<Vec<f64>> {
        let count = courses.count;
        // Normal equations, over half of the ring: products with the record, then those among the courses up to each.
        let sums = sums_of(
            1..self.ordinates.len(),
            count * (count + 3) / 2,
            |k, sums| {
                if !density[k].is_finite() {
                    return;
                }
                let (at, weight) = (courses.at(self.ring.turn(k)), density[k].recip());
                let (with_record, among) = sums.split_at_mut(count);
                for (at, sum) in at.iter().zip(with_record) {
                    *sum += (self.ordinates[k] * at.conj()).re * weight;
                }
                let mut among = among.iter_mut();
                for one in 0..count {
                    let own = at[one].conj() * weight;
                    for (other, sum) in at[..=one].iter().zip(among.by_ref()) {
                        *sum += (other * own).re;
                    }
                }
            },
        );
        let (right, products) = sums.split_at(count);
        let product = |one: usize, other: usize| {
            let (high, low) = (one.max(other), one.min(other));
            products[high * (high + 1) / 2 + low]
        };
        // What the ordinates do not see at all has no size.
        let unit = DVector::from_fn(count, |one, _| match product(one, one) {
            0.0 => 0.0,
            power => power.sqrt().recip(),
        });
        let gram = DMatrix::from_fn(count, count, |one, other| {
            product(one, other) * unit[one] * unit[other]
        });
        let right = DVector::from_fn(count, |one, _| right[one] * unit[one]);
        if !(gram.iter().chain(right.iter())).all(|one| one.is_finite()) {
            return None;
        }
        let sizes = gram.svd(true, true).solve(&right, LEAST).ok()?;
        Some(sizes.component_mul(&unit).iter().copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::statistic::matched_filter::{Half, Projection, Transformer};
    use crate::model::random::{Gaussian, Seed};

    #[test]
    fn both_orders_of_a_tone_are_what_its_two_sides_leave() {
        let tones: Vec<f64> = (1..=12).map(|n| 0.03 * f64::from(n)).collect();
        let seam = Seam {
            tones: tones.clone(),
            ..Seam::default()
        };
        let courses = seam.courses(1000);
        assert_eq!(courses.count, MOST, "more than there is room for");
        let turn = Complex64::cis(-0.7);
        let at = courses.at(turn);
        for (place, at) in at.iter().enumerate().skip(2) {
            let (order, place) = ((place - 2) / 24, (place - 2) % 24);
            let quadrature = [Complex64::ONE, Complex64::I][place % 2];
            let tone = Complex64::cis(std::f64::consts::TAU * tones[place / 2]);
            let side = |tone: Complex64, size: Complex64| {
                size / (Complex64::ONE - tone * turn).powi(order as i32 + 1)
            };
            let expected = side(tone, quadrature) + side(tone.conj(), quadrature.conj());
            assert!((at - expected).norm() < 1e-12 * expected.norm(), "{place}");
        }
    }

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
            let seam = Seam {
                memories: memories.to_vec(),
                ..Seam::default()
            };
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
                record.close(&density, &seam);
                let course = Settling::new(3.0 * MEMORY, LENGTH);
                let mut course = transformer.waveform(&course, 1.0);
                course.close(&density, &seam);
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

    #[test]
    fn a_tone_whose_band_is_left_out_leaves_nothing_where_it_is_cut_off() {
        const LENGTH: usize = 10_000;
        const SIZE: f64 = 1000.0;
        for (seed, cycles) in [(50, 0.030_05), (51, 0.2213), (52, 0.1101)] {
            let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
            // It goes to and fro by a hundredth of its frequency.
            let turns = |n: f64| cycles * (n + 0.01 * 400.0 * (n / 400.0).sin());
            let values: Vec<f64> = (0..LENGTH)
                .map(|n| noise.draw() + SIZE * (std::f64::consts::TAU * turns(n as f64)).cos())
                .collect();
            let mut density = vec![1.0; LENGTH / 2 + 1];
            let at = |share: f64| (share * cycles * LENGTH as f64) as usize;
            density[at(0.9)..at(1.1)].fill(f64::INFINITY);
            let transformer = Transformer::new(LENGTH);
            let largest = |tones: Vec<f64>| {
                let seam = Seam {
                    tones,
                    ..Seam::default()
                };
                let mut record = transformer.transform(&values, 1.0);
                record.close(&density, &seam);
                let steps = super::super::matched(&record, &density, &Step);
                steps.z.iter().fold(0.0, |most: f64, z| most.max(z.abs()))
            };
            // Of ten thousand normal ones the largest is 3.9, and beyond 5.5 once in 2500 records.
            let (free, held) = (largest(vec![cycles]), largest(Vec::new()));
            assert!(free < 5.5, "seed {seed}: {free}");
            assert!(held > 8.0, "seed {seed}, {held}: nothing to set free");
            // One quadrature of what does not turn is nothing, and keeps nothing else from being free.
            let beside = largest(vec![cycles, 0.0]);
            assert!(beside < 5.5, "seed {seed}: {beside}");
        }
    }
}
