//! Figures of the normal law.

/// Standard deviations to either side of the mean within which 95 % of normal numbers lie.
pub const TWO_SIDED_95: f64 = 1.959_963_984_540_054;

/// Standard deviations above the mean below which 95 % of normal numbers lie.
pub const ONE_SIDED_95: f64 = 1.644_853_626_951_472;

#[cfg(test)]
mod tests {
    use statrs::distribution::{ContinuousCDF, Normal};

    use super::*;

    #[test]
    fn hold_what_their_names_say() {
        let beyond = |sigmas| Normal::standard().sf(sigmas);
        assert!((2.0 * beyond(TWO_SIDED_95) - 0.05).abs() < 1e-9);
        assert!((beyond(ONE_SIDED_95) - 0.05).abs() < 1e-9);
    }
}
