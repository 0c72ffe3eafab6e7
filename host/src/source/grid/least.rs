//! The least value of a window that moves along a record, each value touched a fixed number of times.

use std::collections::VecDeque;

/// Least of the values pushed last.
#[derive(Default)]
pub struct Least {
    /// Rows that may still become the least, ascending in row and value.
    held: VecDeque<(usize, f64)>,
}

impl Least {
    /// Takes in the value of the next row.
    pub fn push(&mut self, row: usize, value: f64) {
        while self.held.back().is_some_and(|&(_, held)| held >= value) {
            self.held.pop_back();
        }
        self.held.push_back((row, value));
    }

    /// The least since row `first`, which never goes back; `None` where no row is held.
    pub fn since(&mut self, first: usize) -> Option<f64> {
        while self.held.front().is_some_and(|&(row, _)| row < first) {
            self.held.pop_front();
        }
        self.held.front().map(|&(_, value)| value)
    }
}

/// For each row the least of it and the rows that follow, `window` in all, fewer at the end.
pub fn ahead(values: &[f64], window: usize) -> Vec<f64> {
    let mut least = Least::default();
    let mut pushed = 0;
    (0..values.len())
        .map(|row| {
            while pushed < values.len().min(row + window) {
                least.push(pushed, values[pushed]);
                pushed += 1;
            }
            least.since(row).unwrap_or(values[row])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_of_the_next_rows() {
        let values = [3.0, 1.0, 2.0, 5.0, 4.0];
        assert_eq!(ahead(&values, 1), values);
        assert_eq!(ahead(&values, 2), [1.0, 1.0, 2.0, 4.0, 4.0]);
        assert_eq!(ahead(&values, 9), [1.0, 1.0, 2.0, 4.0, 4.0]);
    }
}
