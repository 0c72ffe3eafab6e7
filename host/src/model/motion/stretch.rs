//! One stretch in which something moves: its band of noise, and what it adds to a record's spectrum and Allan variance.

use std::f64::consts::PI;

use super::{MEAN, STEP};
use crate::model::Term;
use crate::model::unnamed::Band;

/// A band of noise that is let in for a while, and a change of the level meanwhile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// When it begins, seconds since the start of the record.
    pub time_s: f64,
    /// How long it lasts, seconds.
    pub duration_s: f64,
    /// The level afterwards less that before, in the unit of the signal.
    pub step: f64,
    /// The level meanwhile less the middle of those before and afterwards, in the unit of the signal.
    pub mean: f64,
    /// What it adds to the noise.
    pub band: Band,
}

impl Stretch {
    /// With these parameters, in the catalogue's order.
    pub fn of(row: &[f64]) -> Self {
        Self {
            time_s: row[0],
            duration_s: row[1],
            step: row[STEP],
            mean: row[MEAN],
            band: Band::of(&row[3..MEAN]),
        }
    }

    /// The first of its samples, and the first after it.
    pub(super) fn samples(&self, rate_hz: f64) -> (u64, u64) {
        /// No record has a sample of this number, and there is room for more behind it.
        const LATEST: f64 = (1_u64 << 62) as f64;
        let number = |time_s: f64| (time_s * rate_hz).round().clamp(0.0, LATEST) as u64;
        let (from, to) = (number(self.time_s), number(self.time_s + self.duration_s));
        (from, to.max(from + 1))
    }

    /// Two-sided density at `f_hz` while it lasts: that of the band, which a stretch of `T` seconds widens by `1/T`, less
    /// that of its mean.
    pub fn density(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let width_hz = self.band.width_hz.hypot(self.duration_s.recip());
        let band = Band {
            width_hz,
            ..self.band
        };
        let half_turn = PI * f_hz * self.duration_s;
        let of_mean = if half_turn == 0.0 {
            1.0
        } else {
            half_turn.sin() / half_turn
        };
        band.spectrum(f_hz, rate_hz) * (1.0 - of_mean * of_mean)
    }

    /// What its noise adds to the Allan variance over `m` samples of a record of `samples`, in the mean, where it is
    /// further from both ends than that.
    ///
    /// Averaged over all places in the record, `(4 S(m) - S(2 m)) / (2 m^2)` of the squares `S(k)` of sums over `k`
    /// samples, over the number of places.
    pub(super) fn allan_variance(&self, m: u64, samples: u64, rate_hz: f64) -> f64 {
        let (from, to) = self.samples(rate_hz);
        let sums = Sums::new(&self.band, (to - from).min(samples) as usize, rate_hz);
        let places = samples.saturating_sub(2 * m) + 1;
        let m = m as usize;
        let square = (4.0 * sums.over(m) - sums.over(2 * m)) / places as f64;
        (square / (2.0 * (m as f64).powi(2))).max(0.0)
    }
}

/// Sums of the noise of a stretch, whose mean is none.
struct Sums {
    /// Mean square of a sum over as many samples of noise that always was there.
    squares: Vec<f64>,
}

impl Sums {
    fn new(band: &Band, length: usize, rate_hz: f64) -> Self {
        /// Of a covariance that is a part of the first one this small, nothing is left to add: a choice.
        const NOTHING: f64 = 1e-12;
        let first = band.covariance(0.0);
        let (mut squares, mut square, mut growth) = (vec![0.0], 0.0, first);
        let mut covariances = band.covariances(rate_hz.recip()).skip(1);
        let mut is_over = false;
        for lag in 1..=length {
            square += growth;
            squares.push(square);
            is_over = is_over || band.bound(lag as f64 / rate_hz) < NOTHING * first;
            if !is_over {
                growth += 2.0 * covariances.next().unwrap_or_default();
            }
        }
        Self { squares }
    }

    /// Mean square of the sum over `count` samples from `first` on, less their share of the sum over all.
    fn square(&self, first: usize, count: usize) -> f64 {
        let v = &self.squares;
        let length = v.len() - 1;
        let share = count as f64 / length as f64;
        let last = first + count;
        let with_all = v[last] - v[first] + v[length - first] - v[length - last];
        (v[count] + share * share * v[length] - share * with_all).max(0.0)
    }

    /// Sum of the squares of the sums over `k` samples at all places.
    fn over(&self, k: usize) -> f64 {
        let length = self.squares.len() - 1;
        // On both ends only a part of the samples is of the stretch.
        let ends = (1..k.min(length)).map(|count| self.square(0, count));
        let within = (0..(length + 1).saturating_sub(k)).map(|first| self.square(first, k));
        2.0 * ends.sum::<f64>() + within.sum::<f64>()
    }
}
