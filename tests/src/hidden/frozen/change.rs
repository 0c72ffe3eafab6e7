//! What is done to a judge's record before it is frozen.

use std::ops::Range;

use crate::hidden::case::Case;
use crate::hidden::draw::Draw;
use crate::hidden::judge::trial::Task;

/// Longest stretch of missing samples, as a share of the record.
const LONGEST_GAP: f64 = 0.02;

/// What becomes of a record.
#[derive(Clone)]
pub enum Change {
    /// It stays as it is.
    None,
    /// It stays as it is; its length is what it is here for.
    Length,
    /// Only so many samples of it are left.
    First(usize),
    /// It becomes integer codes with steps of so many root mean squares of the differences
    /// between neighbouring samples.
    Codes {
        /// That many.
        steps: f64,
    },
    /// Samples become NaN.
    Gaps {
        /// Stretches of many.
        stretches: usize,
        /// Single ones.
        single: usize,
    },
    /// It gets the temperature and the reference record of another case.
    Beside(Task),
}

impl Change {
    /// What it adds to the record's name.
    pub fn suffix(&self) -> String {
        match self {
            Self::None => String::new(),
            Self::Length => "-odd".to_owned(),
            Self::First(samples) => format!("-first-{samples}"),
            Self::Codes { .. } => "-codes".to_owned(),
            Self::Gaps { .. } => "-gaps".to_owned(),
            Self::Beside(task) => format!("-beside-{}", task.plan.name()),
        }
    }

    /// Does it; the size of a code's step where there are codes now.
    pub fn apply(&self, case: &mut Case) -> Option<f64> {
        match self {
            Self::None | Self::Length => {}
            Self::First(samples) => {
                let columns = case.columns.iter_mut();
                columns.for_each(|column| column.truncate(*samples));
            }
            Self::Codes { steps } => return Some(steps * differences(&case.columns[0])),
            Self::Gaps { stretches, single } => {
                let mut draw = Draw::new(case.seed, "gaps");
                for column in &mut case.columns {
                    for gap in gaps(column.len(), *stretches, *single, &mut draw) {
                        column[gap].fill(f64::NAN);
                    }
                }
            }
            Self::Beside(task) => {
                let other = Case::draw(&task.plan, task.seed);
                case.temperature = other.temperature;
                case.reference = other.reference;
            }
        }
        None
    }
}

/// Where samples are missing.
fn gaps(samples: usize, stretches: usize, single: usize, draw: &mut Draw) -> Vec<Range<usize>> {
    let longest = (LONGEST_GAP * samples as f64) as usize;
    let mut gap = |length: usize| {
        let start = draw.index(samples - length);
        start..start + length
    };
    let lengths = (0..stretches).map(|i| longest / (i + 1));
    lengths
        .chain(std::iter::repeat_n(1, single))
        .map(&mut gap)
        .collect()
}

/// Root mean square of the differences between neighbouring samples.
fn differences(samples: &[f64]) -> f64 {
    let squares = samples.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    (squares.sum::<f64>() / (samples.len() - 1) as f64).sqrt()
}
