//! A record that can be read more than once.

/// Something that yields the same samples each time: blocks with the absolute index of their
/// first sample, ascending.
pub trait Replay: Sync {
    /// Why a replay failed.
    type Error: Send;

    /// Hands every block to `visit`.
    ///
    /// # Errors
    /// Whatever keeps the record from being read.
    fn replay(&self, visit: &mut dyn FnMut(u64, &[f64])) -> Result<(), Self::Error>;
}

/// Samples in memory.
impl Replay for [f64] {
    type Error = std::convert::Infallible;

    fn replay(&self, visit: &mut dyn FnMut(u64, &[f64])) -> Result<(), Self::Error> {
        for (index, block) in self.chunks(1 << 14).enumerate() {
            visit((index as u64) << 14, block);
        }
        Ok(())
    }
}

/// Codes in memory.
impl Replay for [i32] {
    type Error = std::convert::Infallible;

    fn replay(&self, visit: &mut dyn FnMut(u64, &[f64])) -> Result<(), Self::Error> {
        let mut values = Vec::with_capacity(1 << 14);
        for (index, block) in self.chunks(1 << 14).enumerate() {
            values.clear();
            values.extend(block.iter().map(|&code| f64::from(code)));
            visit((index as u64) << 14, &values);
        }
        Ok(())
    }
}
