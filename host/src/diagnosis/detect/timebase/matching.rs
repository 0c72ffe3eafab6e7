//! Lines here and there that one shift brings together, and what that is worth.

use std::f64::consts::TAU;

use super::mark::{Log, SAME};
use super::sources::sources;

/// Ratios that are looked for: a choice, a quarter either way.
pub(super) const RATIOS: [f64; 2] = [0.8, 1.25];

/// Logarithm of the range of frequencies that unrelated lines fall into, three decades.
pub(super) const RANGE: f64 = 6.9;

/// Lines here and there that one shift brings together.
pub(super) struct Match {
    pub(super) shift: f64,
    pub(super) sd: f64,
    pub(super) pairs: Vec<(Log, Log)>,
}

impl Match {
    /// Lines that come together by `shift`, itself sure to `sd`; each at most once.
    pub(super) fn at(record: &[Log], reference: &[Log], shift: f64, sd: f64) -> Self {
        let mut near: Vec<(f64, usize, usize)> = Vec::new();
        for (i, here) in record.iter().enumerate() {
            for (j, there) in reference.iter().enumerate() {
                let z = (there.log - here.log - shift) / here.sd.hypot(there.sd).hypot(sd);
                if z.abs() < SAME {
                    near.push((z.abs(), i, j));
                }
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut used_here, mut used_there) =
            (vec![false; record.len()], vec![false; reference.len()]);
        let mut pairs = Vec::new();
        for (_, i, j) in near {
            if !used_here[i] && !used_there[j] {
                (used_here[i], used_there[j]) = (true, true);
                pairs.push((record[i], reference[j]));
            }
        }
        Self { shift, sd, pairs }
    }

    /// The shift that fits best what agrees with a proposal.
    pub(super) fn around(
        record: &[Log],
        reference: &[Log],
        proposal: f64,
        sd: f64,
    ) -> Option<Self> {
        let mut found = Self::at(record, reference, proposal, sd);
        for _ in 0..3 {
            let (mut sum, mut weight) = (0.0, 0.0);
            for (here, there) in &found.pairs {
                let one = (here.sd.powi(2) + there.sd.powi(2)).recip();
                sum += one * (there.log - here.log);
                weight += one;
            }
            if weight == 0.0 {
                return None;
            }
            found = Self::at(record, reference, sum / weight, weight.sqrt().recip());
        }
        (!found.pairs.is_empty()).then_some(found)
    }

    /// Log-likelihood of the pairs at this very shift over that of unrelated lines.
    pub(super) fn agreement(&self) -> f64 {
        self.pairs
            .iter()
            .map(|(here, there)| {
                let variance = here.sd.powi(2) + there.sd.powi(2);
                let miss = there.log - here.log - self.shift;
                (RANGE / (TAU * variance).sqrt()).ln() - 0.5 * miss * miss / variance
            })
            .sum()
    }

    /// Pairs that can have nothing to do with one another, and how sure the shift is: steady lines
    /// each by their own errors, lines that wander only once a source.
    pub(super) fn sources(&self) -> (usize, f64) {
        let lines: Vec<Log> = self.pairs.iter().map(|(_, there)| *there).collect();
        let source = sources(&lines);
        let count = source.iter().max().map_or(0, |last| last + 1);
        let mut weight = 0.0;
        for one in 0..count {
            let (mut steady, mut wandering) = (0.0, 0.0);
            for ((here, there), _) in self.pairs.iter().zip(&source).filter(|(_, of)| **of == one) {
                let own = (here.sd.powi(2) + there.sd.powi(2)).recip();
                if here.wanders || there.wanders {
                    wandering = f64::max(wandering, own);
                } else {
                    steady += own;
                }
            }
            weight += steady + wandering;
        }
        (count, f64::sqrt(weight).recip())
    }

    /// The same with the shift, log-uniform beforehand, integrated out.
    pub(super) fn evidence(&self) -> f64 {
        let before = (RATIOS[1] / RATIOS[0]).ln();
        self.agreement() + ((TAU.sqrt() * self.sd) / before).ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_one_of_a_pair_at_most() {
        let at = |log: f64| Log {
            log,
            sd: 1e-4,
            wanders: false,
        };
        let (one, two) = ([at(3.0)], [at(3.0001), at(2.9998)]);
        for (here, there) in [(&one[..], &two[..]), (&two, &one)] {
            let found = Match::at(here, there, 0.0, 0.0);
            assert_eq!(found.pairs.len(), 1);
            // The nearest.
            let (here, there) = found.pairs[0];
            assert!((here.log - there.log).abs() < 1.5e-4);
        }
    }
}
