//! A 32-bit hardware timer made 64 bits wide in software.

/// Extends readings of a free-running 32-bit counter.
///
/// Correct as long as readings come in order and at least once in each turn of the counter
/// (51 s at 84 MHz).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ticks {
    last: u64,
}

impl Ticks {
    /// Starts at 0.
    pub const fn new() -> Self {
        Self { last: 0 }
    }

    /// The counter now reads `count`: ticks since it first read 0.
    pub const fn extend(&mut self, count: u32) -> u64 {
        let passed = count.wrapping_sub(self.last as u32);
        self.last = self.last.wrapping_add(passed as u64);
        self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_counted() {
        let mut ticks = Ticks::new();
        assert_eq!(ticks.extend(5), 5);
        assert_eq!(ticks.extend(5), 5);
        assert_eq!(ticks.extend(u32::MAX), 0xffff_ffff);
        assert_eq!(ticks.extend(0), 1 << 32);
        assert_eq!(ticks.extend(7), (1 << 32) + 7);
        assert_eq!(ticks.extend(6), (2 << 32) + 6);
    }

    #[test]
    fn no_turn_is_missed_at_one_reading_a_turn() {
        let mut ticks = Ticks::new();
        let step: u32 = 4_294_967_295;
        let mut count: u32 = 0;
        for turn in 1..=1000_u64 {
            count = count.wrapping_add(step);
            assert_eq!(ticks.extend(count), turn * u64::from(step));
        }
    }
}
