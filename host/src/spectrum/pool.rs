//! Neighbouring bins as one, where single ones know too little to be looked at.

use std::ops::Range;

/// Runs of neighbouring bins with `least` degrees of freedom or more together (the last may have
/// fewer), each with the sum of its degrees of freedom.
pub fn runs(edf: impl IntoIterator<Item = f64>, least: f64) -> Vec<(Range<usize>, f64)> {
    let mut runs: Vec<(Range<usize>, f64)> = Vec::new();
    for (bin, edf) in edf.into_iter().enumerate() {
        match runs.last_mut() {
            Some((run, sum)) if *sum < least => {
                run.end = bin + 1;
                *sum += edf;
            }
            _ => runs.push((bin..bin + 1, edf)),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pools_until_enough() {
        let runs = runs([3.0, 5.0, 9.0, 2.0], 8.0);
        assert_eq!(runs, [(0..2, 8.0), (2..3, 9.0), (3..4, 2.0)]);
    }
}
