//! The sum of a long record, exact for codes.

/// A sum that does not lose the small against the large.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sum {
    codes: i128,
    floats: f64,
    /// What was rounded off `floats` (Neumaier 1974).
    rest: f64,
}

impl Sum {
    pub(super) fn add_codes(&mut self, codes: &[i32]) {
        // A run in memory is shorter than 2^32, so 64 bits hold its sum.
        self.codes += i128::from(codes.iter().map(|&code| i64::from(code)).sum::<i64>());
    }

    pub(super) fn add_floats(&mut self, floats: &[f64]) {
        // Short plain sums round at the size of their own few samples only.
        for few in floats.chunks(64) {
            let value: f64 = few.iter().sum();
            let total = self.floats + value;
            self.rest += if self.floats.abs() >= value.abs() {
                (self.floats - total) + value
            } else {
                (value - total) + self.floats
            };
            self.floats = total;
        }
    }

    pub(super) fn value(&self) -> f64 {
        self.codes as f64 + (self.floats + self.rest)
    }
}
