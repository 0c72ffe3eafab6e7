//! The board's estimator: Allan variance alone, one conversion at a time.

use crate::block::Scratch;
use crate::engine::Engine;
use crate::grid::BLOCK;
use crate::sums::AllanSums;
use crate::{Estimate, Statistic};

/// [`AllanBins`] as the board holds them: at most 16 KiB, averaging times to 40 * 2^22 samples
/// (11.6 h at 4000/s).
pub type BoardBins = AllanBins<22>;

/// Streaming Allan variance at four averaging times an octave, from 1 to `40 * 2^LEVELS` samples.
///
/// 1.6 KiB and 640 bytes a level. A conversion costs at most 17 + 4 differences, squared and added
/// in integers; a gap at most four more a level, once. Nothing rounds and nothing overflows,
/// whatever the codes. `LEVELS` is at most 25, checked at compile time.
///
/// ```
/// use inm_allan::AllanBins;
/// let mut bins = AllanBins::<4>::new();
/// for code in [3, 1, 4, 1, 5] {
///     bins.push(code);
/// }
/// bins.skip(2); // two conversions were lost
/// bins.push(9);
/// assert_eq!(bins.next_index(), 8);
/// assert_eq!(bins.points().next().unwrap().terms, 4);
/// ```
#[derive(Debug, Clone)]
pub struct AllanBins<const LEVELS: usize> {
    engine: Engine<AllanSums, LEVELS>,
}

impl<const LEVELS: usize> AllanBins<LEVELS> {
    /// Empty, the first sample having index 0.
    #[must_use]
    pub const fn new() -> Self {
        Self::starting_at(0)
    }

    /// Empty, the first sample having absolute index `first`.
    ///
    /// Differences at long averaging times are taken at multiples of their stride in absolute
    /// indices, so that bins started apart agree on where they lie.
    #[must_use]
    pub const fn starting_at(first: u64) -> Self {
        const {
            assert!(LEVELS <= 25, "a difference must fit 63 bits");
        };
        Self {
            engine: Engine::new(first),
        }
    }

    /// Begins anew with absolute index `first`. Unlike assigning new bins it touches a quarter of
    /// their memory and needs no stack for a second copy.
    pub fn restart(&mut self, first: u64) {
        self.engine.restart(first);
    }

    /// Accepts the code of one conversion.
    #[inline]
    pub fn push(&mut self, code: i32) {
        self.engine.push(i64::from(code));
    }

    /// Accepts a run of codes; the result is the same bits as pushing them one by one.
    ///
    /// For hosts: needs about 110 KiB of stack.
    pub fn push_slice(&mut self, codes: &[i32]) {
        let mut scratch = Scratch::EMPTY;
        for block in codes.chunks(BLOCK) {
            let codes = block.iter().map(|&code| i64::from(code));
            self.engine
                .push_block(&mut scratch, codes, u64::from(u32::MAX), |_, _| {});
        }
    }

    /// Passes over `missing` conversions that were lost or flagged: a gap. Zero is no gap.
    pub fn skip(&mut self, missing: u64) {
        self.engine.skip(missing);
    }

    /// Absolute index of the next sample.
    #[must_use]
    pub fn next_index(&self) -> u64 {
        self.engine.next
    }

    /// Samples accepted, without the missing ones.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.engine.samples
    }

    /// The Allan variance at every averaging time that has a difference, shortest first.
    pub fn points(&self) -> impl Iterator<Item = Estimate> + '_ {
        self.engine.points(Statistic::Allan)
    }

    /// A fingerprint of everything accumulated: bins that were fed the same codes with the same
    /// gaps from the same index have the same digest, and others different ones but for chance of
    /// about 2^-64.
    ///
    /// 64-bit words enter in the order: next index, index at which the current run began, samples,
    /// sum of the codes, then for each averaging time the number of differences and the three
    /// words of the sum of their squares, lowest first. A word `w` takes the digest `h`
    /// from zero to `(rotate_left(h, 29) ^ w) * 0x9E37_79B9_7F4A_7C15` modulo 2^64; the result is
    /// `h ^ (h >> 32)`. Differences of levels whose turn is still to come are not included: they
    /// are a function of the codes and the index, too.
    #[must_use]
    pub fn digest(&self) -> u64 {
        self.engine.digest()
    }
}

impl<const LEVELS: usize> Default for AllanBins<LEVELS> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_that_were_used_before_are_like_new() {
        const SAMPLES: u64 = if cfg!(miri) { 100 } else { 9000 };
        let mut state = 7_u64;
        let mut code = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 32) as i32
        };
        let mut used = AllanBins::<6>::new();
        (0..SAMPLES).for_each(|_| used.push(code()));
        used.restart(9077);
        let mut new = AllanBins::<6>::starting_at(9077);
        for i in 0..SAMPLES {
            assert_eq!(used.digest(), new.digest(), "after {i}");
            let code = code();
            used.push(code);
            new.push(code);
        }
        assert_eq!(used.samples(), SAMPLES);
        assert!(used.points().eq(new.points()));
    }

    #[test]
    fn board_bins_fit_their_budget() {
        assert!(
            size_of::<BoardBins>() <= 16 * 1024,
            "{}",
            size_of::<BoardBins>()
        );
    }
}
