//! What a filter is given before a record begins.

/// The beginning of a record mirrored before it: at the same level, and as loud.
pub struct Mirror {
    /// How many samples of it.
    samples: usize,
    /// What has come, until there is enough for it.
    beginning: Vec<f64>,
    has_begun: bool,
}

impl Mirror {
    /// Of so many samples.
    pub fn new(samples: usize) -> Self {
        Self {
            samples,
            beginning: Vec::new(),
            has_begun: false,
        }
    }

    /// Further samples, ahead of the first of them their mirror image; `None` until there are enough for it.
    pub fn before(&mut self, mut came: Vec<f64>) -> Option<Vec<f64>> {
        if self.has_begun {
            return Some(came);
        }
        self.beginning.append(&mut came);
        if self.beginning.len() <= self.samples {
            return None;
        }
        self.has_begun = true;
        let beginning = std::mem::take(&mut self.beginning);
        let mirror = beginning[1..=self.samples].iter().rev().copied();
        Some(mirror.chain(beginning.iter().copied()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_beginning_is_mirrored_once_about_its_first_sample() {
        let mut mirror = Mirror::new(2);
        assert_eq!(mirror.before(vec![1.0, 2.0]), None);
        let all = vec![3.0, 2.0, 1.0, 2.0, 3.0, 4.0];
        assert_eq!(mirror.before(vec![3.0, 4.0]), Some(all));
        assert_eq!(mirror.before(vec![5.0]), Some(vec![5.0]));
    }
}
