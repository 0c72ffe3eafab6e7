//! Single samples that stand out because the level jumps there.

use super::steps;
use crate::diagnosis::detect::look::Look;
use crate::diagnosis::record::wave::Outlier;
use crate::diagnosis::statistic::matched_filter::Transform;

/// Those of some outliers that were `found` which are no jumps, in a record with what is put `back`: all of them unless most are
/// jumps, or the level is known to switch. Of many outliers some come by chance as a jump would have them.
pub fn without(
    look: &Look<'_>,
    found: Vec<Outlier>,
    back: &[Outlier],
    density: &[f64],
) -> Vec<Outlier> {
    let moved = without_single(look, back, &found, density);
    let jumps = steps::statistic(look.axis, &moved, density);
    let (of_jumps, others): (Vec<_>, Vec<_>) =
        (found.iter().copied()).partition(|one| steps::is_jump(&jumps, one));
    if look.character.level_switches || of_jumps.len() > others.len() {
        others
    } else {
        found
    }
}

/// The record in which jumps are asked for, with what is put `back`: without what was found, which goes up and down by itself, but
/// where some are next to each other. A jump is larger as a jump than as single samples, and some of these are made of it.
fn without_single(
    look: &Look<'_>,
    back: &[Outlier],
    found: &[Outlier],
    density: &[f64],
) -> Transform {
    /// Samples between two that are next to each other: as far as a jump is misplaced.
    const NEXT: usize = 4;
    let mut places: Vec<usize> = found.iter().map(|one| one.index).collect();
    places.sort_unstable();
    let is_single = |one: &&Outlier| {
        let near = one.index.saturating_sub(NEXT)..=one.index + NEXT;
        let from = places.partition_point(|place| place < near.start());
        places[from..]
            .iter()
            .take_while(|place| near.contains(place))
            .count()
            == 1
    };
    let single = found.iter().filter(is_single);
    let less = single.map(|one| Outlier {
        size: -one.size,
        ..*one
    });
    let moved: Vec<Outlier> = back.iter().copied().chain(less).collect();
    look.axis.with(&moved, density)
}
