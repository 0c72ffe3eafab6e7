//! Misfortunes in random company: slips, resets, dead converters, brown-outs, a board that is held
//! up, frames that are lost, streams that end. Of every sample that the host hands on as good, the
//! converter's own word at that moment is the truth.
//!
//! ```text
//!   plan (from a seed) --> bench, firmware --> frames --> link ----> host's Frames --> samples
//!                            |                   |                                        |
//!                            +--> words by stamp +--> stamp by index ----> truth ---> equal, or flagged?
//! ```

mod bench;
mod channel;
mod class;
mod judge;
mod plan;

pub use bench::run;
pub use channel::Link;
pub use class::{Class, Kind};
pub use judge::{Outcome, Wrong};
pub use plan::{Act, Ending, Misfortune, Plan};

/// Random numbers: SplitMix64 (Steele, Lea and Flood 2014), so that a seed gives the same plan
/// whatever the libraries do.
#[derive(Debug, Clone)]
pub struct Dice(u64);

impl Dice {
    /// Dice that fall as this seed says.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number from 0 up to `n` - 1; `n` is not 0.
    pub fn below(&mut self, n: u64) -> u64 {
        self.word() % n
    }

    /// True once in `n` times; `n` is not 0.
    pub fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }

    /// One of these; there is one.
    pub fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len() as u64) as usize]
    }
}
