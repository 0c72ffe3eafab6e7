//! Weights of what is far from a bin, gathered on wider panels.
//!
//! A window without a taper falls with the square of the distance and reaches everywhere: each bin of a record of ten
//! thousand samples has as many weights as the record, nearly all of which decide next to nothing. Six nodes on a panel
//! know every spectrum that is a polynomial of the fifth degree there, so that weights of four panels next to each other
//! go to one of four times the width by
//!
//! ```text
//! W_j = sum_i w_i l_j(x_i)
//! ```
//!
//! with the polynomial `l_j` that is 1 at node `j` of the wide panel and 0 at its others: for such a spectrum nothing
//! changes. Wider ones are made of those, and so on.

use super::quadrature::{Nodes, Place, RULE, lagrange};

/// Widths of a panel between it and frequency zero, at least: what is as smooth as a power law there is a polynomial of the
/// fifth degree to 1e-8, and a chain's edge, a tenth of its frequency wide, to a thousandth.
const SMOOTH: usize = 8;

/// Share of a bin up to which a panel is far from it: what a wide panel gets wrong of a spectrum, a thousandth where a chain's
/// edge is, is lost of as little.
const FAR: f64 = 1e-3;

/// Panels that are gathered on one: a choice. With two there would be as many wide panels as narrow ones, at each of which a
/// spectrum has to be known; with four it is a third.
const TOGETHER: usize = 4;

/// Weights at the nodes of a panel.
type Weights = [f64; RULE.len()];

/// Panels of a source, and those that are [`TOGETHER`] times as wide, and as much again.
#[derive(Debug, Clone)]
pub struct Gathering {
    /// Panels of each width, the narrowest first.
    counts: Vec<usize>,
    /// What a wide panel's nodes have of each node of those that it is made of.
    shares: [[Weights; RULE.len()]; TOGETHER],
}

impl Gathering {
    /// Of so many panels, which begin at frequency zero.
    pub fn new(panels: usize) -> Self {
        let counts = std::iter::successors(Some(panels), |count| Some(count / TOGETHER));
        let shares = |part: usize| {
            let shares = |place: f64| std::array::from_fn(|node| lagrange(node, place));
            RULE.map(|(place, _)| shares((part as f64 + place) / TOGETHER as f64))
        };
        Self {
            counts: counts.take_while(|count| *count > 0).collect(),
            shares: std::array::from_fn(shares),
        }
    }

    /// Places of all nodes where the narrowest panel is as wide as this: of those first, then of the wider ones.
    pub fn places(&self, width_hz: f64) -> Vec<Place> {
        let levels = self.counts.iter().enumerate();
        let of_level = |(level, &count)| -> Vec<Place> {
            Nodes::new(count).places(width_hz * width(level)).collect()
        };
        levels.flat_map(of_level).collect()
    }

    /// Weights of a bin at [`Self::places`] from those at the nodes of the narrowest panels: each on the widest panel that is far
    /// from the bin, and zero elsewhere.
    pub fn gather(&self, weights: &[f64]) -> Vec<f64> {
        let mut levels = vec![narrowest(weights)];
        for level in 1..self.counts.len() {
            let below: &Vec<Weights> = &levels[level - 1];
            let parts = below.chunks_exact(TOGETHER);
            levels.push(parts.map(|parts| self.merged(parts)).collect());
        }
        // From the widest down: what is part of a panel that is far is there already.
        let mut is_there: Vec<bool> = Vec::new();
        for (level, panels) in levels.iter_mut().enumerate().rev() {
            let parents = std::mem::take(&mut is_there);
            for (number, weights) in panels.iter_mut().enumerate() {
                let inherits = parents.get(number / TOGETHER).is_some_and(|there| *there);
                let is_far = level == 0 || is_far(weights, number);
                if inherits || !is_far {
                    *weights = [0.0; RULE.len()];
                }
                is_there.push(inherits || is_far);
            }
        }
        levels.into_iter().flatten().flatten().collect()
    }

    fn merged(&self, parts: &[Weights]) -> Weights {
        let mut sums = [0.0; RULE.len()];
        for (weights, shares) in parts.iter().zip(&self.shares) {
            for (weight, shares) in weights.iter().zip(shares) {
                let pairs = sums.iter_mut().zip(shares);
                pairs.for_each(|(sum, share)| *sum += weight * share);
            }
        }
        sums
    }
}

/// Width of the panels of a level, in widths of the narrowest.
fn width(level: usize) -> f64 {
    TOGETHER.pow(level as u32) as f64
}

fn narrowest(weights: &[f64]) -> Vec<Weights> {
    let (panels, _) = weights.as_chunks();
    panels.to_vec()
}

/// Whether a panel of this number among its like is far from a bin that has these weights there.
fn is_far(weights: &Weights, number: usize) -> bool {
    number >= SMOOTH && weights.iter().sum::<f64>() < FAR
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::cosine::Run;

    /// Every thirtieth ordinate of a run of `len` samples: its centre, and its weights near and gathered, at the places of both.
    fn rows(len: usize) -> (Vec<Place>, Vec<Place>, Vec<[Vec<f64>; 2]>) {
        let samples: Vec<f64> = (0..len).map(|n| ((n * n) as f64 * 0.37).sin()).collect();
        let run = Run::new(&samples, 0.4);
        let nodes = Nodes::new(run.near_bins());
        let gathering = Gathering::new(run.near_bins());
        let windowed = run.places(&nodes, &[]);
        let rows = run.ordinates.iter().step_by(30).map(|ordinate| {
            let windows = run.windows(ordinate, &windowed).zip(&nodes.nodes);
            let weights: Vec<f64> = windows.map(|(window, node)| window * node.weight).collect();
            let gathered = gathering.gather(&weights);
            [weights, gathered]
        });
        let rows = rows.collect();
        (nodes.places(1.0).collect(), gathering.places(1.0), rows)
    }

    fn sum(places: &[Place], weights: &[f64], density: &dyn Fn(f64) -> f64) -> f64 {
        let pairs = places.iter().zip(weights);
        let those = pairs.filter(|(_, weight)| **weight != 0.0);
        those
            .map(|(place, weight)| weight * density(place.f_hz))
            .sum()
    }

    #[test]
    fn an_eighth_of_the_weights_says_as_much_of_any_spectrum() {
        // No product of fours.
        let (near, all, rows) = rows(2477);
        let edge = |f_hz: f64| 1.0 / (1.0 + (f_hz / 800.0).powi(40));
        let densities: [&dyn Fn(f64) -> f64; 6] = [
            &|f_hz| f_hz.powi(-2),
            &|f_hz| f_hz.recip(),
            &|_| 1.0,
            &|f_hz| f_hz.powi(2),
            &|f_hz| edge(f_hz) / f_hz + 1e-6,
            &|f_hz| edge(f_hz) * f_hz.powi(2),
        ];
        for density in densities {
            for (number, [weights, gathered]) in rows.iter().enumerate() {
                let (plain, found) = (sum(&near, weights, density), sum(&all, gathered, density));
                let off = (found / plain - 1.0).abs();
                assert!(off < 2e-8, "ordinate {}: off by {off}", 30 * number);
            }
        }
        let count = |which: usize| -> usize {
            let weights = rows.iter().flat_map(|row| &row[which]);
            weights.filter(|weight| **weight != 0.0).count()
        };
        assert!(8 * count(1) < count(0), "{} of {}", count(1), count(0));
    }
}
