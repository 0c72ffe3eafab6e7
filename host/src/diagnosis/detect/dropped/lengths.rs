//! How many samples were lost: each number that may be the best looked at closely, and which one to name.

use super::demodulate::Blocks;
use super::line::{Line, Turned, fitted};
use super::moment::{Best, Posterior, Quiet, zoom};
use super::sample;
use super::tables::{AS_GOOD, Tables};

/// A length looked at closely.
pub(super) struct Found {
    pub(super) best: Best,
    /// What is known of the moment, samples.
    pub(super) moment: Posterior,
    pub(super) turned: Vec<Turned>,
    /// Gain in log-likelihood over no lines at all.
    pub(super) gain: f64,
}

impl Found {
    /// Gain in log-likelihood over steady lines, nats.
    pub(super) fn nats(&self, lines: &[Line]) -> f64 {
        self.gain - lines.iter().map(|line| line.gain).sum::<f64>()
    }

    fn new(
        blocks: &Blocks,
        quiet: &Quiet<'_>,
        lines: &[Line],
        tables: &Tables,
        best: Best,
    ) -> Self {
        let mut moment = tables.moment(best.samples, blocks.len);
        let mut turned = fitted(lines, best.place as f64, best.samples);
        if moment.sd < blocks.len as f64 {
            moment = zoom(blocks, quiet, lines, &turned, best);
            let at =
                |moment: Posterior| fitted(lines, moment.middle / blocks.len as f64, best.samples);
            turned = at(moment);
            if let Some(exact) = sample::moment(quiet.whole, blocks.len, lines, &turned, moment) {
                moment = exact;
                turned = at(moment);
            }
        }
        Self {
            best,
            moment,
            gain: turned.iter().map(|turned| turned.gain).sum(),
            turned,
        }
    }

    /// First sample after the loss.
    pub(super) fn index(&self) -> usize {
        self.moment.middle.round() as usize
    }
}

/// Gains of all moments and lengths, and the best of them looked at closely.
pub(super) fn looked(
    blocks: &Blocks,
    quiet: &Quiet<'_>,
    lines: &[Line],
    longest: usize,
) -> (Tables, Vec<Found>) {
    let tables = Tables::new(lines, longest);
    let found = tables
        .candidates()
        .into_iter()
        .map(|best| Found::new(blocks, quiet, lines, &tables, best))
        .collect();
    (tables, found)
}

/// Mean square distance of `value` among all that was looked at, each by its likelihood, from that
/// of the one chosen.
pub(super) fn between(found: &[Found], chosen: usize, value: impl Fn(&Found) -> f64) -> f64 {
    let here = value(&found[chosen]);
    let (mut sum, mut weights) = (0.0, 0.0);
    for one in found {
        let weight = (one.gain - found[chosen].gain).exp();
        sum += weight * (value(one) - here).powi(2);
        weights += weight;
    }
    sum / weights
}

/// Which of the lengths, ascending, to name: the best of the smallest that are as good and adjoin
/// one another; with the interval that these make.
pub(super) fn smallest_of_the_best(found: &[Found]) -> Option<(usize, f64, f64)> {
    let highest = found
        .iter()
        .map(|one| one.gain)
        .fold(f64::NEG_INFINITY, f64::max);
    let good: Vec<usize> = (0..found.len())
        .filter(|&one| found[one].gain > highest - AS_GOOD)
        .collect();
    let samples = |one: usize| found[one].best.samples;
    let run = good
        .chunk_by(|&a, &b| samples(b) == samples(a) + 1)
        .next()?;
    let chosen = run
        .iter()
        .copied()
        .max_by(|&a, &b| found[a].gain.total_cmp(&found[b].gain))?;
    Some((
        chosen,
        samples(run[0]) as f64 - 0.5,
        samples(run[run.len() - 1]) as f64 + 0.5,
    ))
}
