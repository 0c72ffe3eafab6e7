//! Steps of which nobody can say when they were.
//!
//! A step is sudden. Where its moment may lie anywhere in a good part of what is between it and the next one back, or the end of
//! the record, the level rose and fell slowly, as noise does.

use super::{Doubt, Hearing};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::record::wave::{Jump, Wave};
use crate::model::steps;
use crate::numeric::normal::TWO_SIDED_95;

/// Takes steps back of which the largest has no moment. No test: each was significant as a change of the level.
pub static DOUBT: Doubt = Doubt {
    tests: 0,
    why: "it rose slowly, at no moment",
    hear,
};

/// Length of the interval of a moment over the distance to what is next, at most: a choice. White noise dates a step that is just
/// significant to a tenth.
const LONGEST: f64 = 0.25;

fn hear(hearing: &mut Hearing<'_>) -> Result<(), NoFit> {
    if is_undated(hearing.axis) {
        hearing.take_course_back(steps::KIND)?;
    }
    Ok(())
}

/// Whether the largest step may have been at any moment of a good part of what is about it.
fn is_undated(axis: &AxisState) -> bool {
    let waves = axis
        .explanation(steps::KIND)
        .map_or(&[][..], Explanation::waves);
    let jumps = waves.iter().flat_map(|wave| match wave {
        Wave::Steps(jumps) => jumps.as_slice(),
        _ => &[],
    });
    let jumps: Vec<&Jump> = jumps.collect();
    let by_height = |a: &&&Jump, b: &&&Jump| a.height.abs().total_cmp(&b.height.abs());
    let Some(largest) = jumps.iter().max_by(by_height) else {
        return false;
    };
    // Steps the same way may be one that was found in parts.
    let back = jumps
        .iter()
        .filter(|jump| jump.height * largest.height < 0.0);
    let back = back.map(|jump| jump.index);
    let next = back.chain([0, axis.filled.len()]);
    let next = next.map(|index| index.abs_diff(largest.index)).min();
    next.is_some_and(|next| 2.0 * TWO_SIDED_95 * largest.index_sd > LONGEST * next as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::explanation::Change;
    use crate::diagnosis::trial::{axis, jump, no_course, short, take_in};
    use crate::model::kind::Kind;

    /// Kinds that are left of a level that is 2 higher between two steps, the first of which is dated so well, samples; the second
    /// is of this height.
    fn left(seed: u64, index_sd: f64, second: f64) -> Vec<Kind> {
        let len = short(seed);
        let (up, down) = (len / 3, len / 2);
        let mut axis = axis(seed, len, |n, noise| {
            let after = if n >= down { second } else { 0.0 };
            noise + after + if n >= up { 2.0 } else { 0.0 }
        });
        let waves = [(up, 2.0, index_sd), (down, second, 1.0)].map(|(index, height, index_sd)| {
            let Wave::Steps(mut jumps) = jump(index, height) else {
                panic!("no step");
            };
            jumps[0].index_sd = index_sd;
            jumps.remove(0)
        });
        take_in(
            &mut axis,
            steps::KIND,
            Change::Waves(vec![Wave::Steps(waves.to_vec())]),
        );
        let gone = no_course(&DOUBT, &mut axis);
        assert_eq!(gone.is_none(), axis.has(steps::KIND), "seed {seed}");
        axis.kinds()
    }

    #[test]
    fn a_step_without_a_moment_goes() {
        for seed in 1..4 {
            let between = short(seed) as f64 / 6.0;
            let dated = left(seed, 0.01 * between, -1.9);
            assert_eq!(dated, [steps::KIND], "seed {seed}: dated");
            assert_eq!(left(seed, 0.1 * between, -1.9), [], "seed {seed}: undated");
            let up_twice = left(seed, 0.1 * between, 1.9);
            assert_eq!(up_twice, [steps::KIND], "seed {seed}: up twice");
        }
    }
}
