//! What the first replay of a record shows: trend and noise floor; and what these say of a line's power.

use std::f64::consts::PI;

use rustfft::num_complex::Complex64;

use super::LEAST_SAMPLES;
use super::replay::Replay;
use crate::fft::phasor::Phasor;
use crate::numeric::bisect::bisect;
use crate::spectrum::fill::{Filler, Piece};
use crate::spectrum::floor::{Floor, LongSegments, SEGMENT};
use crate::spectrum::slow_floor::{Blocks, SlowFloor};

/// Share of the record that each end's taper takes.
pub(super) const TAPER: f64 = 0.05;

/// Share of the level that slow lines have, whose frequencies are few.
const SLOW_SHARE: f64 = 0.1;

/// What the first replay shows.
pub(super) struct Survey {
    first: u64,
    pub(super) len: u64,
    pub(super) rate_hz: f64,
    /// Share of the samples that is missing: a strong line looks as wide as the gaps are short,
    /// that much below its peak.
    pub(super) missing: f64,
    /// Straight line through the record: value at its middle and slope per sample.
    middle: f64,
    slope: f64,
    pub(super) floor: Floor,
    /// Below the lowest frequency of `floor`.
    slow: Option<SlowFloor>,
}

impl Survey {
    /// Replays the record once for its length and once for its floor; `None` where it is too short for one.
    pub(super) fn take<R: Replay + ?Sized>(
        record: &R,
        rate_hz: f64,
    ) -> Result<Option<Self>, R::Error> {
        let (mut first, mut end) = (None, 0);
        record.replay(&mut |at, values| {
            first.get_or_insert(at);
            end = at + values.len() as u64;
        })?;
        let Some(first) = first else { return Ok(None) };
        let len = end - first;
        if len < LEAST_SAMPLES {
            return Ok(None);
        }
        let mut segments = LongSegments::new(SEGMENT.min(1 << (len / 8).ilog2()));
        let mut reference = None;
        let [mut n, mut t, mut tt, mut x, mut tx] = [0.0_f64; 5];
        let middle = 0.5 * (len - 1) as f64;
        record.replay(&mut |at, values| {
            // A block out of order is left out everywhere alike.
            if segments.push(at, values).is_err() {
                return;
            }
            for (index, &value) in values.iter().enumerate().filter(|(_, x)| x.is_finite()) {
                let value = value - *reference.get_or_insert(value);
                let time = (at - first) as f64 + index as f64 - middle;
                n += 1.0;
                t += time;
                tt += time * time;
                x += value;
                tx += time * value;
            }
        })?;
        let (Some(floor), Some(reference)) = (segments.floor(rate_hz), reference) else {
            return Ok(None);
        };
        let slope = (tx - t * x / n) / (tt - t * t / n).max(1.0);
        Ok(Some(Self {
            first,
            len,
            rate_hz,
            missing: 1.0 - n / len as f64,
            middle: reference + (x - slope * t) / n,
            slope,
            floor,
            slow: None,
        }))
    }

    /// Measures the floor below what segments resolve.
    pub(super) fn look_slow<R: Replay + ?Sized>(&mut self, record: &R) -> Result<(), R::Error> {
        let highest = (self.floor.lowest_hz() * self.duration_s()).ceil() as usize;
        let Some(mut blocks) = Blocks::new(self.len as usize, highest) else {
            return Ok(());
        };
        self.tapered(record, |at, values| blocks.push(at, values))?;
        self.slow = Some(blocks.floor(self.taper_energy() * self.rate_hz));
        Ok(())
    }

    /// The floor at frequencies that only the whole record resolves.
    pub(super) fn slow_at(&self, f_hz: f64) -> Option<&SlowFloor> {
        self.slow.as_ref().filter(|_| f_hz < self.floor.lowest_hz())
    }

    /// Lowest frequency that is searched, hertz.
    pub(super) fn lowest_hz(&self) -> f64 {
        match self.slow {
            Some(_) => SlowFloor::lowest() / self.duration_s(),
            None => self.floor.lowest_hz(),
        }
    }

    /// Length of the record, seconds.
    pub(super) fn duration_s(&self) -> f64 {
        self.len as f64 / self.rate_hz
    }

    /// Replays the record without gaps and trend, tapered: index from 0 and values.
    pub(super) fn tapered<R: Replay + ?Sized>(
        &self,
        record: &R,
        mut visit: impl FnMut(usize, &[f64]),
    ) -> Result<(), R::Error> {
        let (mut filler, mut at) = (Filler::default(), 0);
        let mut values = Vec::new();
        let centre = 0.5 * (self.len - 1) as f64;
        let edge = TAPER * self.len as f64;
        // Half a turn of a cosine over each end.
        let rise = Phasor::new(0.5 / edge);
        record.replay(&mut |first, block| {
            filler.push(first, block, u64::MAX, &mut |piece| match piece {
                Piece::Break(index) => at = (index - self.first) as usize,
                Piece::Measured(piece) | Piece::Bridge(piece) => {
                    values.clear();
                    // 32 bits are turned into numbers several at a time, 64 are not.
                    let start = at as f64 - centre;
                    let places = (0_u32..).map(|n| start + f64::from(n));
                    let trend = places.map(|place| self.middle + self.slope * place);
                    values.extend(piece.iter().zip(trend).map(|(x, trend)| x - trend));
                    taper(at, self.len as usize, edge, &rise, &mut values);
                    visit(at, &values);
                    at += piece.len();
                }
            });
        })
    }

    /// Sum of the squared taper.
    fn taper_energy(&self) -> f64 {
        self.len as f64 * (1.0 - 2.0 * TAPER * (1.0 - 0.375))
    }

    /// Sum of the taper.
    pub(super) fn taper_sum(&self) -> f64 {
        self.len as f64 * (1.0 - TAPER)
    }

    /// Power over the floor of a squared transform at `f_hz`.
    pub(super) fn ratio(&self, power: f64, f_hz: f64) -> f64 {
        let floor = self.slow_at(f_hz).map_or_else(
            || self.floor.at(f_hz),
            |slow| slow.at(f_hz * self.duration_s()),
        );
        power / (self.taper_energy() * self.rate_hz * floor)
    }

    /// Probability that the power at a slow line's frequency exceeds `ratio` at any slow one.
    pub(super) fn slow_false_alarm(&self, ratio: f64, f_hz: f64) -> f64 {
        let band = (self.floor.lowest_hz() - self.lowest_hz()) * self.duration_s();
        let tail = SlowFloor::tail(f_hz * self.duration_s(), ratio);
        band * (PI * ratio / 3.0).sqrt() * tail / SLOW_SHARE
    }

    /// Probability that the power exceeds `ratio` anywhere without a line.
    pub(super) fn false_alarm(&self, ratio: f64, floor_sd: f64) -> f64 {
        let band_hz = 0.5 * self.rate_hz - self.floor.lowest_hz();
        let crossings = |z: f64| band_hz * self.duration_s() * (PI * z / 3.0).sqrt() * (-z).exp();
        0.5 * (crossings(ratio * (1.0 - floor_sd)) + crossings(ratio * (1.0 + floor_sd)))
            / (1.0 - SLOW_SHARE)
    }

    /// Ratio whose false alarm is `level`, for a floor that is well known.
    pub(super) fn threshold(&self, level: f64) -> f64 {
        bisect(1.0, 1000.0, 50, |ratio| {
            self.false_alarm(ratio, 0.0) > level
        })
    }
}

/// Tapers `values` from index `at` of `len` on, by `rise` over `edge` samples of each end.
fn taper(at: usize, len: usize, edge: f64, rise: &Phasor, values: &mut [f64]) {
    let half = Complex64::cis(0.5 * PI / edge);
    let last = at + values.len();
    let within = (edge - 0.5).ceil() as usize;
    let start = values.len().min(within.saturating_sub(at));
    rise.zip(at, &mut values[..start], half, |value, turn| {
        *value *= 0.5 - 0.5 * turn.re;
    });
    let end = values.len() - values.len().min(last.saturating_sub(len - within));
    let from_end = values[end..].iter_mut().rev();
    rise.zip(len - last, from_end, half, |value, turn| {
        *value *= 0.5 - 0.5 * turn.re;
    });
}
