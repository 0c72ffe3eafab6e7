//! Runs of samples that are there, and what is left of them without others.

use std::ops::Range;

/// Runs of the numbers up to `len` of which `is_there` is true.
pub fn runs_of(len: usize, is_there: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut from = 0;
    while let Some(start) = (from..len).find(|n| is_there(*n)) {
        let end = (start..len).find(|n| !is_there(*n)).unwrap_or(len);
        runs.push(start..end);
        from = end;
    }
    runs
}

/// Runs less the `holes` in them; both ascending and disjoint.
pub fn without(runs: &[Range<usize>], holes: &[Range<usize>]) -> Vec<Range<usize>> {
    let mut left = Vec::new();
    for run in runs {
        let mut from = run.start;
        let first = holes.partition_point(|hole| hole.end <= run.start);
        for hole in holes[first..]
            .iter()
            .take_while(|hole| hole.start < run.end)
        {
            if hole.start > from {
                left.push(from..hole.start);
            }
            from = from.max(hole.end);
        }
        if from < run.end {
            left.push(from..run.end);
        }
    }
    left
}

/// The part of a window that its taper lets through: the middle half, and an end of it where the run ends.
pub fn middle(start: usize, len: usize, runs: &[Range<usize>]) -> Range<usize> {
    let run = &runs[runs.partition_point(|run| run.end <= start)];
    let from = if start == run.start {
        start
    } else {
        start + len / 4
    };
    let end = start + len;
    let to = if end == run.end { end } else { end - len / 4 };
    from..to
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_part_runs() {
        let runs = without(&[0..100, 120..200], &[10..20, 90..130, 190..300]);
        assert_eq!(runs, [0..10, 20..90, 130..190]);
        assert!(without(&[0..10], &[0..10]).is_empty());
    }
}
