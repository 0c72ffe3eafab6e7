//! What speaks for a loss, and whether something that looks like one speaks as well.
//!
//! **Look-alikes.** One line that changes its phase by itself: without the line that speaks loudest
//! for the loss the others must still be for it, over the lengths which that one leaves open. Lines
//! that wander or beat: the loss must explain nearly all that steady lines leave.

use super::demodulate::Blocks;
use super::lengths::{Found, between, smallest_of_the_best};
use super::line::{LINE_REACH, Line, Turned, fitted};
use super::loss::{Loss, SteadyLine};
use super::tables::{Tables, log_sum};

/// Logarithm of the odds that the lines but the loudest must give, 20 to 1.
const ODDS: f64 = 3.0;

/// Cycles a record on either side of a line where the loss must explain what is there: a choice.
pub(super) const AROUND_LINE: usize = 16;

/// Largest share of what a loss explains that may remain unexplained: a choice.
const LEFT_SHARE: f64 = 0.1;

/// What speaks for a loss.
pub(super) struct Case<'a> {
    pub(super) blocks: &'a Blocks,
    pub(super) lines: &'a [Line],
    /// Longest loss that is looked for, samples.
    pub(super) longest: usize,
    pub(super) tables: &'a Tables,
    pub(super) found: &'a [Found],
}

impl Case<'_> {
    /// The loss, if it is significant at a `level` and no look-alike.
    pub(super) fn judged(&self, level: f64) -> Option<Loss> {
        let (chosen, samples_lo, samples_hi) = smallest_of_the_best(self.found)?;
        let Found {
            best,
            moment,
            ref turned,
            ..
        } = self.found[chosen];
        let pairs = || turned.iter().zip(self.lines);
        let gains: Vec<f64> = pairs()
            .map(|(turned, line)| turned.gain - line.gain)
            .collect();
        let nats: f64 = gains.iter().sum();
        // The tables rest on blocks and on a parabola in frequency; the last word is the fit's.
        let highest = self.tables.sum.iter().copied().fold(f64::MIN, f64::max);
        let p_value = (highest - self.tables.mean_ratio() - nats).exp().min(1.0);
        let loudest = (0..gains.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b]))?;
        let middle = moment.middle / self.blocks.len as f64;
        let others = others(self.lines, loudest, middle, self.longest);
        let left: f64 = pairs()
            .map(|(turned, line)| {
                line.seen
                    .left_over(turned.offset, Some(turned.turn), AROUND_LINE)
            })
            .sum();
        // Noise leaves as many as there are ordinates, with that variance.
        let spread = ((2 * AROUND_LINE + 1) as f64 * self.lines.len() as f64).sqrt();
        let explained = left < LEFT_SHARE * nats + 3.0 * spread;
        let lines = (0..self.lines.len()).map(|which| self.steady(chosen, which));
        (p_value < level && others > ODDS && explained).then(|| Loss {
            index: self.found[chosen].index(),
            index_sd: moment.sd,
            index_lo: moment.lo,
            index_hi: moment.hi,
            samples: best.samples as u32,
            samples_lo,
            samples_hi,
            nats,
            held_nats: held(self.lines, self.longest),
            p_value,
            // A harmonic that was only tried for is one if it is no chance.
            lines: lines.filter(|line| line.false_alarm() < level).collect(),
        })
    }

    /// Line number `which` of the chosen length.
    fn steady(&self, chosen: usize, which: usize) -> SteadyLine {
        let (turned, line) = (&self.found[chosen].turned[which], &self.lines[which]);
        let cycles = |turned: &Turned| line.cycles(turned.offset, self.blocks.len);
        SteadyLine {
            cycles: cycles(turned),
            cycles_sd: between(self.found, chosen, |one| cycles(&one.turned[which])).sqrt(),
            cosine: turned.amplitude.re,
            sine: -turned.amplitude.im,
            amplitude_sd: between(self.found, chosen, |one| one.turned[which].amplitude.norm())
                .sqrt(),
            nats: turned.gain,
        }
    }
}

/// Logarithm of the odds that the other lines give for a loss at `place`, over the lengths that one
/// line by itself leaves open, each by what it is worth to that one. By the fits themselves: to a
/// strong line the rest of a block is worth more than all of a weak one.
pub(crate) fn others(lines: &[Line], loudest: usize, place: f64, longest: usize) -> f64 {
    let (mut all, mut alone) = (Vec::new(), Vec::new());
    for samples in 1..=longest {
        let turned = fitted(lines, place, samples);
        let gain = |line: usize| turned[line].gain - lines[line].gain;
        all.push((0..lines.len()).map(gain).sum());
        alone.push(gain(loudest));
    }
    log_sum(&all) - log_sum(&alone)
}

/// Gain on every second block of what was fitted to the others.
pub(crate) fn held(lines: &[Line], longest: usize) -> f64 {
    let seen: Vec<Line> = lines
        .iter()
        .map(|line| {
            let half = line.seen.every_second(0);
            let (offset, gain) = half.best_offset(line.offset, LINE_REACH, None);
            let seen = half;
            Line { seen, offset, gain }
        })
        .collect();
    let tables = Tables::new(&seen, longest);
    let candidates = tables.candidates();
    let Some(best) = candidates.iter().max_by(|a, b| a.gain.total_cmp(&b.gain)) else {
        return 0.0;
    };
    let turned = fitted(&seen, best.place as f64, best.samples);
    lines
        .iter()
        .zip(&seen)
        .zip(&turned)
        .map(|((line, seen), turned)| {
            let other = line.seen.every_second(1);
            let (steady, _) = seen.seen.line(seen.offset, None);
            other.log_likelihood(turned.amplitude, turned.offset, Some(turned.turn))
                - other.log_likelihood(steady, seen.offset, None)
        })
        .sum()
}
