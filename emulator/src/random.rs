//! Seeded integer randomness: the same numbers on a Cortex-M4 and on a PC.

/// PCG-XSH-RR with 64 bits of state (O'Neill, 2014): 32 bits a call, one multiplication.
#[derive(Debug, Clone)]
pub(crate) struct Random {
    state: u64,
    increment: u64,
}

impl Random {
    /// A generator of its own for every pair of `seed` and `stream`.
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        // Both go through a mixer, so that neighbouring seeds share nothing.
        let mixed = mix(seed ^ mix(stream));
        Self {
            state: mix(mixed),
            increment: mix(mixed ^ u64::MAX) | 1,
        }
    }

    /// 32 random bits.
    pub(crate) fn next(&mut self) -> u32 {
        let old = self.state;
        self.state = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(self.increment);
        let folded = (((old >> 18) ^ old) >> 27) as u32;
        folded.rotate_right((old >> 59) as u32)
    }

    /// The sum of 16 uniform bytes less its mean: normal but for an excess kurtosis of -0.075,
    /// with a standard deviation of [`GAUSS_SIGMA`] and 6.9 of them at most.
    pub(crate) fn gauss(&mut self) -> i32 {
        let mut pairs = 0;
        for _ in 0..4 {
            let bits = self.next();
            pairs += (bits & 0x00FF_00FF) + ((bits >> 8) & 0x00FF_00FF);
        }
        (pairs & 0xFFFF) as i32 + (pairs >> 16) as i32 - 16 * 255 / 2
    }
}

/// Variance of a uniform byte: (256^2 - 1) / 12.
const BYTE_VARIANCE: f64 = 65_535.0 / 12.0;

/// Variance of [`Random::gauss`].
pub(crate) const GAUSS_VARIANCE: f64 = 16.0 * BYTE_VARIANCE;

/// Variance of the sum of two uniform bytes.
pub(crate) const PAIR_VARIANCE: f64 = 2.0 * BYTE_VARIANCE;

/// The finaliser of SplitMix64 (Steele, Lea, Flood, 2014).
fn mix(value: u64) -> u64 {
    let z = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_has_the_stated_moments() {
        let seed = 5;
        let mut random = Random::new(seed, 0);
        let n = 1_000_000;
        let (mut sum, mut square, mut fourth) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let x = f64::from(random.gauss()) / libm::sqrt(GAUSS_VARIANCE);
            sum += x;
            square += x * x;
            fourth += x * x * x * x;
        }
        let n = f64::from(n);
        // Five sigma of each mean: 1, sqrt(2) and sqrt(96) over sqrt(n).
        assert!((sum / n).abs() < 0.005, "seed {seed}: mean {}", sum / n);
        assert!(
            (square / n - 1.0).abs() < 0.007,
            "seed {seed}: variance {}",
            square / n
        );
        assert!(
            (fourth / n - 2.925).abs() < 0.05,
            "seed {seed}: kurtosis {}",
            fourth / n
        );
    }

    #[test]
    fn streams_and_seeds_differ() {
        let first = |seed, stream| Random::new(seed, stream).next();
        assert_ne!(first(1, 0), first(2, 0));
        assert_ne!(first(1, 0), first(1, 1));
        assert_eq!(first(1, 1), first(1, 1));
    }
}
