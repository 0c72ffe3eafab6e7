//! Groups of ordinates that are followed over time, each a quarter of an octave.

use std::ops::Range;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::steady::tiles::{counting, known, over, strengths};

/// First ordinate that is looked at, a power of two, and groups an octave.
const FIRST: usize = 256;
const PER_OCTAVE: usize = 4;

/// Strengths of the whitened record, group by group of ordinates.
pub(super) struct Tiles {
    /// The groups, ascending.
    pub groups: Vec<Group>,
}

/// Neighbouring ordinates.
pub(super) struct Group {
    /// Their middle, hertz.
    pub f_hz: f64,
    /// Sum of the strengths, over their mean, and their number: moment by moment, or in as many even
    /// parts of the record as there are of the finest blocks.
    pub parts: Vec<[f64; 2]>,
}

impl Tiles {
    /// Of what is left of an axis, for `finest` blocks of time.
    pub fn new(axis: &AxisState, finest: usize) -> Self {
        let seen = axis.whitened();
        let mut groups = Vec::new();
        let mut octave = FIRST;
        while octave < seen.top {
            let size = octave / PER_OCTAVE;
            let counts = counting(axis, seen.transform.len(), size);
            let explained = known(axis, seen.transform.len(), size);
            for part in 0..PER_OCTAVE {
                let start = octave + part * size;
                let known = |range: Range<usize>| seen.density[range].iter().all(|s| s.is_finite());
                if start + size > seen.top || !known(start..start + size) {
                    continue;
                }
                let mut strengths = strengths(&seen, start..start + size);
                over(axis, &mut strengths, &explained, &(start..start + size));
                let moments = size.div_ceil(finest);
                let both = strengths.chunks(moments).zip(counts.chunks(moments));
                let mut parts: Vec<[f64; 2]> = both
                    .map(|(strengths, counts)| {
                        let good = strengths.iter().zip(counts).filter(|(_, counts)| **counts);
                        good.fold([0.0; 2], |[sum, count], (one, _)| [sum + one, count + 1.0])
                    })
                    .collect();
                let sum: f64 = parts.iter().map(|[sum, _]| sum).sum();
                let count: f64 = parts.iter().map(|[_, count]| count).sum();
                if sum > 0.0 {
                    parts.iter_mut().for_each(|[one, _]| *one *= count / sum);
                    groups.push(Group {
                        f_hz: seen.transform.frequency(start + size / 2),
                        parts,
                    });
                }
            }
            octave *= 2;
        }
        Self { groups }
    }
}
