//! A wrong sample rate: all lines of a record shifted by one factor against a reference.
//!
//! Lines stand at frequencies that do not care for the recorder's clock. If the true rate is `r`
//! times what a record says, all of them appear at `f / r`. Every pair of a line here and a line
//! there proposes a ratio; the one that most others agree with, within their errors, is fitted by
//! least squares. Its worth is the gain in log-likelihood over lines that have nothing to do with
//! one another (log-uniform over three decades), less what a right clock gains in the same way.
//!
//! Lines of one machine wander together: as many of them are no surer than the surest. And what
//! lines cannot decide is whether a machine itself turned faster, whose harmonics and side lines shift
//! together as well: [`Rate::sources`] counts those that can have nothing to do with one another.

use statrs::function::factorial::ln_binomial;

use super::mark::{Mark, logarithms};
use super::matching::{Match, RATIOS};
use crate::diagnosis::statistic::p_value;

/// A factor between what a record's clock says and what is true.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// True rate over the rate that the record says: a line of `f` appears at `f / ratio`.
    pub ratio: f64,
    /// Standard deviation of the ratio.
    pub ratio_sd: f64,
    /// How many lines agree on the ratio.
    pub matched: usize,
    /// Of these, how many are not multiples of one another. With one alone a machine that turned
    /// faster explains as much.
    pub sources: usize,
    /// Bound for the probability that as many agree by chance, or that the ratio is 1, whichever is larger.
    pub p_value: f64,
    /// Gain in log-likelihood over a clock that is right, or lines that are unrelated, whichever
    /// is better.
    pub nats: f64,
}

/// Looks for one factor between the lines of a record and of a reference at a family-wise `level`.
/// `None` where fewer than two lines agree.
pub fn ratio(record: &[Mark], reference: &[Mark], level: f64) -> Option<Rate> {
    let record = logarithms(record);
    let reference = logarithms(reference);
    let [low, high] = RATIOS.map(f64::ln);
    let mut proposals = Vec::new();
    for here in &record {
        for there in &reference {
            let shift = there.log - here.log;
            if (low..=high).contains(&shift) {
                proposals.push((shift, there.sd.hypot(here.sd)));
            }
        }
    }
    let best = proposals
        .iter()
        .filter_map(|&(shift, sd)| Match::around(&record, &reference, shift, sd))
        .max_by(|a, b| a.evidence().total_cmp(&b.evidence()))?;
    if best.pairs.len() < 2 {
        return None;
    }
    let (sources, sd) = best.sources();
    // Markov's inequality for the likelihood ratio, over the ways to choose as many pairs; a shift
    // keeps their order.
    let ways = ln_binomial(record.len() as u64, best.pairs.len() as u64)
        + ln_binomial(reference.len() as u64, best.pairs.len() as u64);
    let chance = (ways - best.evidence()).exp().min(1.0);
    let p_value = chance.max(p_value::two_sided(best.shift / sd));
    // A clock that is right has no ratio to fit.
    let right = Match::at(&record, &reference, 0.0, 0.0);
    let nats = best.evidence() - right.agreement().max(0.0);
    (p_value < level && nats > 0.0).then(|| Rate {
        ratio: best.shift.exp(),
        ratio_sd: best.shift.exp() * sd,
        matched: best.pairs.len(),
        sources,
        p_value,
        nats,
    })
}

/// Whether a line of a record and one of a reference agree with a rate.
pub fn agree(record: &[Mark], reference: &[Mark], rate: &Rate) -> bool {
    let (shift, sd) = (rate.ratio.ln(), rate.ratio_sd / rate.ratio);
    !Match::at(&logarithms(record), &logarithms(reference), shift, sd)
        .pairs
        .is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::timebase::matching::RANGE;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    /// Lines at `f_hz` over `ratio`, measured to the share `sd`.
    fn seen(random: &mut Gaussian, f_hz: &[f64], ratio: f64, sd: f64) -> Vec<Mark> {
        f_hz.iter()
            .map(|f_hz| steady(f_hz / ratio * (1.0 + sd * random.draw()), sd * f_hz))
            .collect()
    }

    fn steady(f_hz: f64, f_sd_hz: f64) -> Mark {
        Mark {
            f_hz,
            f_sd_hz,
            wanders: false,
        }
    }

    fn wandering(f_hz: f64, f_sd_hz: f64) -> Mark {
        Mark {
            wanders: true,
            ..steady(f_hz, f_sd_hz)
        }
    }

    #[test]
    fn the_ratio_is_found_within_its_error() {
        const RUNS: u64 = 200;
        let (mut squares, mut found) = (0.0, 0);
        for seed in 0..RUNS {
            let mut random = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
            // 0.2 to 5 %.
            let size = 0.002 * f64::exp(1.6 * random.draw().abs().min(2.0));
            let truth = 1.0 + size * random.draw().signum();
            let mut record = seen(&mut random, &[7.3, 31.0, 222.2], truth, 1e-4);
            let mut reference = seen(&mut random, &[7.3, 31.0, 222.2], 1.0, 1e-4);
            // Lines that only one of the two has, and one that is missing.
            record.extend([steady(400.0, 4e-2), steady(3.0, 3e-4)]);
            reference.extend([steady(55.0, 5e-3), steady(120.0, 1e-2), steady(61.0, 6e-3)]);
            let missing = (seed % 2) as usize;
            record.drain(..missing);
            // Two lines by themselves reach p = 5e-4, and 1e-2 unless their errors disagree by 2.5
            // sigma.
            let Some(rate) = ratio(&record, &reference, 1e-2) else {
                assert_eq!(missing, 1, "seed {seed}");
                continue;
            };
            found += 1;
            assert_eq!(rate.matched, 3 - missing, "seed {seed}");
            assert_eq!(rate.sources, rate.matched, "seed {seed}");
            squares += ((rate.ratio - truth) / rate.ratio_sd).powi(2);
        }
        // 1.2 % of the hundred: six or more have a chance of 1e-3.
        assert!(found + 6 > RUNS, "{found} of {RUNS}");
        // A mean of as many squares, 4 sigma; the floor on the errors takes 4 % of it.
        let mean = squares / found as f64;
        let tolerance = 4.0 * (2.0 / found as f64).sqrt();
        assert!((mean - 0.96).abs() < tolerance, "{mean}, seeds 0..{RUNS}");
    }

    #[test]
    fn a_right_clock_is_no_finding() {
        for seed in 0..200 {
            let mut random = Gaussian::new(Seed { seed, stream: 1 }, 1.0);
            let lines = [7.3, 50.0, 100.0, 222.2];
            let record = seen(&mut random, &lines, 1.0, 1e-4);
            let reference = seen(&mut random, &lines, 1.0, 1e-4);
            assert_eq!(ratio(&record, &reference, 1e-3), None, "seed {seed}");
            // A line that moved alone, next to one that stayed.
            let moved = seen(&mut random, &[7.3, 51.0], 1.0, 1e-4);
            assert_eq!(ratio(&moved, &reference, 1e-3), None, "seed {seed}");
        }
    }

    /// Lines at `f_hz`, known to the share `sd`.
    fn at(f_hz: &[f64], sd: f64) -> Vec<Mark> {
        f_hz.iter().map(|f_hz| steady(*f_hz, sd * f_hz)).collect()
    }

    #[test]
    fn a_pair_that_moved_beside_two_less_sure_lines_that_stayed_is_no_clock() {
        let stayed = at(&[7.3, 222.2], 1e-3);
        let moved = [at(&[20.0 / 1.05, 33.0 / 1.05], 1e-4), stayed.clone()].concat();
        let reference = [at(&[20.0, 33.0], 1e-4), stayed].concat();
        assert!(ratio(&moved[..2], &reference[..2], 1e-2).is_some());
        assert_eq!(ratio(&moved, &reference, 1e-2), None);
    }

    #[test]
    fn a_ratio_that_may_be_one_is_no_finding_however_many_agree() {
        // Six lines know the ratio to 6e-5, by which it is four and a half deviations off: 7e-6 by chance.
        let f_hz = [7.3, 31.0, 57.1, 101.7, 143.9, 222.2];
        let reference = at(&f_hz, 1e-4);
        let sd = 1e-4_f64.hypot(2e-5) / 3_f64.sqrt();
        let moved = f_hz.map(|f_hz| f_hz * (1.0 - 4.5 * sd));
        let found = |level: f64| ratio(&at(&moved, 1e-4), &reference, level);
        assert_eq!(found(1e-4).map(|rate| rate.matched), Some(6));
        assert_eq!(found(1e-6), None);
    }

    #[test]
    fn one_line_has_no_ratio() {
        let (here, there) = (at(&[20.0], 1e-4), at(&[21.0], 1e-4));
        assert_eq!(ratio(&here, &there, 0.5), None);
    }

    #[test]
    fn unrelated_lines_agree_at_most_as_often_as_the_level() {
        const LEVEL: f64 = 0.02;
        const RUNS: u64 = 3000;
        let mut found = 0;
        for seed in 0..RUNS {
            let mut random = Gaussian::new(Seed { seed, stream: 2 }, 1.0);
            let mut lines = |count: usize| -> Vec<Mark> {
                (0..count)
                    .map(|_| {
                        // Log-uniform over the three decades by the normal law's own.
                        let share = 1.0 - 0.5 * p_value::two_sided(random.draw().abs());
                        let f_hz = (RANGE * (2.0 * share - 1.0)).exp();
                        steady(f_hz, 1e-3 * f_hz)
                    })
                    .collect()
            };
            let (record, reference) = (lines(4), lines(4));
            found += u64::from(ratio(&record, &reference, LEVEL).is_some());
        }
        let mean = LEVEL * RUNS as f64;
        // 4 sigma of a Poisson number.
        assert!(
            (found as f64) < mean + 4.0 * mean.sqrt(),
            "{found} of {RUNS}, seeds 0..{RUNS}"
        );
    }

    #[test]
    fn a_machine_with_side_lines_is_one_source() {
        // Runs 3 and 1 of an ADIS16405 (SMAC-Group/imudata), each nominally at 100 Hz: a machine's
        // line, its harmonics, side lines at 0.10 Hz, and by how much they wander.
        let at = |lines: [f64; 6]| lines.map(|f_hz| wandering(f_hz, 2.5e-3));
        let record = at([0.4434, 0.5399, 0.6353, 1.5224, 1.6187, 2.6017]);
        let reference = at([0.4630, 0.5641, 0.6654, 1.5905, 1.6914, 2.7190]);
        let rate = ratio(&record, &reference, 1e-3).expect("six lines agree");
        assert_eq!((rate.matched, rate.sources), (6, 1));
        assert!((rate.ratio - 1.045).abs() < 2.0 * rate.ratio_sd, "{rate:?}");
        // Six lines that wander together are no surer than the fastest, 2.5e-3 sqrt(2) / 2.66.
        assert!((rate.ratio_sd / 1.045 - 1.33e-3).abs() < 2e-5, "{rate:?}");
        // A line of its own that agrees is a second source.
        let more = |lines: &[Mark], f_hz: f64| [lines, &[steady(f_hz, 1e-3)]].concat();
        let rate = ratio(&more(&record, 20.0 / 1.0448), &more(&reference, 20.0), 1e-3);
        assert_eq!(rate.expect("seven lines agree").sources, 2);
        // Two lines that do not agree are a source that moved.
        let record = [wandering(0.5399, 2.5e-3), wandering(19.73, 0.05)];
        let reference = [wandering(0.5641, 2.5e-3), wandering(20.19, 0.05)];
        assert_eq!(ratio(&record, &reference, 1e-3), None);
    }
}
