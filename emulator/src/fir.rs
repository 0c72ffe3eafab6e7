//! Decimating FIR stages in integers: 32-bit words between them, 64-bit accumulation inside.
//!
//! Widths and rounding inside the part are not public. Here each stage rounds to nearest (ties
//! up) to the step of the 31-bit code and saturates at 32 bits, which leaves 6 dB above full
//! scale for the filters' overshoot. The rounding noise of a stage is 0.29 steps, 0.7 nV at VREF
//! = 5 V, a hundredth of the part's own noise.

/// A stage's memory: `LEN` = taps - 1 past inputs and one block of new ones behind them.
#[derive(Debug, Clone)]
pub(crate) struct Line<const LEN: usize> {
    words: [i32; LEN],
}

impl<const LEN: usize> Line<LEN> {
    /// A line full of zeros.
    pub(crate) const fn new() -> Self {
        Self { words: [0; LEN] }
    }

    /// Forgets the oldest `BLOCK` words and returns the room behind the others for new ones.
    pub(crate) fn advance<const BLOCK: usize>(&mut self) -> &mut [i32; BLOCK] {
        const { assert!(BLOCK <= LEN) };
        self.words.copy_within(BLOCK.., 0);
        self.words.last_chunk_mut().expect("BLOCK <= LEN")
    }

    /// The `TAPS` words that the output at `index` of the newest block is made of.
    pub(crate) fn window<const TAPS: usize>(
        &self,
        index: usize,
        decimation: usize,
    ) -> &[i32; TAPS] {
        let start = (index + 1) * decimation - 1;
        self.words[start..]
            .first_chunk()
            .expect("a line holds taps - 1 words ahead of its block")
    }
}

/// Rounds `sum` / 2^`shift` to nearest and saturates.
pub(crate) fn round(sum: i64, shift: u32) -> i32 {
    let rounded = (sum + (1 << (shift - 1))) >> shift;
    rounded.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
}

/// Inner product with a symmetric filter of odd length: one product for two taps.
pub(crate) fn symmetric<const TAPS: usize>(window: &[i32; TAPS], taps: &[i32; TAPS]) -> i64 {
    let centre = TAPS / 2;
    let mut sum = i64::from(window[centre]) * i64::from(taps[centre]);
    for i in 0..centre {
        sum += (i64::from(window[i]) + i64::from(window[TAPS - 1 - i])) * i64::from(taps[i]);
    }
    sum
}

/// As [`symmetric`] for a half-band filter: every odd tap but the centre is zero and left out.
pub(crate) fn half_band<const TAPS: usize>(window: &[i32; TAPS], taps: &[i32; TAPS]) -> i64 {
    let centre = TAPS / 2;
    let mut sum = i64::from(window[centre]) * i64::from(taps[centre]);
    let mut i = 0;
    while i < centre {
        sum += (i64::from(window[i]) + i64::from(window[TAPS - 1 - i])) * i64::from(taps[i]);
        i += 2;
    }
    sum
}

/// Convolution with any filter. The window runs from the oldest word, the taps from the newest.
pub(crate) fn general<const TAPS: usize>(window: &[i32; TAPS], taps: &[i32; TAPS]) -> i64 {
    window
        .iter()
        .zip(taps.iter().rev())
        .map(|(&word, &tap)| i64::from(word) * i64::from(tap))
        .sum()
}
