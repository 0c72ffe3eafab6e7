//! Whether a law keeps its size and shape from one moment to the next.
//!
//! Noise whose colour changes has a mean spectrum that some steady law comes near. What distinguishes them
//! is the score of each parameter `p` of the law over time: with the strengths `E` of the whitened
//! record in tiles of time and frequency (`steadiness`), exponential with mean 1 for a steady law, the
//! tiles of a block of time give
//!
//! ```text
//! s = sum w (E - 1),    w = d ln S / d ln p,    var s = sum w^2
//! ```
//!
//! the derivative of their log-likelihood by `ln p`. Weights are taken free of what is the same at
//! all frequencies: noise that is louder at times is no matter of a law. The squares of the blocks'
//! scores, over their variance, sum up to chi-squared for blocks of any length; a cycle shows in the
//! periodogram of the finest.

mod groups;

use realfft::num_complex::Complex64;

use self::groups::Tiles;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws::squared_power;
use crate::diagnosis::statistic::p_value;
use crate::fft;
use crate::fit::likelihood::components::SEEN;
use crate::model::effect::Part;

/// Numbers of blocks that the record is cut into, powers of two that each group's moments fill
/// evenly.
const BLOCKS: [usize; 4] = [16, 64, 256, 1024];

/// Information of the whole record on the logarithm of a parameter from which its course is asked
/// for: the parameter is then known to 32 %.
const LEAST: f64 = 10.0;

/// Step of a parameter's logarithm for its derivative, either way: wrong by some 4e-4 of it.
const STEP: f64 = 0.05;

/// A parameter that changes in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Name of the parameter.
    pub parameter: String,
    /// By how much, as the standard deviation of its logarithm.
    pub log_sd: f64,
    /// Period of the cycle, or length of the blocks, in which it shows best, seconds.
    pub time_s: f64,
    /// Whether it is a cycle.
    pub cyclic: bool,
    /// Probability of as much where nothing changes, the search over parameters included.
    pub p_value: f64,
}

/// The parameter of law number `which` that changes in time most plainly.
pub fn change_of_law(axis: &AxisState, which: usize) -> Option<Change> {
    let law = &axis.laws[which];
    let places: Vec<usize> = law.moves().collect();
    let names = law.effect.parameters(&law.values);
    let parameters = places.iter().map(|&place| names[place].name.to_string());
    plainest(axis, parameters.collect(), |number, f_hz| {
        let place = places[number];
        weight(axis, which, place, f_hz)
    })
}

/// The one of the five terms that changes in time most plainly.
pub fn change_of_terms(axis: &AxisState) -> Option<Change> {
    let letters = SEEN.iter().map(|letter| letter.symbol().to_string());
    plainest(axis, letters.collect(), |component, f_hz| {
        2.0 * axis.term_share(component, f_hz)
    })
}

/// The plainest change of some parameters, whose weights at a frequency `weight` gives by number.
fn plainest(
    axis: &AxisState,
    parameters: Vec<String>,
    weight: impl Fn(usize, f64) -> f64,
) -> Option<Change> {
    let tiles = Tiles::new(axis, BLOCKS[BLOCKS.len() - 1]);
    let trials = parameters.len() as f64;
    let changes = parameters
        .into_iter()
        .enumerate()
        .filter_map(|(place, parameter)| {
            let change = Scores::new(&tiles, |f_hz| weight(place, f_hz)).change(axis)?;
            Some(Change {
                parameter,
                p_value: p_value::searched(change.p_value, trials),
                ..change
            })
        });
    changes.min_by(|a, b| a.p_value.total_cmp(&b.p_value))
}

/// Derivative of the logarithm of all of the density by that of a law's value.
fn weight(axis: &AxisState, which: usize, place: usize, f_hz: f64) -> f64 {
    let law = &axis.laws[which];
    let moved = |by: f64| {
        let mut values = law.values.clone();
        values[place] *= by.exp();
        law.effect.part(&values)
    };
    let by_both =
        |log: &dyn Fn(&Part) -> f64| (log(&moved(STEP)) - log(&moved(-STEP))) / (2.0 * STEP);
    match law.effect.part(&law.values) {
        Part::Term(_) => {
            let share = axis.law_share(which, f_hz);
            if law.effect.size() == Some(place) {
                return squared_power(law) * share;
            }
            share
                * by_both(&|part| match part {
                    Part::Term(term) => axis.bins.term_density(&**term, f_hz).ln(),
                    _ => 0.0,
                })
        }
        Part::Distortion(_) => by_both(&|part| match part {
            Part::Distortion(filter) => filter.shown(f_hz, axis.rate_hz).ln(),
            _ => 0.0,
        }),
        Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => 0.0,
    }
}

/// Scores of a parameter in blocks of time.
struct Scores<'a> {
    tiles: &'a Tiles,
    /// Weight of the parameter in each group of ordinates.
    weights: Vec<f64>,
}

/// Scores of blocks of one length.
struct Blocks {
    /// Over their standard deviations; 0 where nothing counts.
    scores: Vec<f64>,
    /// Mean information of a block on the logarithm of the parameter.
    information: f64,
    /// Degrees of freedom of the mean square of the scores.
    freedom: f64,
}

impl<'a> Scores<'a> {
    fn new(tiles: &'a Tiles, weight: impl Fn(f64) -> f64) -> Self {
        let weights = tiles.groups.iter().map(|group| weight(group.f_hz));
        let weights = weights.map(|one| if one.is_finite() { one } else { 0.0 });
        Self {
            tiles,
            weights: weights.collect(),
        }
    }

    fn blocks(&self, count: usize) -> Blocks {
        let groups = || {
            let both = self.tiles.groups.iter().zip(&self.weights);
            both.filter(|(group, _)| group.parts.len() >= count)
        };
        // What is the same at all frequencies does not count.
        let (sum, tiles) = groups().fold((0.0, 0.0), |(sum, tiles), (group, weight)| {
            let moments: f64 = group.parts.iter().map(|[_, count]| count).sum();
            (sum + weight * moments, tiles + moments)
        });
        let common = sum / tiles;
        let mut sums = vec![[0.0; 3]; count];
        for (group, weight) in groups() {
            let weight = weight - common;
            let parts = group.parts.chunks(group.parts.len() / count);
            for (block, parts) in sums.iter_mut().zip(parts) {
                for [strength, moments] in parts {
                    block[0] += weight * (strength - moments);
                    block[1] += weight * weight * moments;
                    block[2] += weight.powi(4) * moments;
                }
            }
        }
        let (mut scores, mut information, mut scatter) = (Vec::new(), 0.0, 0.0);
        for [score, square, fourth] in &sums {
            if *square > 0.0 {
                scores.push(score / square.sqrt());
                information += square;
                // An exponential tile has the excess kurtosis 6.
                scatter += 2.0 + 6.0 * fourth / (square * square);
            } else {
                scores.push(0.0);
            }
        }
        let counted = sums.iter().filter(|[_, square, _]| *square > 0.0).count() as f64;
        Blocks {
            scores,
            information: information / counted,
            freedom: 2.0 * counted * counted / scatter,
        }
    }

    fn change(&self, axis: &AxisState) -> Option<Change> {
        let duration_s = axis.whitened().transform.len() as f64 / axis.rate_hz;
        let trials = BLOCKS.len() as f64 + 1.0;
        let by_length = BLOCKS.iter().filter_map(|&count| {
            let blocks = self.blocks(count);
            let squares: f64 = blocks.scores.iter().map(|score| score * score).sum();
            let counted = blocks.scores.iter().filter(|score| **score != 0.0).count() as f64;
            // Its own mean takes one away.
            let ratio = squares / (counted - 1.0);
            (counted >= 8.0 && ratio > 1.0).then(|| Change {
                parameter: String::new(),
                log_sd: ((ratio - 1.0) / blocks.information).sqrt(),
                time_s: duration_s / count as f64,
                cyclic: false,
                p_value: p_value::mean_square(ratio, blocks.freedom),
            })
        });
        // What the record as a whole hardly determines cannot be seen to change.
        if self.blocks(BLOCKS[0]).information * (BLOCKS[0] as f64) < LEAST {
            return None;
        }
        let best = by_length.min_by(|a, b| a.p_value.total_cmp(&b.p_value));
        let cycle = self.cycle(duration_s);
        let plain = |change: &Change| change.p_value.max(f64::MIN_POSITIVE).ln();
        let least = best.as_ref().map_or(1.0, |best| best.p_value);
        let p_value = p_value::searched(least.min(cycle.p_value), trials);
        // A cycle shows in blocks as well, and says more.
        let told = match best {
            Some(best) if plain(&cycle) > 0.5 * plain(&best) => best,
            _ => cycle,
        };
        Some(Change { p_value, ..told })
    }

    /// The most significant cycle of the parameter, in a record of `duration_s`.
    fn cycle(&self, duration_s: f64) -> Change {
        let count = BLOCKS[BLOCKS.len() - 1];
        let blocks = self.blocks(count);
        let counted = blocks.scores.iter().filter(|score| **score != 0.0).count() as f64;
        let mut ordinates: Vec<Complex64> = blocks.scores.iter().map(|&one| one.into()).collect();
        fft::forward(count).process(&mut ordinates);
        let power = |k: usize| ordinates[k].norm_sqr() / counted.max(1.0);
        let best = (1..count / 2)
            .max_by(|&a, &b| power(a).total_cmp(&power(b)))
            .unwrap_or(1);
        Change {
            parameter: String::new(),
            // A cosine of the score of amplitude a has the power a^2 count / 4, and half its square is
            // its variance.
            log_sd: (2.0 * power(best) / counted / blocks.information).sqrt(),
            time_s: duration_s / best as f64,
            cyclic: true,
            p_value: p_value::searched((-power(best)).exp(), (count / 2) as f64),
        }
    }
}

#[cfg(test)]
mod tests;
