//! Where something monotonous changes.

/// The upper end of what is left between `low`, where `is_below` holds, and `high`, where it does
/// not, after so many `halvings`: 50 leave 1e-15 of the distance.
pub fn bisect(low: f64, high: f64, halvings: u32, is_below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        if is_below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// The same between two positive numbers whose size is not known: halves the logarithm until both
/// ends agree within `close`, a small fraction.
pub fn bisect_ratio(low: f64, high: f64, close: f64, is_below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    while high / low > 1.0 + close {
        let middle = (low * high).sqrt();
        if is_below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn find_the_root_of_two_from_above() {
        let is_below = |x: f64| x * x < 2.0;
        let root = bisect(0.0, 10.0, 50, is_below);
        assert!((0.0..2e-14).contains(&(root - 2_f64.sqrt())), "{root}");
        let root = bisect_ratio(1e-6, 1e6, 1e-3, is_below);
        assert!(!is_below(root) && is_below(root / 1.001), "{root}");
    }
}
