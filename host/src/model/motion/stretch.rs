//! One stretch in which something moves: its band of noise, and what that adds to a record's spectrum.

use std::f64::consts::PI;

use super::envelope::Envelope;
use super::level::Level;
use super::{FADE, MEAN, STEP};
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
    /// How long it takes to come up, and as long to fade, seconds.
    pub fade_s: f64,
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
            fade_s: row[FADE],
            band: Band::of(&row[3..MEAN]),
        }
    }

    /// Whether it is the same while as another one, in another band.
    pub fn is_beside(&self, other: &Self) -> bool {
        let own = |one: &Self| [one.time_s, one.duration_s, one.fade_s];
        own(self) == own(other)
    }

    /// Its samples: the first, and how they come up and fade.
    pub fn samples(&self, rate_hz: f64) -> (u64, Envelope) {
        /// No record has a sample of this number, and there is room for more behind it.
        const LATEST: f64 = (1_u64 << 62) as f64;
        let number = |time_s: f64| (time_s * rate_hz).round().clamp(0.0, LATEST) as u64;
        let (from, to) = (number(self.time_s), number(self.time_s + self.duration_s));
        let length = to.max(from + 1) - from;
        (from, Envelope::new(length, number(self.fade_s)))
    }

    /// The level meanwhile and afterwards.
    pub fn level(&self, rate_hz: f64) -> Level {
        let (from, envelope) = self.samples(rate_hz);
        Level {
            from,
            envelope,
            mean: self.mean,
            step: self.step,
        }
    }

    /// Two-sided density at `f_hz` while it lasts: that of the band, which a stretch of `T` seconds widens by `1/T`, less
    /// that of its mean.
    pub fn density(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let lasts_s = self.duration_s - self.fade_s.min(0.5 * self.duration_s);
        let width_hz = self.band.width_hz.hypot(lasts_s.recip());
        let band = Band {
            width_hz,
            ..self.band
        };
        let half_turn = PI * f_hz * lasts_s;
        let of_mean = if half_turn == 0.0 {
            1.0
        } else {
            half_turn.sin() / half_turn
        };
        band.spectrum(f_hz, rate_hz) * (1.0 - of_mean * of_mean)
    }
}
