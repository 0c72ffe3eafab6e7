//! A record as means, coarse enough to be looked at often.
//!
//! Each weighs the samples of two blocks as a triangle, so that noise which rises with the frequency, as that of rounding does,
//! hardly folds back.

use realfft::num_complex::Complex64;

use crate::fft::phasor::Phasor;

/// Means of a record, at most: a choice. They show 32 multiples of the quickest cycle, and a settling of a thousandth of the record.
const MOST: usize = 1 << 13;

/// Parts of the record in which a level that walks is seen: a choice. A course of a few numbers follows a walk in the
/// slowest of them only.
const PARTS: usize = 32;

/// Means of a record.
pub struct Means {
    /// Each of them; zero where less than half of it was measured.
    pub values: Vec<f64>,
    /// Whether each was measured.
    pub measured: Vec<bool>,
    /// Samples from each to the next.
    pub factor: usize,
}

impl Means {
    /// Of `values`, NaN where missing, about their mean.
    pub fn new(values: &[f64]) -> Self {
        Self::over(values, values.len().div_ceil(MOST).max(1))
    }

    /// Of `values`, NaN where missing, about their mean, so many samples from each to the next.
    pub fn over(values: &[f64], factor: usize) -> Self {
        let weights: Vec<f64> = (1..2 * factor)
            .map(|place| factor.min(place).min(2 * factor - place) as f64)
            .collect();
        let windows = values.windows(weights.len()).step_by(factor);
        let means: Vec<Option<f64>> = windows.map(|window| mean(window, &weights)).collect();
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
        let own = |number: usize| {
            if is_own(number) {
                self.values[number]
            } else {
                0.0
            }
        };
        Self {
            values: (0..self.len()).map(own).collect(),
            measured: (0..self.len()).map(is_own).collect(),
            factor: self.factor,
        }
    }

    /// `m` times the Allan variance of some `values` in their place, over `m` of them: the same for all `m` where they are
    /// white, and as many times `m^2 / 3` what a walk takes in one step.
    pub fn white(&self, values: &[f64], m: usize) -> f64 {
        let means: Vec<Option<f64>> = self.coarser(values, m).collect();
        let steps = means.windows(2).filter_map(|two| Some(two[1]? - two[0]?));
        let (sum, count) = steps.fold((0.0, 0.0), |(sum, count), step| {
            (sum + step * step, count + 1.0)
        });
        m as f64 * 0.5 * sum / f64::max(count, 1.0)
    }

    /// Density of some `values` in their place about a frequency, `reach` to either side, both in cycles a sample: their square, were
    /// they white. What lies less than two ordinates from the frequency or from the ends of its reach is not in it.
    pub fn density(&self, values: &[f64], cycles: f64, reach: f64) -> f64 {
        const OWN: usize = 2;
        let samples = (self.len() * self.factor) as f64;
        let [middle, wide] = [cycles, reach].map(|one| (one * samples).round() as usize);
        let lower = (middle + OWN).saturating_sub(wide)..(middle + 1).saturating_sub(OWN);
        let upper = middle + OWN..(middle + wide + 1).saturating_sub(OWN);
        let power = |k: usize| {
            let mut sum = Complex64::ZERO;
            let turned = Phasor::new(-(k as f64) / self.len() as f64);
            turned.zip(0, values, 1.0.into(), |value, turned| sum += turned * value);
            sum.norm_sqr()
        };
        let (mut sum, mut count) = (0.0, 0.0);
        for k in lower.chain(upper).filter(|k| *k > 0) {
            sum += power(k);
            count += self.known();
        }
        sum / f64::max(count, 1.0)
    }

    /// Sum of the squares of some `values` in their place, in means over `m` of them; each counts for all that it is of.
    pub fn energy(&self, values: &[f64], m: usize) -> f64 {
        let m = m.max(1);
        let squares = self.coarser(values, m).flatten().map(|mean| mean * mean);
        m as f64 * squares.sum::<f64>()
    }

    /// Means over `m` of some `values` in their place, where more than half of them were measured.
    fn coarser<'a>(&'a self, values: &'a [f64], m: usize) -> impl Iterator<Item = Option<f64>> {
        let both = values.chunks_exact(m).zip(self.measured.chunks_exact(m));
        both.map(move |(values, known)| {
            let known = known.iter().filter(|known| **known).count();
            // What is not known is zero.
            (2 * known > m).then(|| values.iter().sum::<f64>() / known as f64)
        })
    }

    /// Mean square that a walk would have about its mean, of as long a record, that takes the steps which some `values` in
    /// their place leave room for: `q n / 6` for the square `q` of one step among `n`.
    pub fn walk(&self, values: &[f64]) -> f64 {
        let m = (self.len() / PARTS).max(1);
        let square = 3.0 * self.white(values, m) / (m * m) as f64;
        square * self.len() as f64 / 6.0
    }
}

/// Mean of samples with these `weights`, if half of it or more was measured.
fn mean(samples: &[f64], weights: &[f64]) -> Option<f64> {
    let known = samples
        .iter()
        .zip(weights)
        .filter(|(value, _)| value.is_finite());
    let (sum, weight) = known.fold((0.0, 0.0), |(sum, all), (value, weight)| {
        (sum + weight * value, all + weight)
    });
    (2.0 * weight >= weights.iter().sum()).then(|| sum / weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::numbers;

    #[test]
    fn means_are_of_what_was_measured() {
        let mut values: Vec<f64> = (0..20_000).map(f64::from).collect();
        // Five samples that weigh 1, 2, 3, 2 and 1, the first three of them more than half.
        values[..3].fill(f64::NAN);
        let means = Means::new(&values);
        assert_eq!((means.factor, means.len()), (3, 6666));
        assert_eq!(means.measured[..3], [false, true, true]);
        assert_eq!(means.values[0], 0.0);
        assert!((means.values[2] - means.values[1] - 3.0).abs() < 1e-9);
        assert_eq!(means.known(), 6665.0);
    }

    #[test]
    fn a_walk_leaves_room_for_itself_and_white_noise_for_little() {
        let (mut normal, mut level) = (numbers(1, 0), 0.0);
        let white: Vec<f64> = (0..4096).map(|_| normal.draw()).collect();
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
