//! The median and its likes: figures that a few wild values do not move.

/// The value that a `share` of all, from 0 to 1, lies below: the one at that place of the ascending
/// order, rounded down, without interpolation. `None` where there are no values. Reorders them.
pub fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let place = ((share * values.len() as f64) as usize).min(last);
    let (_, value, _) = values.select_nth_unstable_by(place, f64::total_cmp);
    Some(*value)
}

/// The middle value; of an even number the upper one of the two. `None` where there are no values.
/// Reorders them.
pub fn median(values: &mut [f64]) -> Option<f64> {
    quantile(values, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stand_where_sorting_puts_them() {
        for len in 1..40_usize {
            // Steps of 17 go through all of 0..len in disorder unless 17 divides it.
            let mut values: Vec<f64> = (0..len).map(|n| (17 * n % len) as f64).collect();
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            assert_eq!(median(&mut values), Some(sorted[len / 2]), "of {len}");
            let upper = quantile(&mut values, 0.75);
            assert_eq!(upper, Some(sorted[3 * len / 4]), "of {len}");
            assert_eq!(quantile(&mut values, 1.0), sorted.last().copied());
        }
        assert_eq!(median(&mut []), None);
    }

    #[test]
    fn a_wild_value_does_not_move_the_median() {
        assert_eq!(median(&mut [2.0, f64::INFINITY, 1.0]), Some(2.0));
    }
}
