//! A record as means over blocks, coarse enough to be looked at often.

/// Means of a record, at most: a choice. The quickest settling that is looked for here, a sixtieth of the record, has 68 of
/// them, and so has the quickest cycle.
const MOST: usize = 1 << 12;

/// Parts of the record in which a level that walks is seen: a choice. A course of a few numbers follows a walk in the
/// slowest of them only.
const PARTS: usize = 32;

/// Means over blocks of a record.
pub struct Means {
    /// Each of them; zero where less than half of the block was measured.
    pub values: Vec<f64>,
    /// Whether each was measured.
    pub measured: Vec<bool>,
    /// Samples of a block.
    pub factor: usize,
}

impl Means {
    /// Of `values`, NaN where missing, about their mean.
    pub fn new(values: &[f64]) -> Self {
        let factor = values.len().div_ceil(MOST).max(1);
        let means: Vec<Option<f64>> = values.chunks_exact(factor).map(mean).collect();
        let known: Vec<f64> = means.iter().copied().flatten().collect();
        let centre = known.iter().sum::<f64>() / known.len().max(1) as f64;
        Self {
            measured: means.iter().map(Option::is_some).collect(),
            values: means
                .iter()
                .map(|one| one.map_or(0.0, |one| one - centre))
                .collect(),
            factor,
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// How many were measured.
    pub fn known(&self) -> f64 {
        self.measured.iter().filter(|known| **known).count() as f64
    }

    /// Every other of them, from the first or the second on.
    pub fn half(&self, parity: usize) -> Self {
        let is_own = |number: usize| number % 2 == parity && self.measured[number];
        let own = |number: usize| if is_own(number) { self.values[number] } else { 0.0 };
        Self {
            values: (0..self.len()).map(own).collect(),
            measured: (0..self.len()).map(is_own).collect(),
            factor: self.factor,
        }
    }

    /// `m` times the Allan variance of some `values` in their place, over `m` of them: the same for all `m` where they are
    /// white, and as many times `m^2 / 3` what a walk takes in one step.
    pub fn white(&self, values: &[f64], m: usize) -> f64 {
        let means: Vec<Option<f64>> = values
            .chunks_exact(m)
            .zip(self.measured.chunks_exact(m))
            .map(|(values, known)| {
                let known = known.iter().filter(|known| **known).count();
                // What is not known is zero.
                (2 * known > m).then(|| values.iter().sum::<f64>() / known as f64)
            })
            .collect();
        let steps = means.windows(2).filter_map(|two| Some(two[1]? - two[0]?));
        let (sum, count) = steps.fold((0.0, 0.0), |(sum, count), step| {
            (sum + step * step, count + 1.0)
        });
        m as f64 * 0.5 * sum / f64::max(count, 1.0)
    }

    /// Mean square that a walk would have about its mean, of as long a record, that takes the steps which some `values` in
    /// their place leave room for: `q n / 6` for the square `q` of one step among `n`.
    pub fn walk(&self, values: &[f64]) -> f64 {
        let m = (self.len() / PARTS).max(1);
        let square = 3.0 * self.white(values, m) / (m * m) as f64;
        square * self.len() as f64 / 6.0
    }
}

/// Mean of the samples of a block that were measured, if they are half of it or more.
fn mean(block: &[f64]) -> Option<f64> {
    let known = block.iter().filter(|value| value.is_finite());
    let (sum, count) = known.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    (2 * count as usize >= block.len()).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::numbers;

    #[test]
    fn means_are_of_what_was_measured() {
        let mut values: Vec<f64> = (0..20_000).map(f64::from).collect();
        // Blocks of five: four of the first missing, two of the second.
        values[..4].fill(f64::NAN);
        values[5..7].fill(f64::NAN);
        let means = Means::new(&values);
        assert_eq!((means.factor, means.len()), (5, 4000));
        assert_eq!(means.measured[..3], [false, true, true]);
        assert_eq!(means.values[0], 0.0);
        assert!((means.values[2] - means.values[1] - 4.0).abs() < 1e-9);
        assert_eq!(means.known(), 3999.0);
    }

    #[test]
    fn a_walk_leaves_room_for_itself_and_white_noise_for_little() {
        let (mut normal, mut level) = (numbers(1, 0), 0.0);
        let white: Vec<f64> = (0..1 << 12).map(|_| normal.draw()).collect();
        let walk: Vec<f64> = white
            .iter()
            .map(|step| {
                level += step;
                level
            })
            .collect();
        // 31 differences tell a variance to a quarter.
        let means = Means::new(&walk);
        let of_walk = means.walk(&means.values) / (4096.0 / 6.0);
        assert!(of_walk.ln().abs() < 4.0 * 0.25, "seed 1: {of_walk}");
        let means = Means::new(&white);
        let of_white = means.walk(&means.values) / (3.0 / 128.0 / 128.0 * 4096.0 / 6.0);
        assert!(of_white.ln().abs() < 4.0 * 0.25, "seed 1: {of_white}");
    }
}
