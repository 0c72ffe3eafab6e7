//! How a record is written: doubles, codes, with samples missing.

use std::ops::Range;

use super::scene::SHORTEST;
use crate::hidden::case::Plan;
use crate::hidden::draw::Draw;

/// What the numbers are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Numbers {
    /// Doubles of any value.
    #[default]
    Doubles,
    /// Doubles that are multiples of a code.
    Codes,
    /// Integers, with the size of a code declared.
    Integers,
}

/// What is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Missing {
    /// Nothing.
    #[default]
    Nothing,
    /// One sample of a thousand.
    Single,
    /// Some stretches of up to a fiftieth.
    Stretches,
    /// Three samples of ten, at random.
    Third,
}

/// How a record is written.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Form {
    /// What the numbers are.
    pub numbers: Numbers,
    /// What is missing.
    pub missing: Missing,
    /// Size of a code over the typical difference between neighbours.
    pub code: f64,
}

impl Form {
    /// That of a seed. Codes of a hundredth to a third of the differences: coarser ones are an effect. None
    /// where the grid itself is hidden, or repeats and equal extremes, of which a grid has some by chance;
    /// nothing is missing where a record is compared with another or lacks samples without a trace.
    pub fn draw(plan: &Plan, seed: u64) -> Self {
        let mut draw = Draw::new(seed, &format!("{} form", plan.name()));
        let hides = |names: &[&str]| plan.kinds.iter().any(|kind| names.contains(&kind.name));
        let (numbers, missing) = (draw.index(4), draw.index(8));
        let code = draw.log_uniform(0.01, 0.3);
        Self {
            numbers: match numbers {
                _ if hides(&["quantisation", "stale", "clipping"]) => Numbers::Doubles,
                0 => Numbers::Codes,
                1 => Numbers::Integers,
                _ => Numbers::Doubles,
            },
            missing: match missing {
                _ if hides(&["dropped", "timebase"]) => Missing::Nothing,
                0 => Missing::Single,
                1 => Missing::Stretches,
                2 => Missing::Third,
                _ => Missing::Nothing,
            },
            code,
        }
    }

    /// Whether it is written as integers: they know no gaps.
    pub fn is_integer(&self) -> bool {
        self.numbers == Numbers::Integers && self.missing == Missing::Nothing
    }

    /// Size of a code over the typical difference between neighbours; zero where there are no codes.
    pub fn code_over_differences(&self) -> f64 {
        match self.numbers {
            Numbers::Doubles => 0.0,
            Numbers::Codes | Numbers::Integers => self.code,
        }
    }

    /// Rounds and loses samples, in no stretch more than half of what `happened` there; the size of a code, where there
    /// are any.
    pub fn settle(
        &self,
        columns: &mut [Vec<f64>],
        happened: &[Range<usize>],
        seed: u64,
    ) -> Option<f64> {
        let step = match self.numbers {
            Numbers::Doubles => None,
            _ => columns
                .first()
                .map(|column| self.code * differences(column)),
        };
        // Integers of 32 bits end somewhere.
        let most = columns
            .iter()
            .flatten()
            .fold(0.0, |most: f64, one| most.max(one.abs()));
        let step = step.map(|step| step.max(most / f64::from(i32::MAX / 2)));
        let mut draw = Draw::new(seed, "form");
        for column in columns {
            if let Some(step) = step {
                column
                    .iter_mut()
                    .for_each(|value| *value = (*value / step).round() * step);
            }
            self.lose(column, happened, &mut draw);
        }
        step
    }

    /// Share of so many samples that is missing, each by chance; never so much that too few count for a diagnosis.
    pub fn missing_at_random(&self, samples: usize) -> f64 {
        let spare = samples.saturating_sub(SHORTEST);
        // Two hundredths less than may go: four deviations of how many do.
        let most = (spare as f64 / samples as f64 - 0.02).max(0.0);
        match self.missing {
            Missing::Nothing | Missing::Stretches => 0.0,
            Missing::Single => most.min(1e-3),
            Missing::Third => most.min(0.3),
        }
    }

    /// Loses samples.
    fn lose(&self, column: &mut [f64], happened: &[Range<usize>], draw: &mut Draw) {
        let share = match self.missing {
            Missing::Nothing => return,
            Missing::Single | Missing::Third => self.missing_at_random(column.len()),
            Missing::Stretches => {
                let spare = column.len().saturating_sub(SHORTEST);
                let longest = (column.len() / 50).min(spare / 4);
                for _ in 0..=draw.index(4) {
                    let length = draw.index(longest + 1);
                    let from = draw.index(column.len() - length);
                    let lost = from..from + length;
                    if happened
                        .iter()
                        .all(|one| 2 * common(one, &lost) <= one.len())
                    {
                        column[lost].fill(f64::NAN);
                    }
                }
                return;
            }
        };
        for value in column {
            if draw.chance(share) {
                *value = f64::NAN;
            }
        }
    }
}

/// Samples that two stretches have in common.
fn common(one: &Range<usize>, other: &Range<usize>) -> usize {
    let (from, to) = (one.start.max(other.start), one.end.min(other.end));
    to.saturating_sub(from)
}

/// Typical difference between neighbouring samples, whatever a few are: the median of its size.
fn differences(samples: &[f64]) -> f64 {
    let sizes = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut sizes: Vec<f64> = sizes.filter(|size| *size > 0.0).collect();
    let middle = sizes.len() / 2;
    match sizes.is_empty() {
        true => 1.0,
        false => *sizes.select_nth_unstable_by(middle, f64::total_cmp).1,
    }
}
