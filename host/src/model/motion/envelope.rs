//! How a motion comes up and fades.

use std::f64::consts::FRAC_PI_2;

/// Amplitude sample by sample: it comes up as the square of a sine, is 1, and fades as it came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    length: u64,
    fade: u64,
}

impl Envelope {
    /// Over so many samples, at least one, of which so many at either end are on the way, half of them at most.
    pub fn new(length: u64, fade: u64) -> Self {
        Self {
            length,
            fade: fade.min(length / 2),
        }
    }

    /// The same for no more than so many samples, at least one.
    #[must_use]
    pub fn within(&self, samples: u64) -> Self {
        Self::new(self.length.min(samples.max(1)), self.fade)
    }

    /// Samples over which it lasts.
    pub const fn length(&self) -> u64 {
        self.length
    }

    /// In the sample of this number.
    pub fn at(&self, number: u64) -> f64 {
        let from_end = number.min(self.length - 1 - number);
        if from_end >= self.fade {
            return 1.0;
        }
        let part = (from_end as f64 + 0.5) / self.fade as f64;
        (FRAC_PI_2 * part).sin().powi(2)
    }

    /// Sample by sample.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        let own = *self;
        (0..self.length).map(move |number| own.at(number))
    }

    /// Its mean: half of what is on the way is there.
    pub fn mean(&self) -> f64 {
        1.0 - self.fade as f64 / self.length as f64
    }

    /// Mean of its square: three eighths of what is on the way are there, a quarter where that is one sample.
    pub fn mean_square(&self) -> f64 {
        let there = if self.fade == 1 { 0.25 } else { 0.375 };
        1.0 - 2.0 * (1.0 - there) * self.fade as f64 / self.length as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_means_are_those_of_its_values() {
        for (length, fade) in [
            (1, 0),
            (2, 1),
            (7, 3),
            (100, 0),
            (100, 1),
            (1001, 300),
            (64, 99),
        ] {
            let envelope = Envelope::new(length, fade);
            let sum = |power: i32| envelope.values().map(|one| one.powi(power)).sum::<f64>();
            let [mean, square] = [1, 2].map(|power| sum(power) / length as f64);
            assert!(
                (envelope.mean() - mean).abs() < 1e-12,
                "{envelope:?}: {mean}"
            );
            assert!(
                (envelope.mean_square() - square).abs() < 1e-12,
                "{envelope:?}: {square}"
            );
        }
    }

    #[test]
    fn it_is_the_same_from_either_end() {
        let envelope = Envelope::new(100, 30);
        for number in 0..100 {
            assert_eq!(envelope.at(number), envelope.at(99 - number));
        }
        assert!(envelope.at(0) < 1e-3 && envelope.at(15) > 0.5 && envelope.at(30) == 1.0);
    }
}
