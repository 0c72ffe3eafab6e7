//! The level of the sensor while something moves it, and afterwards.

use super::envelope::Envelope;

/// A level that is left for a while and may be another one afterwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Number of the first sample.
    pub from: u64,
    /// How it is left and come back to.
    pub envelope: Envelope,
    /// Mean over all that while, less the middle of the levels before and afterwards, in the unit of the signal.
    pub mean: f64,
    /// The level afterwards less that before, in the unit of the signal; it goes over evenly.
    pub step: f64,
}

impl Level {
    /// The first sample after it.
    pub const fn to(&self) -> u64 {
        self.from + self.envelope.length()
    }

    /// The same upside down.
    #[must_use]
    pub fn negated(self) -> Self {
        Self {
            mean: -self.mean,
            step: -self.step,
            ..self
        }
    }

    /// Adds it to `samples`, the first of which has the number `first`.
    pub fn add_to(&self, first: u64, samples: &mut [f64]) {
        if self.mean == 0.0 && self.step == 0.0 {
            return;
        }
        let end = first + samples.len() as u64;
        let (from, to) = (self.from.clamp(first, end), self.to().clamp(first, end));
        let place = |number: u64| (number - first) as usize;
        let (height, each) = (
            self.mean / self.envelope.mean(),
            self.step / self.envelope.length() as f64,
        );
        for (number, sample) in (from..to).zip(&mut samples[place(from)..place(to)]) {
            let own = number - self.from;
            *sample += height * self.envelope.at(own) + each * (own as f64 + 0.5);
        }
        let after = &mut samples[place(to)..];
        after.iter_mut().for_each(|sample| *sample += self.step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_made_in_blocks_as_at_once_and_has_its_mean_and_its_step() {
        let level = Level {
            from: 103,
            envelope: Envelope::new(200, 50),
            mean: 5.0,
            step: -3.0,
        };
        let (mut whole, mut parts) = (vec![0.0; 500], vec![0.0; 500]);
        level.add_to(0, &mut whole);
        for (number, block) in parts.chunks_mut(37).enumerate() {
            level.add_to(37 * number as u64, block);
        }
        assert_eq!(whole, parts);
        assert!(whole[..103].iter().all(|one| *one == 0.0));
        assert!(whole[303..].iter().all(|one| *one == -3.0));
        let mean = whole[103..303].iter().sum::<f64>() / 200.0;
        assert!((mean - (5.0 - 1.5)).abs() < 1e-12, "{mean}");
        // It is left and come back to without a jump: 5 / 0.75 pi / 2 / 50 a sample, and the step's 3 / 200.
        let largest = whole.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        assert!(largest.fold(0.0, f64::max) < 0.3);
    }
}
