//! Power of a whitened record over time.
//!
//! The squares of what whitening leaves are summed in short blocks, each chi-squared with as many
//! degrees of freedom as it has samples.

use rayon::prelude::*;
use realfft::num_complex::Complex64;

use crate::diagnosis::statistic::matched_filter::Transform;
use crate::diagnosis::statistic::spread::middle_spread;
use crate::numeric::order::median;

/// Samples of a block: a choice. Their mean square scatters by 18 %, and nothing shorter has a
/// place of its own.
pub const BLOCK: usize = 64;

/// The least factor on the deviation that a sample is divided by: where the noise all but vanishes, what is left
/// of other noise would be all that counts.
const LEAST: f64 = 0.05;

/// Sums of squares of the whitened record.
#[derive(Debug, Clone)]
pub struct Powers {
    /// Mean square of each block, over the mean of all.
    pub powers: Vec<f64>,
    /// Samples that count, of each block.
    pub counts: Vec<f64>,
}

/// Whitens `whole` by `density` and sums squares over blocks; `usable` tells samples that count, `envelope`
/// the factor on their standard deviation that is known.
pub fn powers(
    whole: &Transform,
    density: &[f64],
    usable: impl Fn(usize) -> bool + Sync,
    envelope: impl Fn(usize) -> f64 + Sync,
) -> Powers {
    // What is left out of the band leaves that many degrees of freedom less.
    let seen = density.iter().filter(|density| density.is_finite()).count();
    let share = seen as f64 / density.len() as f64;
    // Of whatever variance: what counts is how it changes.
    let white = whole.filtered(|k| Complex64::new(density[k].sqrt().recip(), 0.0));
    let blocks = white.par_chunks_exact(BLOCK).enumerate();
    let both = blocks.map(|(block, values)| {
        let (mut sum, mut count) = (0.0, 0.0);
        for (offset, value) in values.iter().enumerate() {
            let index = block * BLOCK + offset;
            if usable(index) {
                sum += (value / envelope(index).max(LEAST)).powi(2);
                count += 1.0;
            }
        }
        let power = if count > 0.0 { sum / count } else { 0.0 };
        (power, count * share)
    });
    let (mut powers, mut counts): (Vec<f64>, Vec<f64>) = both.unzip();
    let total: f64 = counts.iter().sum();
    let mean = powers.iter().zip(&counts).map(|(p, n)| p * n).sum::<f64>() / total.max(1.0);
    powers.iter_mut().for_each(|power| *power /= mean);
    let scatter = scatter(&powers, &counts);
    counts.iter_mut().for_each(|count| *count /= scatter);
    Powers { powers, counts }
}

/// Scatter of the powers of most blocks over what their degrees of freedom say, at least one: squares
/// of a law with long tails scatter by more.
fn scatter(powers: &[f64], counts: &[f64]) -> f64 {
    // A power of chi-squared law to the third is normal (E. B. Wilson and M. M. Hilferty 1931).
    let normal = powers.iter().zip(counts).filter(|(_, count)| **count > 8.0);
    let normal = normal.map(|(power, count)| {
        let part = 2.0 / (9.0 * count);
        (power.cbrt() - (1.0 - part)) / part.sqrt()
    });
    middle_spread(&normal.collect::<Vec<f64>>())
        .powi(2)
        .max(1.0)
}

impl Powers {
    /// Deviation of the noise about a sample over that of the record, from the middle of the blocks
    /// about it: a single large sample does not make its own.
    pub fn local(&self) -> impl Fn(usize) -> f64 + use<> {
        /// Blocks on either side: a choice. The middle of 15 is moved by no single event.
        const LOCAL_BLOCKS: usize = 7;
        let blocks = self.powers.len();
        let local: Vec<f64> = (0..blocks)
            .map(|block| {
                let near =
                    block.saturating_sub(LOCAL_BLOCKS)..(block + LOCAL_BLOCKS + 1).min(blocks);
                let mut near = self.powers[near].to_vec();
                let median = median(&mut near).unwrap_or(0.0);
                median.max(0.0).sqrt()
            })
            .collect();
        move |sample| {
            local
                .get(sample / BLOCK)
                .map_or(1.0, |local| local.max(1.0))
        }
    }
}
