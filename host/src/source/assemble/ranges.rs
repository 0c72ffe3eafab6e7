//! Ascending disjoint ranges of samples that must not be used.

use std::ops::Range;

/// Adds `range` to ascending disjoint ranges; it may overlap any of them.
pub(super) fn mark(ranges: &mut Vec<Range<usize>>, range: Range<usize>) {
    if range.is_empty() {
        return;
    }
    let mut merged = range;
    let from = ranges.partition_point(|r| r.end < merged.start);
    let to = ranges.partition_point(|r| r.start <= merged.end);
    if let Some(overlap) = ranges.get(from..to).filter(|r| !r.is_empty()) {
        merged.start = merged.start.min(overlap[0].start);
        merged.end = merged.end.max(overlap[overlap.len() - 1].end);
    }
    ranges.splice(from..to, [merged]);
}

/// Takes what lies before `at` out of `ranges`; the rest is renumbered from there.
pub(super) fn split_ranges(ranges: &mut Vec<Range<usize>>, at: usize) -> Vec<Range<usize>> {
    let before = ranges
        .iter()
        .filter(|r| r.start < at)
        .map(|r| r.start..r.end.min(at))
        .collect();
    let after = ranges
        .iter()
        .filter(|r| r.end > at)
        .map(|r| r.start.max(at) - at..r.end - at)
        .collect();
    *ranges = after;
    before
}
